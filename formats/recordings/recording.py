"""Recorded runs: a CSV file with a header line, and beside it a sidecar YAML that describes its columns."""

import cmath
import math
from collections.abc import Iterable, Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Literal, Self

import msgspec
import numpy as np
import yaml
from msgspec import Struct
from pydantic import BaseModel, ConfigDict, Field, ValidationError, ValidationInfo, field_validator, model_validator
from pydantic_core import ErrorDetails

from estimator.arrays import Complexes, Floats
from estimator.field_types import Identifier, Positive
from estimator.machine.disc_scale import DiscScale
from estimator.machine.document import Machine, field_path
from estimator.strict_model import own_words
from estimator.unit_names import declared_unit, unknown_unit
from estimator.units import LEAD, METRES, PEAK, RAD_PER_S, RADIANS
from formats.files.csv_cells import CsvWriter, cell
from formats.files.document_files import UnreadableFile, read_yaml
from formats.files.like_named_files import like_named
from formats.recordings.empty_table import empty_table_text, is_blank
from formats.recordings.exported_table import is_number
from formats.recordings.recorded_table import MissingColumn, RecordedTable
from formats.recordings.run_times import seconds_since_first, wrong_times
from formats.recordings.sidecar_place import sidecar_of
from formats.recordings.trial_weights import EXAMPLE, TrialWeight, require_likely_columns
from formats.wire import TABLES, WIRE_SCHEMA, SampleBatch
from storage.clock import from_datetime
from storage.files.private_files import prepare

UNSTATED_START = datetime(2000, 1, 2, tzinfo=UTC)
"""Time of the first row of a recording that does not say it."""
LONGEST_S = 1e9
"""Longest recording: thirty years [s]."""
SPREADSHEETS = (".xlsx", ".xls", ".ods")
"""Ends of files that are no tables of numbers yet."""


class RecordedChannel(BaseModel):
    """The columns of one channel."""

    model_config = ConfigDict(extra="forbid", defer_build=True)

    channel: Identifier
    amplitude: str | None = None
    phase: str | None = None
    real: str | None = Field(default=None, description="with `imaginary` in place of amplitude and phase")
    imaginary: str | None = None
    scatter: str | None = Field(default=None, description="rms of the complex error, in the amplitude's unit and kind")
    gap: str | None = Field(
        default=None, description="mean gap, in `gap_unit`; the machine's document says which way it grows"
    )
    overall: str | None = Field(default=None, description="unfiltered vibration, in the amplitude's unit and kind")

    @model_validator(mode="after")
    def _one_pair(self) -> Self:
        polar, parts = (self.amplitude, self.phase), (self.real, self.imaginary)
        if None in polar + parts and (None not in polar or None not in parts) and (polar + parts).count(None) == 2:
            return self
        raise ValueError("give the columns of amplitude and phase, or of real and imaginary")


EXAMPLES = {
    "plant": "plant-1",
    "machine": "pump-7",
    "speed": "speed_rpm",
    "speed_unit": "rpm",
    "channels": "[{channel: B1X, amplitude: B1X_um_pp, phase: B1X_lag_deg}]",
    "amplitude_unit": "um",
    "amplitude_kind": "peak-to-peak",
    "phase_convention": "lag",
    "phase_unit": "deg",
}
"""Value of each field that a sidecar must have, as an example."""
UNITS: dict[str, tuple[str, ...]] = {
    "speed_unit": tuple(RAD_PER_S),
    "amplitude_unit": (*METRES, "V"),
    "amplitude_kind": tuple(PEAK),
    "phase_convention": tuple(LEAD),
    "phase_unit": tuple(RADIANS),
    "gap_unit": (*METRES, "V"),
}
"""Units that the fields of a sidecar may have."""


class Sidecar(BaseModel):
    """Description of a recording's columns; `FILE.yaml` beside `FILE.csv`."""

    model_config = ConfigDict(extra="forbid", defer_build=True)

    plant: Identifier
    machine: Identifier
    source: Identifier = "recording"
    direction: Literal["positive", "negative"] = "positive"
    kind: Literal["sweep", "dwells"] = Field(
        default="sweep", description="a run-up or run-down, or rows that each were taken at a constant speed"
    )
    start: datetime = Field(default=UNSTATED_START, description="time of the first row")
    time: str | None = Field(default=None, description="column with seconds since the start, or with dates and times")
    interval_s: Positive | None = Field(default=None, description="time between rows, where there is no such column")
    speed: str = Field(description="column")
    speed_unit: str
    channels: Annotated[list[RecordedChannel], Field(min_length=1)]
    amplitude_unit: str
    amplitude_kind: str
    phase_convention: str
    phase_unit: str
    gap_unit: Literal["um", "mil", "mm", "m", "V"] | None = Field(default=None, description="unit of the columns of gaps")
    conditions: dict[Identifier, str] = Field(default_factory=dict, description="column of each operating condition by name")
    added_unbalance: dict[Identifier, TrialWeight] | Literal["none"] | None = Field(
        default=None, description="trial weights that were on: disc, and what they add to its unbalance; `none` for none"
    )
    disc_scale: DiscScale = DiscScale.model_construct()
    mounting: str | None = Field(
        default=None,
        description="column that tells rows apart between which the machine was taken apart or stood; "
        "by default a recording is one mounting",
    )

    @field_validator(*UNITS, mode="before")
    @classmethod
    def _declared(cls, given: object, of: ValidationInfo) -> object:
        field = str(of.field_name)
        unit = declared_unit(field, given)
        if isinstance(given, str) and unit not in UNITS[field]:
            raise ValueError(unknown_unit(field, given, UNITS[field]))
        return unit

    @field_validator("added_unbalance", mode="before")
    @classmethod
    def _weights_listed(cls, given: object) -> object:
        if given is not None and given != "none" and not isinstance(given, dict):
            raise ValueError(f"trial weights are `none`, or listed by disc, as in {{D1: {EXAMPLE}}}")
        return given

    @model_validator(mode="after")
    def _mapped_once(self) -> Self:
        columns = [
            one
            for part in self.channels
            for one in (part.amplitude, part.phase, part.real, part.imaginary, part.scatter, part.gap, part.overall)
        ]
        ids = [part.channel for part in self.channels]
        again = sorted({one for one in ids if ids.count(one) > 1})
        if again:
            raise ValueError(f"channel {', '.join(again)} is listed twice: each probe of the document has one entry")
        mapped = [one for one in (self.speed, self.time, *columns) if one is not None]
        twice = sorted({one for one in mapped if mapped.count(one) > 1})
        if twice:
            raise ValueError(f"column {', '.join(twice)} is mapped twice: each amplitude, phase and speed has one of its own")
        if (self.gap_unit is None) != all(part.gap is None for part in self.channels):
            raise ValueError("gap_unit and the columns of gaps come together or not at all")
        return self

    @property
    def columns(self) -> set[str]:
        """Return the columns that it names."""
        own = (self.time, self.speed, self.mounting, *self.conditions.values())
        of_channels = (one for part in self.channels for one in part.model_dump(exclude={"channel"}).values())
        of_weights = (one for part in self.trial_weights.values() for one in (part.amount, part.angle_deg))
        return {one for one in (*own, *of_channels, *of_weights) if isinstance(one, str)}

    @property
    def trial_weights(self) -> dict[str, TrialWeight]:
        """Return the trial weights that were on by disc."""
        return {} if self.added_unbalance in (None, "none") else dict(self.added_unbalance)  # type: ignore[arg-type]


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


def _require_room(path: Path) -> None:
    """Raise UnreadableFile where a recording's sidecar would take the place of a file that is none."""
    beside = path.with_suffix(".yaml")
    if beside == path:
        raise UnreadableFile(f"{path}: a recording is a CSV file; its sidecar takes the name that ends in .yaml")
    if not beside.exists():
        return
    try:
        read_sidecar(beside)
    except UnreadableFile:
        raise UnreadableFile(
            f"{beside} is no sidecar of a recording, and that of {path.name} would take its place: give the CSV another name"
        ) from None


def write_recording(
    path: Path,
    machine: Machine,
    *,
    speed_rpm: Floats,
    phasor: Complexes,
    interval_s: float,
    gap_um: Floats | None = None,
    weights: Mapping[str, tuple[float, float]] | None = None,
    start: datetime | None = None,
) -> None:
    """Write a run as CSV with its sidecar, readable by their owner only, for `read_recording`.

    speed_rpm: (S,) [r/min]. phasor: (S, m) at the machine's probes, 0-to-peak [m]; written in µm peak-to-peak, phase lag.
    gap_um: (S, m) gaps as the probes' document says that they grow [µm]; NaN for probes without.
    weights: trial weights that were on, by disc: what each adds [g mm], and its angle from +x towards +y [°]; None where
    nobody says. start: time of the first row; None where nobody says.

    Raises UnreadableFile where another file, such as the machine's document, stands where the sidecar would.
    """
    _require_room(path)
    channels = machine.channels
    gap = np.full(phasor.shape, np.nan) if gap_um is None else gap_um
    told = np.flatnonzero(np.isfinite(gap).all(axis=0))
    gaps = {channels[place]: cell(f"{channels[place]}_gap_um") for place in told}
    prepare(path)
    prepare(path.with_suffix(".yaml"))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = CsvWriter(file)
        parts = (f"{channel}_{part}" for channel in channels for part in ("um_pp", "lag_deg"))
        writer.row(["speed_rpm", *parts, *gaps.values()])
        for speed, row, behind in zip(speed_rpm, phasor, gap[:, told], strict=True):
            values = [value for one in row for value in (2e6 * abs(one), -math.degrees(cmath.phase(one)))]
            writer.row([f"{speed:.4f}", *(f"{value:.6g}" for value in (*values, *behind))])
    sidecar = Sidecar(
        plant=machine.plant,
        machine=machine.id,
        direction=machine.rotation,
        interval_s=interval_s,
        speed="speed_rpm",
        speed_unit="rpm",
        channels=[
            RecordedChannel(channel=c, amplitude=cell(f"{c}_um_pp"), phase=cell(f"{c}_lag_deg"), gap=gaps.get(c))
            for c in channels
        ],
        amplitude_unit="um",
        amplitude_kind="peak-to-peak",
        phase_convention="lag",
        phase_unit="deg",
        gap_unit="um" if gaps else None,
        **({} if start is None else {"start": start}),
    )
    left_out = {"kind", "added_unbalance", "disc_scale", "conditions"} | ({"start"} if start is None else set())
    described = sidecar.model_dump(mode="json", exclude_none=True, exclude=left_out)
    if weights is not None:
        described["added_unbalance"] = {
            disc: {"amount": amount, "unit": "g mm", "angle_deg": angle} for disc, (amount, angle) in weights.items()
        } or "none"
    path.with_suffix(".yaml").write_text(yaml.safe_dump(described, sort_keys=False), encoding="utf-8")


def read_sidecar(path: Path) -> Sidecar:
    """Return a sidecar; raise UnreadableFile, naming every wrong field."""
    try:
        content = read_yaml(path)
        if not isinstance(content, dict):
            raise UnreadableFile(f"{path} is not a recording's sidecar: it should be fields by name, each with its value")
        return Sidecar.model_validate(content)
    except ValidationError as error:
        if {"shafts", "bearings"} <= content.keys():
            raise UnreadableFile(
                f"{path} is a machine document and not the recording's sidecar: give one of the two another name"
            ) from error
        problems = list(dict.fromkeys(_fault_text(item["loc"], item["msg"]) for item in _chosen(error)))
        listed = f" {problems[0]}" if len(problems) == 1 else "".join(f"\n  {one}" for one in problems)
        raise UnreadableFile(f"{path} is not a recording's sidecar:{listed}") from error


def _chosen(error: ValidationError) -> list[ErrorDetails]:
    """Return what is wrong, without the alternatives of a field that was meant otherwise.

    Such as `none`, where weights are listed, or the name of a column, where a number is given.
    """
    whole = error.errors()
    numbers = {item["loc"][:-1] for item in whole if item["loc"][-1:] != ("str",)}
    found = [item for item in whole if item["loc"][-1:] != ("str",) or item["loc"][:-1] not in numbers]
    listed = {item["loc"][0] for item in found if _is_alternative(item["loc"][1:2], "dict[") and len(item["loc"]) > 2}
    return [item for item in found if not (item["loc"][:1] and item["loc"][0] in listed and len(item["loc"]) == 2)]


def _is_alternative(names: tuple[int | str, ...], kind: str) -> bool:
    return bool(names) and str(names[0]).startswith(kind)


def _fault_text(location: tuple[int | str, ...], message: str) -> str:
    """Return one fault: the field, where it is one field's, and what would be right."""
    if message == "Field required" and location[0] in EXAMPLES and len(location) == 1:
        return f"{location[0]}: it is missing; one is `{location[0]}: {EXAMPLES[str(location[0])]}`"
    fields = tuple(one for one in location if not str(one).startswith(("dict[", "literal[", "constrained-", "function-")))
    message = own_words(message)
    return f"{field_path(fields)}: {message}" if fields else message


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
