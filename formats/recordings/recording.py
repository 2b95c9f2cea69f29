"""Read recorded runs: a table such as a CSV file with a header line, and beside it the sidecar that describes its columns."""

import cmath
from collections.abc import Iterable, Iterator
from datetime import datetime
from pathlib import Path
from typing import Literal

import msgspec
import numpy as np
from msgspec import Struct

from estimator.machine.disc_scale import DiscScale
from estimator.units import RADIANS
from formats.files.document_files import UnreadableFile
from formats.files.like_named_files import like_named
from formats.recordings.empty_table import empty_table_text, is_blank
from formats.recordings.exported_table import is_number
from formats.recordings.recorded_table import MissingColumn, RecordedTable
from formats.recordings.run_times import seconds_since_first, wrong_times
from formats.recordings.sidecar import RecordedChannel, Sidecar, read_sidecar
from formats.recordings.sidecar_place import sidecar_of
from formats.recordings.trial_weights import TrialWeight, require_likely_columns
from formats.wire import TABLES, WIRE_SCHEMA, SampleBatch
from storage.clock import from_datetime

LONGEST_S = 1e9
"""Longest recording: thirty years [s]."""
SPREADSHEETS = (".xlsx", ".xls", ".ods")
"""Ends of files that are no tables of numbers yet."""


def read_recording(path: Path, sidecar_path: Path | None = None) -> SampleBatch:
    """Return all rows of a recording as one batch, numbered from 0. Raises UnreadableFile."""
    sidecar = _sidecar_of(path, sidecar_path)
    table = RecordedTable.read(path)
    speed = _speed(table, sidecar)
    _require_stated_units(path, table, sidecar)
    turn = 1.0 if sidecar.phase_unit == "rad" else RADIANS["deg"]
    return SampleBatch(
        schema=WIRE_SCHEMA,
        plant=sidecar.plant,
        machine=sidecar.machine,
        source=sidecar.source,
        epoch=0,
        sequence=0,
        channels=[channel.channel for channel in sidecar.channels],
        speed_unit=sidecar.speed_unit,
        amplitude_unit=sidecar.amplitude_unit,
        amplitude_kind=sidecar.amplitude_kind,
        phase_convention=sidecar.phase_convention,
        phase_unit=sidecar.phase_unit,
        direction=sidecar.direction,
        time_ns=_times(path, table, sidecar, len(speed)),
        speed=speed,
        amplitude=_rows(_amplitude(table, channel) for channel in sidecar.channels),
        phase=_rows(_phase(table, channel, turn) for channel in sidecar.channels),
        scatter=_optional(table, [one.scatter for one in sidecar.channels], len(speed)),
        gap=_optional(table, [one.gap for one in sidecar.channels], len(speed)),
        gap_unit=sidecar.gap_unit,
        overall=_optional(table, [one.overall for one in sidecar.channels], len(speed)),
        conditions={name: table.gappy(column) for name, column in sidecar.conditions.items()} or None,
    )


def _require_stated_units(path: Path, table: RecordedTable, sidecar: Sidecar) -> None:
    """Raise UnreadableFile where a header, or a line of units below it, states another unit than the sidecar."""
    of_amplitude = ("amplitude_unit", "amplitude_kind")
    fields = {"phase": ("phase_unit", "phase_convention"), "gap": ("gap_unit",), "channel": ()}
    columns: list[tuple[str, tuple[str, ...]]] = [(sidecar.speed, ("speed_unit",))]
    for channel in sidecar.channels:
        columns += [(one, fields.get(what, of_amplitude)) for what, one in channel.model_dump(exclude_none=True).items()]
    for column, of_column in columns:
        for field, unit in table.stated_units(column, of_column).items():
            if unit != getattr(sidecar, field):
                said = f"its sidecar says {field}: {getattr(sidecar, field)}"
                raise UnreadableFile(f"{path}: column '{column}' is in {unit} by its header, but {said}: correct one of them")


def states_start(path: Path, sidecar_path: Path | None = None) -> bool:
    """Return whether a recording's sidecar, or its own times, say when it was taken. Raises UnreadableFile."""
    sidecar = _sidecar_of(path, sidecar_path)
    if "start" in sidecar.model_fields_set or sidecar.time is None:
        return "start" in sidecar.model_fields_set
    return bool(RecordedTable.read(path).moments(sidecar.time))


def _sidecar_of(path: Path, sidecar_path: Path | None) -> Sidecar:
    """Return the sidecar of a recording, by default the one beside it. Raises UnreadableFile."""
    if path.is_dir():
        raise UnreadableFile(f"{path} is a folder, not a recording")
    beside = sidecar_path or sidecar_of(path)
    if not path.exists():
        raise UnreadableFile(f"{path}: no such file{like_named(path)}")
    if path.suffix in (".yaml", ".yml", ".json"):
        raise UnreadableFile(f"{path} is no recording: name the table of the run, such as a CSV file")
    if path.suffix.lower() in SPREADSHEETS:
        raise UnreadableFile(f"{path} is a spreadsheet: save its table as CSV")
    if not beside.exists():
        if is_blank(path):
            raise UnreadableFile(empty_table_text(path))
        raise UnreadableFile(f"{path} needs a sidecar {beside} that says what its columns mean; see docs/integrators.md")
    sidecar = read_sidecar(beside)
    if sidecar.kind == "sweep" and (sidecar.time is None) == (sidecar.interval_s is None):
        raise UnreadableFile(f"{path}: its sidecar must give either the column `time` or `interval_s`")
    return sidecar


def _times(path: Path, table: RecordedTable, sidecar: Sidecar, count: int) -> list[int]:
    """Return the times of `count` rows [ns]. Raises UnreadableFile."""
    start = from_datetime(sidecar.start)
    if sidecar.time is None:
        interval = sidecar.interval_s or 1.0  # rows of dwells stand in no order of time
        return [start + round(i * interval * 1e9) for i in range(count)]
    moments = table.moments(sidecar.time)
    if moments and "start" not in sidecar.model_fields_set:
        start = from_datetime(moments[0])
    seconds = _since_first(moments, f"{path}, column '{sidecar.time}'") if moments else table.column(sidecar.time)
    if not all(abs(s) < LONGEST_S for s in seconds):
        raise UnreadableFile(f"{path}: column '{sidecar.time}' must hold seconds since the start, below {LONGEST_S:.0e}")
    if sidecar.kind == "sweep" and (wrong := wrong_times(np.array(seconds), dated=bool(moments))):
        raise UnreadableFile(f"{path}, column '{sidecar.time}': {wrong}")
    return [start + round(s * 1e9) for s in seconds]


def _since_first(moments: list[datetime], where: str) -> list[float]:
    """Return the seconds from the first moment to each. Raises UnreadableFile."""
    try:
        return [one or 0.0 for one in seconds_since_first(moments)]
    except ValueError as error:
        raise UnreadableFile(f"{where}: {error}") from None


def _optional(table: RecordedTable, columns: list[str | None], count: int) -> list[list[float | None]] | None:
    """Return what channels may have, row by row, from the column of each; None where no channel has one."""
    if not any(columns):
        return None
    return _rows([None] * count if one is None else table.gappy(one) for one in columns)


def _rows(columns: Iterable[list[float | None]]) -> list[list[float | None]]:
    """Return columns row by row."""
    return [list(row) for row in zip(*columns, strict=True)]


def _speed(table: RecordedTable, sidecar: Sidecar) -> list[float]:
    """Return the speed of each row. Raises UnreadableFile."""
    try:
        return table.column(sidecar.speed)
    except MissingColumn as error:
        which = f"{error} A" if str(error).endswith("?") else f"{error}: a"
        raise UnreadableFile(
            f"{which} run is nothing without the keyphasor's speed; export it, too, or name its column as `speed` in the "
            "sidecar"
        ) from None


def split(batch: SampleBatch, size: int) -> Iterator[SampleBatch]:
    """Yield the batch in pieces of at most `size` samples."""
    for start in range(0, len(batch.time_ns), size):
        piece = slice(start, start + size)
        yield msgspec.structs.replace(
            batch,
            sequence=batch.sequence + start,
            time_ns=batch.time_ns[piece],
            speed=batch.speed[piece],
            conditions=None
            if batch.conditions is None
            else {name: values[piece] for name, values in batch.conditions.items()},
            **{name: rows if rows is None else rows[piece] for name in TABLES for rows in [getattr(batch, name)]},
        )


def _amplitude(table: RecordedTable, channel: RecordedChannel) -> list[float | None]:
    """Return the amplitude of a channel in each row."""
    if channel.amplitude is not None:
        return table.gappy(channel.amplitude)
    return [None if one is None else abs(one) for one in _vectors(table, channel)]


def _phase(table: RecordedTable, channel: RecordedChannel, turn: float) -> list[float | None]:
    """Return the phase of a channel in each row, in the recording's unit, of which one is `turn` radians."""
    if channel.phase is not None:
        return table.gappy(channel.phase)
    return [None if one is None else cmath.phase(one) / turn for one in _vectors(table, channel)]


def _vectors(table: RecordedTable, channel: RecordedChannel) -> list[complex | None]:
    pairs = zip(table.gappy(channel.real or ""), table.gappy(channel.imaginary or ""), strict=True)
    return [None if real is None or imaginary is None else complex(real, imaginary) for real, imaginary in pairs]


class RecordedCircumstances(Struct, frozen=True):
    """Statements of a recording's sidecar on the machine in each of its rows.

    Attributes:
        kind: Whether it is a sweep or rows at constant speeds.
        stated: Whether the sidecar says which trial weights were on.
        added: Unbalance that they added by disc, a value per row [kg m].
        units: Unit in which that was given, by disc; those of masses at a radius, and kg m by themselves, are left out.
        mounting: Name of the mounting of each row.
        scale: The scale of angles on the discs.
        direction: +1 where +x turned to +y, else -1.
        dated: Whether the times of the rows are dates.
        unnamed: Columns of words that the sidecar of a sweep does not name; rows of dwells have names of their own.
    """

    kind: Literal["sweep", "dwells"]
    stated: bool
    added: dict[str, list[complex]]
    units: dict[str, str]
    mounting: list[str]
    scale: DiscScale
    direction: int
    dated: bool = False
    unnamed: tuple[str, ...] = ()


def read_circumstances(path: Path, sidecar_path: Path | None = None) -> RecordedCircumstances:
    """Return trial weights and mountings of all rows of a recording. Raises UnreadableFile."""
    sidecar, table = _sidecar_of(path, sidecar_path), RecordedTable.read(path)
    direction = 1 if sidecar.direction == "positive" else -1

    def unbalances(weight: TrialWeight) -> list[complex]:
        columns = {one: table.column(one) for one in (weight.amount, weight.angle_deg) if isinstance(one, str)}
        try:
            require_likely_columns(weight, columns)
        except ValueError as error:
            raise UnreadableFile(f"{path}: {error}") from None
        return [
            weight.unbalance(lambda name, row=row: columns[name][row], sidecar.disc_scale, direction=direction)  # type: ignore[misc]
            for row in range(len(table.rows))
        ]

    return RecordedCircumstances(
        kind=sidecar.kind,
        stated=sidecar.added_unbalance is not None,
        added={disc: unbalances(weight) for disc, weight in sidecar.trial_weights.items()},
        units={disc: one.unit for disc, one in sidecar.trial_weights.items() if one.unit is not None and one.radius is None},
        mounting=[path.stem] * len(table.rows) if sidecar.mounting is None else table.words(sidecar.mounting),
        scale=sidecar.disc_scale,
        direction=direction,
        dated=sidecar.time is not None and not is_number(table.words(sidecar.time)[0]),
        unnamed=tuple(one for one in table.columns_of_words() if sidecar.kind == "sweep" and one not in sidecar.columns),
    )
