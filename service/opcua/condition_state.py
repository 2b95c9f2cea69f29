"""An alert as a condition: which states of OPC UA's alarms each state of ours is, and the fields of an event.

Source: OPC 10000-9 (Alarms & Conditions), 5.5 to 5.8: ConditionType, AcknowledgeableConditionType, AlarmConditionType. An
episode of ISA-18.2 is active, acknowledged and latched there as here. Ours that is latched waits for a person who
looks at the machine and resets it: there it is not confirmed yet, and Confirm as well as Reset resets it.
"""

import struct
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta
from typing import Any

from asyncua import ua

from service.alerts.lifecycle import ACTIVE, LATCHED, AlertCondition, Severity, Suppression
from service.alerts.transitions import LONGEST_SHELVING_DAYS
from service.opcua.alert_reading import AlertReading
from storage.clock import now, to_datetime

SEVERITIES = {Severity.ALERT: 500, Severity.DANGER: 900}
"""OPC UA's severity, 1 to 1000, of each of ours: medium and high after OPC 10000-5, 6.4.2."""
EVENT_ID = struct.Struct(">8sQQ")
EVENT_MARK = b"rundown\0"
LONGEST_SHELVING_MS = timedelta(days=LONGEST_SHELVING_DAYS).total_seconds() * 1e3
SHELVINGS = {
    "Unshelved": ua.ObjectIds.ShelvedStateMachineType_Unshelved,
    "Timed Shelved": ua.ObjectIds.ShelvedStateMachineType_TimedShelved,
    "One Shot Shelved": ua.ObjectIds.ShelvedStateMachineType_OneShotShelved,
}
"""States of shelving by their words."""
UNACKNOWLEDGED = frozenset({AlertCondition.UNACKNOWLEDGED, AlertCondition.RETURNED, AlertCondition.LATCHED_UNACKNOWLEDGED})
STATES: dict[str, tuple[str, str]] = {
    "EnabledState": ("Enabled", "Disabled"),
    "ActiveState": ("Active", "Inactive"),
    "AckedState": ("Acknowledged", "Unacknowledged"),
    "ConfirmedState": ("Confirmed", "Unconfirmed"),
    "LatchedState": ("Latched", "Unlatched"),
    "SuppressedState": ("Suppressed", "Unsuppressed"),
    "OutOfServiceState": ("Out of Service", "In Service"),
}
"""Words of each two-state variable when it is true and when not: the words of OPC 10000-9."""

Fields = dict[str, ua.Variant]
"""Fields of an event by their paths, such as `AckedState/Id`."""


def event_id(alert: AlertReading) -> bytes:
    """Return the id of an event of an alert."""
    return EVENT_ID.pack(EVENT_MARK, alert.id, alert.event)


def alert_and_event(identifier: object) -> tuple[int, int] | None:
    """Return the ids of alert and event in an event id; None for an event id of another server."""
    if not isinstance(identifier, bytes) or len(identifier) != EVENT_ID.size:
        return None
    mark, alert, event = EVENT_ID.unpack(identifier)
    return (alert, event) if mark == EVENT_MARK else None


def states(alert: AlertReading) -> dict[str, bool]:
    """Return the two-state variables of an alert."""
    status = alert.status
    return {
        "EnabledState": True,
        "ActiveState": status.condition in ACTIVE,
        "AckedState": status.condition not in UNACKNOWLEDGED,
        "ConfirmedState": status.condition not in LATCHED,
        "LatchedState": status.condition in LATCHED,
        "SuppressedState": Suppression.SUPPRESSED_BY_DESIGN in status.suppressions,
        "OutOfServiceState": Suppression.OUT_OF_SERVICE in status.suppressions,
    }


def condition_fields(alert: AlertReading, *, condition: ua.NodeId, source: ua.NodeId) -> Fields:
    """Return all fields of the event. condition: node of the alert's condition; source: node of its machine."""
    at = to_datetime(alert.at)
    fields = _event(alert, at, condition=condition, source=source) | _shelving(alert)
    for name, on in states(alert).items():
        words = STATES[name]
        fields[name] = text(words[0] if on else words[1])
        fields[f"{name}/Id"] = ua.Variant(on, ua.VariantType.Boolean)
        fields[f"{name}/TrueState"], fields[f"{name}/FalseState"] = text(words[0]), text(words[1])
        fields[f"{name}/TransitionTime"] = moment(at)
    fields["ActiveState/EffectiveDisplayName"] = fields["EnabledState/EffectiveDisplayName"] = text(alert.status.state)
    return fields


def _event(alert: AlertReading, at: datetime, *, condition: ua.NodeId, source: ua.NodeId) -> Fields:
    severity = ua.Variant(SEVERITIES[alert.status.severity], ua.VariantType.UInt16)
    return {
        "NodeId": ua.Variant(condition, ua.VariantType.NodeId),
        "EventId": ua.Variant(event_id(alert), ua.VariantType.ByteString),
        "EventType": node(ua.ObjectIds.AlarmConditionType),
        "SourceNode": ua.Variant(source, ua.VariantType.NodeId),
        "SourceName": ua.Variant(alert.machine, ua.VariantType.String),
        "Time": moment(at),
        "ReceiveTime": moment(datetime.now(UTC)),
        "Message": text(alert.message),
        "Severity": severity,
        "ConditionClassId": node(ua.ObjectIds.MaintenanceConditionClassType),
        "ConditionClassName": text("MaintenanceConditionClassType"),
        "ConditionName": ua.Variant(alert.name, ua.VariantType.String),
        "BranchId": node(ua.ObjectIds.Null),
        "Retain": ua.Variant(alert.is_open, ua.VariantType.Boolean),
        "Quality": ua.Variant(ua.StatusCode(ua.StatusCodes.Good), ua.VariantType.StatusCode),
        "Quality/SourceTimestamp": moment(at),
        "LastSeverity": severity,
        "LastSeverity/SourceTimestamp": moment(at),
        "Comment": text(alert.comment),
        "Comment/SourceTimestamp": moment(at),
        "ClientUserId": ua.Variant(alert.by, ua.VariantType.String),
        "InputNode": node(ua.ObjectIds.Null),
        "Rule": ua.Variant(alert.rule, ua.VariantType.String),
        "Element": ua.Variant(alert.element, ua.VariantType.String),
        "State": ua.Variant(alert.status.state, ua.VariantType.String),
        "AlertId": ua.Variant(alert.id, ua.VariantType.Int64),
        "Identification": ua.Variant(alert.identification, ua.VariantType.Int64),
    }


def _shelving(alert: AlertReading) -> Fields:
    words = "Unshelved" if alert.shelved_until is None else "One Shot Shelved" if alert.shelved_once else "Timed Shelved"
    left = 0.0 if alert.shelved_until is None else max(0.0, (alert.shelved_until - now()) / 1e6)
    return {
        "ShelvingState/CurrentState": text(words),
        "ShelvingState/CurrentState/Id": node(SHELVINGS[words]),
        "ShelvingState/UnshelveTime": ua.Variant(left, ua.VariantType.Double),
        "SuppressedOrShelved": ua.Variant(bool(alert.status.suppressions), ua.VariantType.Boolean),
        "MaxTimeShelved": ua.Variant(LONGEST_SHELVING_MS, ua.VariantType.Double),
    }


class ConditionEvent:
    """An event as the library's subscriptions take it: they select its fields, and evaluate filters on its attributes."""

    def __init__(self, emitting_node: ua.NodeId, fields: Fields) -> None:
        self.emitting_node = emitting_node
        self.fields = fields

    def value(self, path: Sequence[str]) -> Any:
        """Return the plain value of a field; None where it has none of that path."""
        found = self.fields.get("/".join(path))
        return None if found is None else found.Value

    def to_event_fields(self, select_clauses: Sequence[ua.SimpleAttributeOperand]) -> list[ua.Variant]:
        """Return the selected fields, null for those that it does not have."""
        return [self.fields.get(_path(one), ua.Variant(None, ua.VariantType.Null)) for one in select_clauses]


def _path(clause: ua.SimpleAttributeOperand) -> str:
    if clause.BrowsePath:
        return "/".join(part.Name for part in clause.BrowsePath)
    return "NodeId" if clause.AttributeId == ua.AttributeIds.NodeId else ""


def text(words: str) -> ua.Variant:
    """Return a text as a value."""
    return ua.Variant(ua.LocalizedText(words, "en"), ua.VariantType.LocalizedText)


def node(number: int) -> ua.Variant:
    """Return one of the standard's nodes as a value."""
    return ua.Variant(ua.NodeId(number), ua.VariantType.NodeId)


def moment(at: datetime) -> ua.Variant:
    """Return a time as a value."""
    return ua.Variant(at, ua.VariantType.DateTime)
