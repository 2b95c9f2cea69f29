"""The compact encoding `application/x-rundown-batch`: a fixed header, the names, and arrays. Little-endian throughout.

| offset | bytes | what |
|---|---|---|
| 0 | 4 | `RDSW` |
| 4 | 2 | schema |
| 6 | 2 | size of this header, 72; a reader skips what it does not know behind it |
| 8 | 8 | epoch |
| 16 | 8 | sequence |
| 24 | 4 | samples S |
| 28 | 2 | channels m |
| 30 | 2 | size of the names |
| 32 | 1 each | speed_unit, amplitude_unit, amplitude_kind, phase_convention, phase_unit, direction: places in lists below |
| 38 | 1 | tables that are there beside amplitude and phase: 1 scatter, 2 the 2×, 4 status, 8 gap, 16 overall |
| 39 | 1 each | number format of amplitudes, of phases, of scatter: 0 float64, 1 int32, 2 int16 |
| 42 | 1 | operating conditions k |
| 43 | 1 | gap_unit: place in the list of amplitude_unit; 0 without a gap |
| 44 | 4 | zero |
| 48 | 8 each | quantum of amplitudes, of phases, of scatter: what an integer is multiplied with; 1 for float64 |
| 72 | | names in UTF-8, a newline between them: plant, machine, source, channels, conditions; zeros up to a multiple of 8 |
| | 8 S | time_ns, int64 |
| | 8 S | speed, float64 |
| | S m | amplitude, then phase, then scatter, amplitude_2x, phase_2x, status (one byte each), sample by sample |
| | 8 S m | gap, float64, sample by sample |
| | 8 S m | overall, float64, sample by sample |
| | 8 k S | conditions, float64, one after the other |

Tables follow each other without padding. NaN, or the most negative integer, stands for null. status is 0 `good`,
1 `not_available`, 2 `bad`, 3 `out_of_range`.
"""

import math
import struct
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from formats.wire.rejection import Rejected
from formats.wire.schema import STATUSES, ChannelTable, SampleBatch, require_schema

SPEED_UNITS = ("rpm", "rad/s", "Hz")
AMPLITUDE_UNITS = ("um", "mil", "mm", "m", "V")
AMPLITUDE_KINDS = ("peak", "peak-to-peak")
PHASE_CONVENTIONS = ("lag", "lead")
PHASE_UNITS = ("deg", "rad")
SENSES = ("positive", "negative")
"""Senses of rotation. Positions in these lists are on the wire: the lists may only grow at their ends."""

_UNITS = {
    "speed_unit": SPEED_UNITS,
    "amplitude_unit": AMPLITUDE_UNITS,
    "amplitude_kind": AMPLITUDE_KINDS,
    "phase_convention": PHASE_CONVENTIONS,
    "phase_unit": PHASE_UNITS,
    "direction": SENSES,
}
_LABELS = np.array(list(STATUSES), dtype=object)
_SCATTER, _SECOND, _STATUS, _GAP, _OVERALL = 1, 2, 4, 8, 16
_MAGIC = b"RDSW"
_VERSION = struct.Struct("<4sHH")
_HEADER = struct.Struct("<4sHHQQIHH6BB3BBB4xddd")


class NumberFormat(NamedTuple):
    """Number format of a table: stored as `kind`, to be multiplied by `quantum`."""

    code: int
    kind: str
    quantum: float = 1.0

    def require_quantum(self) -> None:
        """Raise Rejected unless the quantum is finite and positive."""
        if not (math.isfinite(self.quantum) and self.quantum > 0.0):
            raise Rejected("undecodable", f"a quantum of {self.quantum} is no quantum")

    def write(self, rows: ChannelTable) -> bytes:
        """Return a table's bytes. Raises ValueError for numbers that do not fit."""
        values = np.array(rows, dtype=float)
        if self.kind == FLOAT64.kind:
            return values.astype(self.kind).tobytes()
        nothing = np.iinfo(self.kind).min
        steps = np.rint(values / self.quantum)
        if np.any(np.abs(steps) > np.iinfo(self.kind).max):
            raise ValueError(f"{np.nanmax(np.abs(values)):.6g} is beyond {self.kind} in steps of {self.quantum:.6g}")
        return np.where(np.isnan(steps), nothing, steps).astype(self.kind).tobytes()

    def read(self, body: bytes, at: int, shape: tuple[int, int]) -> ChannelTable:
        """Return a table from its bytes, which begin at `at`."""
        stored = np.frombuffer(body, self.kind, shape[0] * shape[1], at).reshape(shape)
        if self.kind == FLOAT64.kind:
            values, nothing = stored.astype(float), np.isnan(stored)
        else:
            values, nothing = stored * self.quantum, stored == np.iinfo(self.kind).min
        rows: ChannelTable = values.tolist()
        for row, column in np.argwhere(nothing).tolist():
            rows[row][column] = None
        return rows


FLOAT64 = NumberFormat(0, "<f8")
_KINDS = {0: "<f8", 1: "<i4", 2: "<i2"}


def int32(quantum: float) -> NumberFormat:
    """Return the format of multiples of a quantum, four bytes each."""
    return NumberFormat(1, _KINDS[1], quantum)


def int16(quantum: float) -> NumberFormat:
    """Return the format of multiples of a quantum, two bytes each."""
    return NumberFormat(2, _KINDS[2], quantum)


def encode_binary(
    batch: SampleBatch,
    *,
    amplitude: NumberFormat = FLOAT64,
    phase: NumberFormat = FLOAT64,
    scatter: NumberFormat = FLOAT64,
) -> bytes:
    """Return the body of a batch. Raises ValueError for values that this encoding cannot hold."""
    conditions = batch.conditions or {}
    names = "\n".join([batch.plant, batch.machine, batch.source, *batch.channels, *conditions]).encode()
    second = batch.amplitude_2x is not None and batch.phase_2x is not None
    with_gap = batch.gap is not None and batch.gap_unit is not None
    tables = _SCATTER * (batch.scatter is not None) | _SECOND * second | _STATUS * (batch.status is not None) | _GAP * with_gap
    tables |= _OVERALL * (batch.overall is not None)
    codes = [places.index(getattr(batch, name)) for name, places in _UNITS.items()]
    formats = amplitude, phase, scatter
    header = _HEADER.pack(
        _MAGIC,
        batch.schema,
        _HEADER.size,
        batch.epoch,
        batch.sequence,
        len(batch.time_ns),
        len(batch.channels),
        len(names),
        *codes,
        tables,
        *(one.code for one in formats),
        len(conditions),
        AMPLITUDE_UNITS.index(batch.gap_unit) if with_gap and batch.gap_unit is not None else 0,
        *(one.quantum for one in formats),
    )
    parts = [header, names, bytes(-(_HEADER.size + len(names)) % 8)]
    parts += [np.array(batch.time_ns, "<i8").tobytes(), np.array(batch.speed, "<f8").tobytes()]
    parts += [amplitude.write(batch.amplitude), phase.write(batch.phase)]
    if batch.scatter is not None:
        parts.append(scatter.write(batch.scatter))
    if batch.amplitude_2x is not None and batch.phase_2x is not None:
        parts += [amplitude.write(batch.amplitude_2x), phase.write(batch.phase_2x)]
    if batch.status is not None:
        parts.append(bytes(STATUSES[label] for row in batch.status for label in row))
    if batch.gap is not None and with_gap:
        parts.append(FLOAT64.write(batch.gap))
    if batch.overall is not None:
        parts.append(FLOAT64.write(batch.overall))
    parts += [np.array(values, "<f8").tobytes() for values in conditions.values()]
    return b"".join(parts)


def decode_binary(body: bytes) -> SampleBatch:
    """Return the batch in a body, before its shape is checked. Raises Rejected."""
    if len(body) < _VERSION.size or not body.startswith(_MAGIC):
        raise Rejected("undecodable", f"body does not begin with {_MAGIC.decode()} and the header of a binary batch")
    _, schema, header_size = _VERSION.unpack_from(body)
    require_schema(schema)
    if not _HEADER.size <= header_size <= len(body):
        raise Rejected("undecodable", f"a header of {header_size} bytes; {_HEADER.size} or more must be there")
    _, _, _, epoch, sequence, count, channels, size, *rest = _HEADER.unpack_from(body)
    codes, (tables, *kinds), conditions, gap_unit, quanta = rest[:6], rest[6:10], rest[10], rest[11], rest[12:]
    formats = [_format(code, quantum) for code, quantum in zip(kinds, quanta, strict=True)]
    names = _names(body[header_size : header_size + size], channels, conditions)
    at = header_size + size
    at += -at % 8
    widths = [np.dtype(one.kind).itemsize for one in formats]
    second = bool(tables & _SECOND)
    width = (widths[0] + widths[1]) * (1 + second) + widths[2] * bool(tables & _SCATTER) + bool(tables & _STATUS)
    width += 8 * bool(tables & _GAP) + 8 * bool(tables & _OVERALL)
    expected = at + 16 * count + width * count * channels + 8 * count * conditions
    if len(body) != expected or tables >= 32:
        what = f"{count} samples of {channels} channels" + (f" and {conditions} conditions" if conditions else "")
        raise Rejected("undecodable", f"{len(body)} bytes; {what} make {expected}")
    shape = count, channels

    def table(which: int) -> ChannelTable:
        nonlocal at
        at, start = at + widths[which] * count * channels, at
        return formats[which].read(body, start, shape)

    end = expected - 8 * count * conditions
    overall_at = end - 8 * count * channels * bool(tables & _OVERALL)
    time = np.frombuffer(body, "<i8", count, at)
    speed = np.frombuffer(body, "<f8", count, at + 8 * count)
    at += 16 * count
    return SampleBatch(
        schema=schema,
        plant=names[0],
        machine=names[1],
        source=names[2],
        epoch=epoch,
        sequence=sequence,
        channels=names[3 : 3 + channels],
        time_ns=time.tolist(),
        speed=speed.tolist(),
        amplitude=table(0),
        phase=table(1),
        scatter=table(2) if tables & _SCATTER else None,
        amplitude_2x=table(0) if second else None,
        phase_2x=table(1) if second else None,
        status=_statuses(np.frombuffer(body, "u1", count * channels, at).reshape(shape)) if tables & _STATUS else None,
        gap=FLOAT64.read(body, overall_at - 8 * count * channels, shape) if tables & _GAP else None,
        gap_unit=_place(AMPLITUDE_UNITS, "gap_unit", gap_unit) if tables & _GAP else None,
        overall=FLOAT64.read(body, overall_at, shape) if tables & _OVERALL else None,
        conditions=_conditions(names[3 + channels :], body, end, count) if conditions else None,
        **_units(codes),
    )


def _conditions(names: Sequence[str], body: bytes, at: int, count: int) -> dict[str, list[float | None]]:
    """Return the values of each condition by name, null for NaN; they end the body. Raises Rejected for a repeated name."""
    if len(set(names)) != len(names):
        raise Rejected("undecodable", "a condition stands more than once among the names")
    columns = np.frombuffer(body, "<f8", len(names) * count, at).reshape(len(names), count)
    found: dict[str, list[float | None]] = dict(zip(names, columns.tolist(), strict=True))
    for row, column in np.argwhere(np.isnan(columns)).tolist():
        found[names[row]][column] = None
    return found


def _format(code: int, quantum: float) -> NumberFormat:
    if code not in _KINDS:
        raise Rejected("undecodable", f"there is no number format {code}; there are {', '.join(map(str, _KINDS))}")
    one = NumberFormat(code, _KINDS[code], quantum)
    one.require_quantum()
    return one


def _names(text: bytes, channels: int, conditions: int) -> list[str]:
    try:
        names = text.decode().split("\n")
    except UnicodeDecodeError as error:
        raise Rejected("undecodable", f"the names are not UTF-8: {error}") from None
    if len(names) != 3 + channels + conditions:
        what = f"{channels} channels" + (f", {conditions} conditions" if conditions else "")
        raise Rejected("undecodable", f"{len(names)} names; plant, machine, source and {what} must be there")
    return names


def _units(codes: Sequence[int]) -> Mapping[str, str]:
    return {name: _place(places, name, code) for code, (name, places) in zip(codes, _UNITS.items(), strict=True)}


def _place(places: Sequence[str], name: str, code: int) -> str:
    if code >= len(places):
        raise Rejected("wrong_unit", f"{name} {code} is not one of {', '.join(f'{i} {p}' for i, p in enumerate(places))}")
    return places[code]


def _statuses(codes: NDArray[np.uint8]) -> list[list[str]]:
    if codes.size and codes.max() >= len(_LABELS):
        raise Rejected("wrong_unit", f"status {codes.max()} is not one of {', '.join(STATUSES)}")
    rows: list[list[str]] = _LABELS[codes].tolist()
    return rows
