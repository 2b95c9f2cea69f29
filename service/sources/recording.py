"""Recorded runs: a CSV file with a header line, and beside it a sidecar YAML that describes its columns."""

import cmath
import csv
import math
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Literal

import msgspec
import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from estimator.arrays import Complexes, Floats
from estimator.field_types import Identifier, Positive
from estimator.machine.document import Machine, field_path
from estimator.machine.parts import Unbalance
from service.configuration.document_files import UnreadableFile, read_yaml
from service.export.csv_cells import CsvWriter, cell
from service.wire import TABLES, WIRE_SCHEMA, SampleBatch
from storage.clock import from_datetime
from storage.database.private_files import prepare

LONGEST_S = 1e9
"""Longest recording: thirty years [s]."""


class RecordedChannel(BaseModel):
    """The columns of one channel."""

    model_config = ConfigDict(extra="forbid")

    channel: Identifier
    amplitude: str
    phase: str


class Sidecar(BaseModel):
    """Description of a recording's columns; `FILE.yaml` beside `FILE.csv`."""

    model_config = ConfigDict(extra="forbid")

    plant: Identifier
    machine: Identifier
    source: Identifier = "recording"
    direction: Literal["positive", "negative"] = "positive"
    start: datetime = Field(default=datetime(2000, 1, 2, tzinfo=UTC), description="time of the first row")
    time: str | None = Field(default=None, description="column with seconds since the start")
    interval_s: Positive | None = Field(default=None, description="time between rows, where there is no such column")
    speed: str = Field(description="column")
    speed_unit: str
    channels: Annotated[list[RecordedChannel], Field(min_length=1)]
    amplitude_unit: str
    amplitude_kind: str
    phase_convention: str
    phase_unit: str
    conditions: dict[Identifier, str] = Field(default_factory=dict, description="column of each operating condition by name")
    added_unbalance: dict[Identifier, Unbalance] = Field(
        default_factory=dict, description="trial weights that were on: disc, and what they add to its unbalance"
    )


def read_recording(path: Path, sidecar_path: Path | None = None) -> SampleBatch:
    """Return all rows of a recording as one batch, numbered from 0. Raises UnreadableFile."""
    if path.is_dir():
        raise UnreadableFile(f"{path} is a folder, not a recording")
    beside = sidecar_path or path.with_suffix(".yaml")
    if not path.exists():
        raise UnreadableFile(f"{path}: no such file")
    if not beside.exists():
        raise UnreadableFile(f"{path} needs a sidecar {beside} that says what its columns mean; see docs/integrators.md")
    sidecar = read_sidecar(beside)
    if (sidecar.time is None) == (sidecar.interval_s is None):
        raise UnreadableFile(f"{path}: its sidecar must give either the column `time` or `interval_s`")
    rows = _rows(path)

    def gappy(name: str) -> list[float | None]:
        if name not in rows[0]:
            raise UnreadableFile(f"{path} has no column '{name}'; it has {', '.join(rows[0])}")
        return [_number(path, line, name, row[name]) for line, row in enumerate(rows, start=2)]

    def column(name: str) -> list[float]:
        values = gappy(name)
        if None in values:
            raise UnreadableFile(f"{path}, line {values.index(None) + 2}: column '{name}' has no value")
        return [value for value in values if value is not None]

    speed = column(sidecar.speed)
    seconds = column(sidecar.time) if sidecar.time is not None else [i * (sidecar.interval_s or 0) for i in range(len(speed))]
    start = from_datetime(sidecar.start)
    if not all(abs(s) < LONGEST_S for s in seconds):
        raise UnreadableFile(f"{path}: column '{sidecar.time}' must hold seconds since the start, below {LONGEST_S:.0e}")
    amplitude = [gappy(channel.amplitude) for channel in sidecar.channels]
    phase = [gappy(channel.phase) for channel in sidecar.channels]
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
        time_ns=[start + round(s * 1e9) for s in seconds],
        speed=speed,
        amplitude=[list(row) for row in zip(*amplitude, strict=True)],
        phase=[list(row) for row in zip(*phase, strict=True)],
        conditions={name: gappy(column) for name, column in sidecar.conditions.items()} or None,
    )


def write_recording(path: Path, machine: Machine, *, speed_rpm: Floats, phasor: Complexes, interval_s: float) -> None:
    """Write a run as CSV with its sidecar, readable by their owner only, for `read_recording`.

    speed_rpm: (S,) [r/min]. phasor: (S, m) at the machine's probes, 0-to-peak [m]; written in µm peak-to-peak, phase lag.
    """
    channels = machine.channels
    prepare(path)
    prepare(path.with_suffix(".yaml"))
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = CsvWriter(file)
        writer.row(["speed_rpm", *(f"{channel}_{part}" for channel in channels for part in ("um_pp", "lag_deg"))])
        for speed, row in zip(speed_rpm, phasor, strict=True):
            parts = (value for one in row for value in (2e6 * abs(one), -math.degrees(cmath.phase(one))))
            writer.row([f"{speed:.4f}", *(f"{value:.6g}" for value in parts)])
    sidecar = Sidecar(
        plant=machine.plant,
        machine=machine.id,
        direction=machine.rotation,
        interval_s=interval_s,
        speed="speed_rpm",
        speed_unit="rpm",
        channels=[RecordedChannel(channel=c, amplitude=cell(f"{c}_um_pp"), phase=cell(f"{c}_lag_deg")) for c in channels],
        amplitude_unit="um",
        amplitude_kind="peak-to-peak",
        phase_convention="lag",
        phase_unit="deg",
    )
    described = sidecar.model_dump(mode="json", exclude_none=True, exclude={"start", "added_unbalance", "conditions"})
    path.with_suffix(".yaml").write_text(yaml.safe_dump(described, sort_keys=False), encoding="utf-8")


def read_sidecar(path: Path) -> Sidecar:
    """Return a sidecar; raise UnreadableFile, naming every wrong field."""
    try:
        return Sidecar.model_validate(read_yaml(path))
    except ValidationError as error:
        problems = "\n".join(f"  {field_path(item['loc'])}: {item['msg']}" for item in error.errors())
        raise UnreadableFile(f"{path} is not a recording's sidecar:\n{problems}") from error


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


def _rows(path: Path) -> list[dict[str, str | None]]:
    try:
        # Spreadsheets put a byte order mark in front.
        with path.open(encoding="utf-8-sig", newline="") as file:
            rows = list(csv.DictReader(file, strict=True))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise UnreadableFile(f"{path}: {error}") from error
    if not rows:
        raise UnreadableFile(f"{path} has no rows below its header")
    return rows


def _number(path: Path, line: int, name: str, text: str | None) -> float | None:
    """Return the number in a cell, None where it is blank."""
    if text is None:
        raise UnreadableFile(f"{path}, line {line} is too short: it has no column '{name}'")
    if not text.strip():
        return None
    try:
        return float(text)
    except ValueError:
        raise UnreadableFile(f"{path}, line {line}: '{text}' in column '{name}' is not a number") from None
