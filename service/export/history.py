"""Exports a machine's history as CSV and Parquet files, with `columns.json` to explain each column."""

import itertools
import json
import logging
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from sqlalchemy import func, select
from sqlalchemy.orm import Session, undefer

from estimator.machine.document import Machine, parse_machine
from estimator.phasors.channel_status import ChannelStatus
from service.export.column_writer import Column, TableRows, write
from storage.database.engine import Database
from storage.encoding.sample_blocks import DamagedBlock, Samples
from storage.files.private_files import PRIVATE_FOLDER, prepare
from storage.machines.machines import MachineUnknown
from storage.measurements import runs
from storage.tables.alerting import AlertEventRow, AlertRow, SuppressionRow
from storage.tables.base import Base
from storage.tables.findings import DerivedRow, DiagnosisRow, EstimateRow, IdentificationRow
from storage.tables.machines import (
    BalancingRow,
    BaselineRow,
    CalibrationRow,
    LimitsRow,
    MachineRow,
    ModelCalibrationRow,
    RevisionRow,
    SlowRollRow,
    TimelineRow,
)
from storage.tables.measurements import MachineStateRow, RunRow

logger = logging.getLogger(__name__)

AT_ONCE = 1_000

_ID = Column("identification", "integer", "number of the identification, see identifications")
_MEASURED = Column("measured_at", "time", "when the newest of its samples was taken")
_REASON = Column("reason", "text", "why there is no value")
_BOUNDS = (
    Column("lower", "number", "lower end of the 95 % interval", "see unit"),
    Column("upper", "number", "upper end of the 95 % interval", "see unit"),
)
_BY = (Column("by", "text", "who said it"), Column("created_at", "time", "when it was stored"))
_SPEEDS = (
    Column("speed_minimum", "number", "lowest speed", "rad/s"),
    Column("speed_maximum", "number", "highest speed", "rad/s"),
)
_DIRECTION = Column("direction", "integer", "sense of rotation, +1 or -1")
_VERDICT = Column("verdict", "text", "the same in words")
_CODE = Column("code_version", "text", "release of Rundown that computed it")
_COMPUTED = Column("computed_at", "time", "when it was computed")
_DID = Column("by", "text", "who did it")
_SAID = Column("comment", "text", "what they said")
IDENTIFICATIONS = (
    Column("id", "integer", "number of the identification"),
    Column("revision", "integer", "revision of the machine's document that it was made with"),
    Column("scope", "text", "run: one run; gathered: the newest runs together; variant: one run with other options"),
    Column("run_kind", "text", "run-up, run-down, rolling or dwells"),
    Column("run_ids", "text", "numbers of its runs, as JSON"),
    _MEASURED,
    _COMPUTED,
    Column("accepted", "truth", "whether the model explains the data"),
    _VERDICT,
    Column("chi_square", "number", "weighted sum of the squared residuals"),
    Column("degrees_of_freedom", "integer", "what it is expected to be"),
    Column("condition_number", "number", "of the scaled information matrix"),
    Column("samples", "integer", "samples that it was made from"),
    *_SPEEDS,
    Column("noise_relative", "number", "rms of the complex error, part of the amplitude", "1"),
    Column("noise_floor", "number", "rms of the complex error that is always there", "m"),
    Column("slow_roll_version", "integer", "slow-roll vectors that were subtracted; none where there is no value"),
    Column(
        "load_balance",
        "integer",
        "version of the balance of loads on oil films beside unknown couplings or pedestals: values of two versions are not "
        "to be compared; no value before the second, or where it does not matter",
    ),
    _CODE,
)
TRENDS = (
    _ID,
    Column("parameter", "text", "name of the parameter, such as coupling.C1.kxx"),
    _MEASURED,
    Column("quantity", "text", "what kind of parameter it is"),
    Column("element", "text", "bearing, coupling or disc that it belongs to"),
    Column("unit", "text", "unit of the values"),
    Column("value", "number", "estimate; of an unbalance the real part", "see unit"),
    Column("standard_error", "number", "its standard error", "see unit"),
    *_BOUNDS,
    Column("imaginary", "number", "of an unbalance the imaginary part", "see unit"),
    Column("imaginary_standard_error", "number", "its standard error", "see unit"),
    _REASON,
)
DERIVED = (
    _ID,
    Column("name", "text", "name of the derived quantity"),
    _MEASURED,
    Column("unit", "text", "unit of the values"),
    Column("value", "number", "what follows from the estimates", "see unit"),
    *_BOUNDS,
    _REASON,
)
ALERTS = (
    Column("id", "integer", "number of the alert"),
    Column("rule", "text", "what it says"),
    Column("element", "text", "where"),
    Column("state", "text", "state after ISA-18.2"),
    Column("severity", "integer", "severity"),
    Column("message", "text", "what it says in words"),
    Column("evidence", "text", "why, as JSON"),
    Column("identification_id", "integer", "identification that it was last seen in"),
    Column("measured_at", "time", "when it was last seen"),
    Column("opened_at", "time", "when it began"),
    Column("closed_at", "time", "when it ended"),
)
ALERT_EVENTS = (
    Column("alert_id", "integer", "number of the alert"),
    Column("number", "integer", "number of the event in the alert's life"),
    Column("at", "time", "when it happened"),
    Column("kind", "text", "what happened"),
    Column("state_before", "text", "state before"),
    Column("state", "text", "state after"),
    Column("severity", "integer", "severity then"),
    _DID,
    _SAID,
)
RUNS = (
    Column("id", "integer", "number of the run"),
    Column("revision", "integer", "revision of the machine's document then"),
    Column("kind", "text", "run-up, run-down, rolling or dwells"),
    _DIRECTION,
    Column("state", "text", "open, closed or discarded"),
    Column("reason", "text", "why it ended"),
    Column("time_first", "time", "first sample"),
    Column("time_last", "time", "last sample"),
    *_SPEEDS,
    Column("count", "integer", "samples"),
)
DIAGNOSES = (
    _ID,
    _MEASURED,
    Column("made_at", "time", "when it was made"),
    Column("baseline", "text", "numbers of the identifications that it was compared with, as JSON"),
    Column("runs", "integer", "how many runs were looked at together"),
    Column("causes", "text", "what may be the cause, and why, as JSON"),
)
BASELINES = (
    Column("id", "integer", "number of the baseline"),
    Column("since", "time", "it holds for what was measured from then on, until the next one"),
    Column(
        "identification_ids",
        "text",
        "identifications that were chosen, as JSON; where there are none, it is the first ones from then on",
    ),
    Column("reason", "text", "why it was set"),
    *_BY,
)
TIMELINE = (
    Column("id", "integer", "number of the note"),
    Column("at", "time", "what moment it is of"),
    Column("kind", "text", "note, maintenance or marker"),
    Column("text", "text", "what it says"),
    *_BY,
)
SUPPRESSIONS = (
    Column("id", "integer", "number of the suppression"),
    Column("kind", "text", "shelved, suppressed_by_design or out_of_service"),
    Column("rule", "text", "only of this rule, where there is one"),
    Column("element", "text", "only of this element, where there is one"),
    Column("since", "time", "when it began"),
    Column("until", "time", "when it ends by itself"),
    Column("until_cleared", "truth", "whether it ends with the cause of the alert that was shelved"),
    _DID,
    _SAID,
    Column("ended_at", "time", "when it ended"),
    Column("ended_by", "text", "who ended it"),
)
LIMITS = (
    Column("version", "integer", "version of the limits; the newest is in force"),
    Column("document", "text", "the limits, as JSON"),
    Column("at", "time", "when they were set"),
    Column("by", "text", "who set them"),
    _SAID,
)
CALIBRATIONS = (
    Column("id", "integer", "number of the calibration"),
    Column("channel", "text", "channel that was calibrated"),
    Column("at", "time", "when it was"),
    Column("certificate", "text", "what the certificate says"),
    *_BY,
)
MODEL_CALIBRATIONS = (
    Column("id", "integer", "number of the calibration"),
    Column("revision", "integer", "revision of the machine's document that it begins from"),
    Column("asked", "text", "runs with their weights [g mm, °] and the seed, as JSON"),
    _COMPUTED,
    Column("accepted", "truth", "whether the model explains the runs"),
    _VERDICT,
    Column("result", "text", "remarks and starts, as JSON"),
    Column("document", "text", "the calibrated document, as JSON"),
    _CODE,
    Column("revision_in_force", "integer", "revision as which it was put in force last"),
    Column("comment", "text", "what was said of it"),
    *_BY,
)
BALANCINGS = (
    Column("id", "integer", "number of the field balancing"),
    Column("revision", "integer", "revision of the machine's document that its runs were measured under"),
    Column("state", "text", "step taken last: begun, tried, proposed or checked"),
    Column("steps", "text", "initial runs, trials with their weights, correction and check run, as JSON"),
    Column("comment", "text", "what was said of it"),
    Column("updated_at", "time", "when its last step was taken"),
    *_BY,
)
STATES = (
    Column("since", "time", "from when on, until the next row"),
    Column("mode", "text", "what the machine did"),
    Column("speed", "number", "speed of rotation", "rad/s"),
)
SLOW_ROLL = (
    Column("version", "integer", "version of the slow-roll vectors"),
    Column("created_at", "time", "when they were stored"),
    Column("origin", "text", "given or captured"),
    _DIRECTION,
    Column("vectors", "text", "of each channel, as JSON", "m"),
    Column("speed_minimum", "number", "lowest speed that they were measured at", "rad/s"),
    Column("speed_maximum", "number", "highest speed that they were measured at", "rad/s"),
    Column("time_first", "time", "first sample that they were made from"),
    Column("time_last", "time", "last sample that they were made from"),
    Column("comment", "text", "what was said of them"),
)
_TABLES: tuple[tuple[str, tuple[Column, ...], type[Base], tuple[str, ...]], ...] = (
    ("identifications", IDENTIFICATIONS, IdentificationRow, ("measured_at", "id")),
    ("trends", TRENDS, EstimateRow, ("parameter", "measured_at", "identification_id")),
    ("derived", DERIVED, DerivedRow, ("name", "measured_at", "identification_id")),
    ("alerts", ALERTS, AlertRow, ("id",)),
    ("alert_events", ALERT_EVENTS, AlertEventRow, ("alert_id", "number")),
    ("runs", RUNS, RunRow, ("time_first", "id")),
    ("states", STATES, MachineStateRow, ("since", "id")),
    ("diagnoses", DIAGNOSES, DiagnosisRow, ("measured_at", "identification_id")),
    ("baselines", BASELINES, BaselineRow, ("id",)),
    ("timeline", TIMELINE, TimelineRow, ("at", "id")),
    ("suppressions", SUPPRESSIONS, SuppressionRow, ("id",)),
    ("limits", LIMITS, LimitsRow, ("version",)),
    ("calibrations", CALIBRATIONS, CalibrationRow, ("at", "id")),
    ("model_calibrations", MODEL_CALIBRATIONS, ModelCalibrationRow, ("id",)),
    ("balancings", BALANCINGS, BalancingRow, ("id",)),
    ("slow_roll_vectors", SLOW_ROLL, SlowRollRow, ("version",)),
)
"""File name, columns, source table, and order of the rows."""


def export(
    database: Database, machine_id: str, folder: Path, report: Callable[[int, int], None] = lambda _done, _all: None
) -> dict[str, int]:
    """Write a machine's history as of one moment into a new or empty folder, for its owner only; return the rows of each file.

    It holds the documents, the samples of the runs, the results and everything that people recorded. It omits samples outside
    of runs, and data needed only to repeat an identification. report: is told how many runs of how many are written.

    Raises MachineUnknown, ParquetMissing, OSError.
    """
    folder.mkdir(PRIVATE_FOLDER, parents=True, exist_ok=True)
    if any(folder.iterdir()):
        raise FileExistsError(f"the folder {folder} is not empty")
    written: dict[str, int] = {}
    described: dict[str, Sequence[Column]] = {}
    with database.reading() as session:
        if session.get(MachineRow, machine_id) is None:
            raise MachineUnknown(machine_id)
        for name, columns, table, order in _TABLES:
            written[name] = write(folder, name, columns, _rows(session, table, machine_id, columns, order))
            described[name] = columns
        total = session.scalar(select(func.count()).where(RunRow.machine_id == machine_id, RunRow.data.is_not(None))) or 0
        done = itertools.count(1)
        documents = select(RevisionRow).where(RevisionRow.machine_id == machine_id).order_by(RevisionRow.revision)
        for row in session.scalars(documents).all():
            _write(folder / f"machine-{row.revision}.json", json.dumps(row.document, indent=1))
            name = f"samples-{row.revision}"
            columns = sample_columns(parse_machine(row.document))
            written[name] = write(
                folder,
                name,
                columns,
                _samples(session, machine_id, row.revision, columns, lambda: report(next(done), total)),
            )
            described[name] = columns
    _describe(folder, machine_id, described)
    return written


def sample_columns(machine: Machine) -> tuple[Column, ...]:
    """Return the columns of the samples of a machine's runs."""
    statuses = ", ".join(f"{status.value}: {status.label}" for status in ChannelStatus)
    found = [
        Column("run", "integer", "number of the run, see runs"),
        Column("time", "time", "when it was taken, by its source's clock"),
        Column("speed", "number", "speed of rotation", "rad/s"),
        _DIRECTION,
    ]
    for probe in machine.probes:
        found += [
            Column(f"{probe.id}.real", "number", "1× phasor X of x(t) = Re(X exp(jωt)), 0-to-peak, real part", "m"),
            Column(f"{probe.id}.imaginary", "number", "its imaginary part", "m"),
            Column(f"{probe.id}.status", "integer", statuses),
            Column(f"{probe.id}.scatter", "number", "rms of its complex error, where the source said it", "m"),
            Column(f"{probe.id}.second.real", "number", "2× phasor, 0-to-peak, real part", "m"),
            Column(f"{probe.id}.second.imaginary", "number", "its imaginary part", "m"),
            Column(f"{probe.id}.gap", "number", "mean place of the shaft towards the probe, from a zero of its own", "m"),
            Column(f"{probe.id}.overall", "number", "unfiltered vibration, half of the peak-to-peak displacement", "m"),
        ]
    found += [
        Column(f"condition.{one.name}", "number", f"operating condition {one.name}", one.unit) for one in machine.conditions
    ]
    return tuple(found)


def _rows(
    session: Session, table: type[Base], machine_id: str, columns: Sequence[Column], order: Sequence[str]
) -> Iterator[TableRows]:
    fields = [getattr(table, "identification_id" if column is _ID else column.name) for column in columns]
    query = select(*fields).where(table.__table__.c.machine_id == machine_id).order_by(*(getattr(table, one) for one in order))
    with session.execute(query.execution_options(yield_per=AT_ONCE)) as found:
        for part in found.partitions():
            yield [[_text(value) for value in row] for row in part]


def _text(value: Any) -> Any:
    return json.dumps(value, ensure_ascii=False) if isinstance(value, dict | list) else value


def _samples(
    session: Session, machine_id: str, revision: int, columns: Sequence[Column], written: Callable[[], None]
) -> Iterator[TableRows]:
    """Yield the samples run by run, in pieces, calling `written` after each; an unreadable one is left out and logged."""
    query = select(RunRow).where(RunRow.machine_id == machine_id, RunRow.revision == revision, RunRow.data.is_not(None))
    ordered = query.options(undefer(RunRow.data)).order_by(RunRow.time_first, RunRow.id).execution_options(yield_per=1)
    with session.scalars(ordered) as found:
        for row in found:
            assert row.data is not None
            try:
                held = runs.read(row.id, row.data)
            except DamagedBlock as error:
                logger.error("left out: %s", error)
            else:
                for first in range(0, len(held), AT_ONCE):
                    yield _sample_rows(row.id, held.pick(slice(first, first + AT_ONCE)), len(columns))
            session.expunge(row)
            written()


def _sample_rows(run: int, held: Samples, width: int) -> TableRows:
    rows: list[list[Any]] = []
    for i in range(len(held)):
        row: list[Any] = [run, int(held.time[i]), float(held.speed[i]), int(held.direction[i])]
        for j in range(held.phasor.shape[1]):
            first, second = held.phasor[i, j], held.second[i, j]
            row += [float(first.real), float(first.imag), int(held.status[i, j]), float(held.scatter[i, j])]
            row += [float(second.real), float(second.imag), float(held.gap[i, j]), float(held.overall[i, j])]
        row += [float(value) for value in held.conditions[i]]
        rows.append(row + [None] * (width - len(row)))
    return rows


def _describe(folder: Path, machine_id: str, files: dict[str, Sequence[Column]]) -> None:
    described = {name: [asdict(column) for column in columns] for name, columns in files.items()}
    text = {"machine": machine_id, "files": described}
    _write(folder / "columns.json", json.dumps(text, indent=1, ensure_ascii=False))


def _write(file: Path, text: str) -> None:
    prepare(file)
    file.write_text(text + "\n")
