"""The alerts as conditions: a node for each rule and element of a machine that has an alert, and events to those who listen.

The library keeps conditions without a plant, and sends each to everybody; here each session receives those of its plants.
"""

from collections.abc import Callable, Iterator

from asyncua import ua
from asyncua.server.internal_server import InternalServer
from asyncua.server.internal_subscription import InternalSubscription

from service.opcua.alert_reading import AlertReading
from service.opcua.client_session import ClientSession
from service.opcua.condition_state import STATES, ConditionEvent, Fields, condition_fields, moment, node, text
from service.opcua.machine_nodes import MachineNodes
from service.opcua.node_tree import COMPONENT, PROPERTY, NodeRefused, NodeTree
from storage.clock import now, to_datetime

OWN = frozenset({"Rule", "Element", "State", "AlertId", "Identification"})
"""Fields that are not the standard's."""
LEFT_OUT = ("/TrueState", "/FalseState", "/TransitionTime", "/EffectiveDisplayName")
"""Optional fields that events have and nodes do not."""
METHODS = (
    ua.ObjectIds.AcknowledgeableConditionType_Acknowledge,
    ua.ObjectIds.AcknowledgeableConditionType_Confirm,
    ua.ObjectIds.ConditionType_AddComment,
    ua.ObjectIds.AlarmConditionType_Reset,
)
SHELVING_METHODS = (
    ua.ObjectIds.ShelvedStateMachineType_TimedShelve,
    ua.ObjectIds.ShelvedStateMachineType_Unshelve,
    ua.ObjectIds.ShelvedStateMachineType_OneShotShelve,
)
SHELVING = "ShelvingState"
DESCRIPTION = "an alert; its EventId is what Acknowledge, Confirm and AddComment ask for"


class AlertConditions:
    """Conditions of a server, by their nodes."""

    def __init__(
        self,
        server: InternalServer,
        tree: NodeTree,
        machines: MachineNodes,
        sessions: Callable[[ua.NodeId], ClientSession | None],
    ) -> None:
        """Set up. sessions: the session of an id, where it is a client's."""
        self._server = server
        self._tree = tree
        self._machines = machines
        self._sessions = sessions
        self._conditions: dict[ua.NodeId, AlertReading] = {}

    def of(self, node_id: ua.NodeId) -> AlertReading | None:
        """Return the alert of a condition, or of its shelving."""
        found = self._conditions.get(node_id)
        if found is None and isinstance(node_id.Identifier, str) and node_id.Identifier.endswith(f"/{SHELVING}"):
            stem = node_id.Identifier.removesuffix(f"/{SHELVING}")
            found = self._conditions.get(ua.NodeId(stem, node_id.NamespaceIndex))
        return found

    async def show(self, alert: AlertReading, *, report: bool = True) -> None:
        """Show an alert, and send its event to subscribers. Raises NodeRefused.

        report: False where nothing has happened to it.
        """
        if not self._machines.shows(alert.machine):
            raise NodeRefused(f"its machine '{alert.machine}' is not shown")
        condition = self._node(alert)
        fields = self._fields(alert)
        if condition not in self._conditions:
            self._add(condition, alert, fields)
        self._conditions[condition] = alert
        for path, value in fields.items():
            place = self._place(condition, path)
            if path != "NodeId" and self._tree.holds(place):
                await self._tree.write(place, ua.DataValue(value, SourceTimestamp=to_datetime(alert.at)))
        if report:
            for subscription in list(self._server.subscription_service.subscriptions.values()):
                await self._send_event(subscription, alert, fields)

    async def refresh(self, subscription: InternalSubscription, item: int | None) -> None:
        """Send every open alert that a client may see to its subscription, or to one item of it (ConditionRefresh)."""
        await self._mark(subscription, ua.ObjectIds.RefreshStartEventType, item)
        for alert in list(self._conditions.values()):
            if alert.is_open:
                await self._send_event(subscription, alert, self._fields(alert), item)
        await self._mark(subscription, ua.ObjectIds.RefreshEndEventType, item)

    async def _send_event(
        self, subscription: InternalSubscription, alert: AlertReading, fields: Fields, item: int | None = None
    ) -> None:
        session = self._sessions(subscription.session_id)
        if session is None or not session.sees(self._node(alert)):
            return
        for place in self._notifiers(alert):
            await _send(subscription, ConditionEvent(place, fields), item)

    async def _mark(self, subscription: InternalSubscription, kind: int, item: int | None) -> None:
        at = to_datetime(now())
        server = ua.NodeId(ua.ObjectIds.Server)
        fields: Fields = {
            "EventId": ua.Variant(f"{kind} {now()}".encode(), ua.VariantType.ByteString),
            "EventType": node(kind),
            "SourceNode": ua.Variant(server, ua.VariantType.NodeId),
            "SourceName": ua.Variant("Server", ua.VariantType.String),
            "Time": moment(at),
            "ReceiveTime": moment(at),
            "Message": text("refresh"),
            "Severity": ua.Variant(1, ua.VariantType.UInt16),
        }
        for place in list(subscription.monitored_item_srv._monitored_events):
            await _send(subscription, ConditionEvent(place, fields), item)

    def _notifiers(self, alert: AlertReading) -> Iterator[ua.NodeId]:
        names = self._tree.names
        yield from (ua.NodeId(ua.ObjectIds.Server), names.root, names.node(alert.plant))
        yield names.node(alert.plant, alert.machine)

    def _node(self, alert: AlertReading) -> ua.NodeId:
        return self._machines.node_of(alert.machine, "Alerts", alert.name)

    def _fields(self, alert: AlertReading) -> Fields:
        return condition_fields(alert, condition=self._node(alert), source=self._machines.node_of(alert.machine))

    def _place(self, condition: ua.NodeId, path: str) -> ua.NodeId:
        return ua.NodeId(f"{condition.Identifier}/{path}", condition.NamespaceIndex)

    def _add(self, condition: ua.NodeId, alert: AlertReading, fields: Fields) -> None:
        tree, names = self._tree, self._tree.names
        folder, machine = self._machines.node_of(alert.machine, "Alerts"), self._machines.node_of(alert.machine)
        kind = ua.ObjectIds.AlarmConditionType
        name = names.qualified(alert.name)
        tree.add_object(condition, folder, name, kind=kind, reference=COMPONENT, description=DESCRIPTION)
        tree.refer(machine, condition, ua.ObjectIds.HasCondition)
        tree.refer_to_methods(condition, METHODS)
        shelving = self._place(condition, SHELVING)
        kind = ua.ObjectIds.ShelvedStateMachineType
        tree.add_object(shelving, condition, ua.QualifiedName(SHELVING, 0), kind=kind, reference=COMPONENT)
        tree.refer_to_methods(shelving, SHELVING_METHODS)
        # What holds others comes first.
        for path in sorted(fields, key=lambda one: one.count("/")):
            if path == "NodeId" or path.endswith(LEFT_OUT):
                continue
            stem, _, last = path.rpartition("/")
            parent = self._place(condition, stem) if stem else condition
            variable = last in STATES or last in ("Quality", "LastSeverity", "Comment", "CurrentState")
            tree.add_variable(
                self._place(condition, path),
                parent,
                names.qualified(last) if path in OWN else ua.QualifiedName(last, 0),
                fields[path].VariantType,
                value=fields[path].Value,
                type_definition=ua.ObjectIds.TwoStateVariableType if last in STATES else ua.ObjectIds.BaseDataVariableType,
                reference=COMPONENT if variable else PROPERTY,
            )


async def _send(subscription: InternalSubscription, event: ConditionEvent, item: int | None) -> None:
    service = subscription.monitored_item_srv
    for number in list(service._monitored_events.get(event.emitting_node, ())):
        if item in (None, number):
            await service._trigger_event(event, number)
