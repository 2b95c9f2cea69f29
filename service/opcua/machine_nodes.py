"""The nodes of a machine: what clients see of it, kept as the store has it.

Objects / Rundown / PLANT / MACHINE
    State, Runs, Identification     what it does, its last run, its last identification
    Parameters, Alignment, Loads, Derived     a variable each, with its unit and its 95 % interval as properties
    Alerts      counts, and a condition for each open alert
"""

from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

from asyncua import ua

from estimator.units import rad_per_s_to_rpm
from service.alerts.lifecycle import Severity
from service.opcua import machine_reading
from service.opcua.condition_state import SEVERITIES
from service.opcua.engineering_units import engineering_unit
from service.opcua.machine_reading import MachineReading, ValueReading
from service.opcua.node_tree import COMPONENT, PROPERTY, NodeTree
from service.opcua.trend_aggregates import FUNCTIONS
from service.runs.collection_state import CollectionState
from storage.clock import to_datetime

STATUS = {
    machine_reading.ACCEPTED: ua.StatusCodes.Good,
    machine_reading.NOT_ACCEPTED: ua.StatusCodes.UncertainSubNormal,
    machine_reading.NOT_ESTIMABLE: ua.StatusCodes.BadDataUnavailable,
    machine_reading.NOT_IDENTIFIED: ua.StatusCodes.BadWaitingForInitialData,
}
"""Status of a value of each quality."""
FLOAT, TEXT, WHOLE, TIME = ua.VariantType.Double, ua.VariantType.String, ua.VariantType.Int64, ua.VariantType.DateTime
BOOLEAN = ua.VariantType.Boolean
FIGURES: dict[str, dict[str, ua.VariantType]] = {
    "State": {"Mode": TEXT, "Since": TIME, "NewestSampleAt": TIME},
    "Runs": {"Id": WHOLE, "Kind": TEXT, "State": TEXT, "StartedAt": TIME, "EndedAt": TIME},
    "Identification": {"Id": WHOLE, "MeasuredAt": TIME, "Accepted": BOOLEAN, "Verdict": TEXT},
    "Alerts": {"Open": WHOLE, "Unacknowledged": WHOLE, "HighestSeverity": ua.VariantType.UInt16},
}
"""Variables of a machine's folders that are no measured quantity."""
OWN_FIGURES = {"Name": TEXT, "Revision": WHOLE}
"""Variables of the machine itself."""
SPEED = "Speed"
AGGREGATE_FOLDERS = (
    ua.ObjectIds.Server_ServerCapabilities_AggregateFunctions,
    ua.ObjectIds.HistoryServerCapabilities_AggregateFunctions,
)
"""Folders in which clients look for aggregates."""
NOTIFIER = ua.ObjectIds.HasNotifier
"""Reference from a plant to its machines: whose events pass on to it. It is hierarchical, as Organizes is."""
GONE = "the newest identification has no such quantity"
LOWER, UPPER, ANGLE, QUALITY, REASON, UNIT = "Lower95", "Upper95", "AngleDeg", "Quality", "Reason", "EngineeringUnits"


class MachineNodes:
    """Nodes of the machines of all plants."""

    def __init__(self, tree: NodeTree) -> None:
        self._tree = tree
        self._names = tree.names
        self._shown: dict[str, set[tuple[str, str]]] = {}
        self._plants: dict[str, str] = {}

    def add_root(self) -> None:
        """Add the folder of all plants."""
        objects, server = ua.NodeId(ua.ObjectIds.ObjectsFolder), ua.NodeId(ua.ObjectIds.Server)
        root = self._names.root
        self._tree.add_object(root, objects, self._names.qualified("Rundown"), notifies=True, description="all plants")
        self._tree.refer(server, root, NOTIFIER)
        for function in FUNCTIONS:
            for place in AGGREGATE_FOLDERS:
                self._tree.refer(ua.NodeId(place), ua.NodeId(function), ua.ObjectIds.Organizes)

    def node_of(self, machine: str, *parts: str) -> ua.NodeId:
        """Return the node of a machine or, with `parts`, of a part of it. Raises KeyError for one that is not shown."""
        return self._names.node(self._plants[machine], machine, *parts)

    def shows(self, machine: str) -> bool:
        """Return whether a machine is shown."""
        return machine in self._plants

    async def show(self, reading: MachineReading) -> None:
        """Show a machine as it was read."""
        if reading.id not in self._plants:
            self._add_machine(reading)
        await self._show_glance(reading)
        shown = self._shown.setdefault(reading.id, set())
        found = {(one.folder, one.name) for one in reading.values}
        for one in reading.values:
            if (one.folder, one.name) not in shown:
                self._add_value(reading.id, one)
                shown.add((one.folder, one.name))  # at once: should showing one fail, the others are there next time
            await self._show_value(reading.id, one)
        at = None if reading.identification is None else reading.identification.measured_at
        for folder, name in shown - found:
            gone = ValueReading(folder, name, "", None, None, None, None, machine_reading.NOT_ESTIMABLE, GONE, at)
            await self._show_value(reading.id, gone)

    async def show_standing(self, machine: str, standing: CollectionState) -> None:
        """Show state and speed of a machine by its newest samples."""
        if machine not in self._plants:
            return
        seen = to_datetime(standing.seen)
        operating = standing.operating
        since = to_datetime(operating.since) if operating.since else None
        speed = rad_per_s_to_rpm(operating.sweep.readings.last_speed) if operating.sweep.readings.last_time else None
        await self._write(self.node_of(machine, "State", "Mode"), operating.mode, TEXT, at=seen)
        await self._write(self.node_of(machine, "State", "Since"), since, TIME, at=seen)
        await self._write(self.node_of(machine, "State", "NewestSampleAt"), seen, TIME, at=seen)
        await self._write(self.node_of(machine, "State", SPEED), speed, FLOAT, at=seen)

    def _add_machine(self, reading: MachineReading) -> None:
        names, tree, plant = self._names, self._tree, reading.plant
        folder = names.node(plant)
        if not tree.holds(folder):
            tree.add_object(
                folder, names.root, names.qualified(plant), reference=NOTIFIER, notifies=True, description="a plant"
            )
        machine = names.node(plant, reading.id)
        described = reading.glance.machine.name or reading.id
        tree.add_object(
            machine,
            folder,
            names.qualified(reading.id),
            kind=ua.ObjectIds.BaseObjectType,
            reference=NOTIFIER,
            notifies=True,
            description=described,
        )
        self._plants[reading.id] = plant
        for name, variant in OWN_FIGURES.items():
            tree.add_variable(names.node(plant, reading.id, name), machine, names.qualified(name), variant, reference=PROPERTY)
        for name in (*FIGURES, *machine_reading.FOLDERS):
            place = names.node(plant, reading.id, name)
            tree.add_object(place, machine, names.qualified(name), reference=COMPONENT)
            for figure, variant in FIGURES.get(name, {}).items():
                node = names.node(plant, reading.id, name, figure)
                tree.add_variable(node, place, names.qualified(figure), variant)
        self._add_measured(self.node_of(reading.id, "State"), (plant, reading.id, "State", SPEED), SPEED, "r/min")

    def _add_measured(self, parent: ua.NodeId, path: tuple[str, ...], name: str, unit: str, *, history: bool = False) -> None:
        node = self._names.node(*path)
        kind = ua.ObjectIds.AnalogUnitType
        self._tree.add_variable(node, parent, self._names.qualified(name), FLOAT, type_definition=kind, history=history)
        self._tree.add_variable(
            self._names.node(*path, UNIT),
            node,
            ua.QualifiedName(UNIT, 0),
            ua.VariantType.ExtensionObject,
            value=engineering_unit(unit),
            reference=PROPERTY,
            data_type=ua.ObjectIds.EUInformation,
        )

    def _add_value(self, machine: str, one: ValueReading) -> None:
        path = (self._plants[machine], machine, one.folder, one.name)
        self._add_measured(self.node_of(machine, one.folder), path, one.name, one.unit, history=True)
        node = self._names.node(*path)
        for name, variant in ((LOWER, FLOAT), (UPPER, FLOAT), (QUALITY, TEXT), (REASON, TEXT)):
            place = self._names.node(*path, name)
            self._tree.add_variable(
                place, node, self._names.qualified(name), variant, reference=PROPERTY, history=name in (LOWER, UPPER)
            )

    async def _show_value(self, machine: str, one: ValueReading) -> None:
        status = STATUS[one.quality]
        at = None if one.measured_at is None else to_datetime(one.measured_at)
        node = self.node_of(machine, one.folder, one.name)
        await self._write(node, one.value, FLOAT, status=status, at=at)
        for name, bound in ((LOWER, one.lower), (UPPER, one.upper)):
            await self._write(self.node_of(machine, one.folder, one.name, name), bound, FLOAT, status=status, at=at)
        place = self.node_of(machine, one.folder, one.name, ANGLE)
        if one.has_angle and not self._tree.holds(place):  # some turn out to be vectors with their first value
            self._tree.add_variable(place, node, self._names.qualified(ANGLE), FLOAT, reference=PROPERTY)
        if self._tree.holds(place):
            await self._write(place, one.angle_deg, FLOAT, status=status, at=at)
        await self._write(self.node_of(machine, one.folder, one.name, QUALITY), one.quality, TEXT, at=at)
        await self._write(self.node_of(machine, one.folder, one.name, REASON), one.reason, TEXT, at=at)

    async def _show_glance(self, reading: MachineReading) -> None:
        glance, last = reading.glance, reading.identification
        worst = max((severity for severity, count in glance.open_alerts.items() if count), default=None)
        highest = 0 if worst is None else SEVERITIES[Severity(worst)]
        figures: dict[tuple[str, ...], Any] = {("Name",): glance.machine.name, ("Revision",): glance.machine.revision}
        figures |= _under("Alerts", Open=sum(glance.open_alerts.values()), Unacknowledged=glance.unacknowledged)
        figures |= _under("Alerts", HighestSeverity=highest)
        await self._write_figures(reading.id, figures, None)
        if (run := glance.last_run) is not None:
            figures = _under("Runs", Id=run.id, Kind=run.kind, State=run.state)
            figures |= _under("Runs", StartedAt=to_datetime(run.time_first), EndedAt=_time_or_none(run.time_last))
            await self._write_figures(reading.id, figures, run.time_first if run.time_last is None else run.time_last)
        if last is not None:
            figures = _under("Identification", Id=last.id, MeasuredAt=to_datetime(last.measured_at))
            figures |= _under("Identification", Accepted=last.accepted, Verdict=last.verdict)
            await self._write_figures(reading.id, figures, last.measured_at)

    async def _write_figures(self, machine: str, figures: Mapping[tuple[str, ...], Any], at: int | None) -> None:
        """Write variables that are no measured quantity. at: their source time [ns]; None: when they change."""
        for path, value in figures.items():
            variant = FIGURES[path[0]][path[1]] if len(path) > 1 else OWN_FIGURES[path[0]]
            await self._write(self.node_of(machine, *path), value, variant, at=None if at is None else to_datetime(at))

    async def _write(
        self,
        node: ua.NodeId,
        value: Any,
        variant: ua.VariantType,
        *,
        status: int = ua.StatusCodes.Good,
        at: datetime | None = None,
    ) -> None:
        if value is None and status == ua.StatusCodes.Good:
            status = ua.StatusCodes.BadDataUnavailable
        bad = ua.StatusCode(status).is_bad()
        held = ua.Variant(None, ua.VariantType.Null) if bad else ua.Variant(value, variant)
        written = ua.DataValue(held, ua.StatusCode(status), SourceTimestamp=at, ServerTimestamp=datetime.now(UTC))
        await self._tree.write(node, written)


def _under(folder: str, **values: Any) -> dict[tuple[str, ...], Any]:
    return {(folder, name): value for name, value in values.items()}


def _time_or_none(at: int | None) -> datetime | None:
    return None if at is None else to_datetime(at)
