"""The message that sources publish: its frame, its schema and its conversion to SI. Defined here, nowhere else.

A payload is one line of ASCII, `rundown/1 <length> <crc32>`, a newline, and the body: `length` bytes, whose CRC-32 the line
gives in hexadecimal. The body is a `SampleBatch` in MessagePack (zenoh encoding `application/msgpack`) or JSON
(`application/json`).
"""

import re
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypeVar

import msgspec
import numpy as np
from numpy.typing import NDArray

from estimator.channel_status import ChannelStatus
from estimator.machine import Machine
from estimator.units import LEAD, METRES, PEAK, RAD_PER_S, RADIANS, rpm_to_rad_per_s
from storage.blocks import Samples
from storage.samples import SourceKey

WIRE_SCHEMA = 1
MESSAGEPACK, JSON = "application/msgpack", "application/json"
LARGEST_MESSAGE = 1 << 20
LARGEST_BATCH = 5_000
LARGEST_CHANNEL_COUNT = 128
LARGEST_AMPLITUDE = 0.02
"""No shaft in a machine that still runs moves by more than this [m, 0-to-peak]."""
LARGEST_PHASE = 1e5
"""No source counts a phase to hundreds of turns [° or rad]."""
OVERSPEED = 1.3
"""A speed beyond this multiple of the machine's maximum is a wrong number, not a speed."""
EARLIEST_TIME = 946_684_800_000_000_000  # 2000-01-01, ns
FUTURE_TOLERANCE = 60_000_000_000
"""A sample may be ahead of this machine's clock by a minute [ns]; clocks that differ by more want mending."""

STATUSES = {status.label: status for status in ChannelStatus}
DIRECTIONS = {"positive": 1, "negative": -1}

_NO_PHASOR = complex(np.nan, np.nan)
_FRAME = re.compile(rb"rundown/1 (\d{1,10}) ([0-9a-f]{8})\n")
_IDENTIFIER = re.compile(r"[A-Za-z0-9_-]{1,64}\Z")

Reason = Literal[
    "too_large",
    "bad_frame",
    "undecodable",
    "future_schema",
    "key_mismatch",
    "unknown_machine",
    "unknown_channel",
    "wrong_unit",
    "wrong_shape",
    "not_finite",
    "speed_out_of_range",
    "speed_out_of_order",
    "amplitude_out_of_range",
    "sequence_out_of_range",
    "time_out_of_range",
    "time_out_of_order",
]
"""Why a message, a sample or a channel's value is rejected."""


class Rejected(ValueError):
    """A message or a sample cannot be taken."""

    def __init__(self, reason: Reason, detail: str) -> None:
        super().__init__(detail)
        self.reason = reason
        self.detail = detail


class SampleBatch(msgspec.Struct, kw_only=True, omit_defaults=True):
    """Consecutive samples of one machine from one source.

    epoch: any number that grows with each start of the source, such as its start time; sequence: number of the first
    sample in this epoch, counted from 0; the others follow without a hole. time_ns: per sample, UTC since 1970.
    amplitude, phase, status, scatter: per sample a list over the channels; null where there is no value. status: `good`,
    `not_available`, `bad` or `out_of_range`; without it all are good. scatter: rms of the complex error, in the amplitude's
    unit. amplitude_2x, phase_2x: of the 2×, in the same units and with phase counted in degrees of 2×. direction: `positive`
    turns +x towards +y.
    """

    schema: int
    plant: str
    machine: str
    source: str
    epoch: int
    sequence: int
    channels: list[str]
    speed_unit: str
    amplitude_unit: str
    amplitude_kind: str
    phase_convention: str
    phase_unit: str
    direction: str
    time_ns: list[int]
    speed: list[float]
    amplitude: list[list[float | None]]
    phase: list[list[float | None]]
    status: list[list[str]] | None = None
    scatter: list[list[float | None]] | None = None
    amplitude_2x: list[list[float | None]] | None = None
    phase_2x: list[list[float | None]] | None = None


class _Version(msgspec.Struct):
    schema: int


_T = TypeVar("_T")


def _decode(kind: type[_T], body: bytes, encoding: str) -> _T:
    if encoding.split(";")[0] == JSON:
        return msgspec.json.decode(body, type=kind)
    return msgspec.msgpack.decode(body, type=kind)


@dataclass(frozen=True)
class Key:
    """Where a machine's messages travel: `rundown/v1/<plant>/<machine>/…`."""

    plant: str
    machine: str

    @classmethod
    def parse(cls, key: str) -> "Key":
        """From a full key expression. Raises Rejected."""
        parts = key.split("/")
        if len(parts) != 5 or parts[:2] != ["rundown", "v1"] or not all(_IDENTIFIER.match(p) for p in parts[2:4]):
            raise Rejected("key_mismatch", f"'{key[:200]}' is not rundown/v1/<plant>/<machine>/samples")
        return cls(parts[2], parts[3])

    @property
    def samples(self) -> str:
        """Where batches are published."""
        return f"rundown/v1/{self.plant}/{self.machine}/samples"

    @property
    def log(self) -> str:
        """Where a source answers replay queries."""
        return f"rundown/v1/{self.plant}/{self.machine}/log"

    @property
    def live(self) -> str:
        """Liveliness token of the machine's source."""
        return f"rundown/v1/live/{self.plant}/{self.machine}"


ALL_SAMPLES = "rundown/v1/*/*/samples"
ALL_LIVE = "rundown/v1/live/*/*"


def frame(body: bytes) -> bytes:
    """Put length and checksum before a body."""
    return b"rundown/1 %d %08x\n" % (len(body), zlib.crc32(body)) + body


def encode_batch(batch: SampleBatch, encoding: str = MESSAGEPACK) -> bytes:
    """The payload that carries a batch."""
    return frame(msgspec.msgpack.encode(batch) if encoding == MESSAGEPACK else msgspec.json.encode(batch))


def decode_batch(key: Key, payload: bytes, encoding: str) -> SampleBatch:
    """Take a payload apart and check everything that does not need the machine's document. Raises Rejected."""
    body = _unframed(payload)
    try:
        version = _decode(_Version, body, encoding).schema
        if version < 1:
            raise Rejected("undecodable", f"there is no schema {version}; this service knows 1 to {WIRE_SCHEMA}")
        if version > WIRE_SCHEMA:
            raise Rejected("future_schema", f"schema {version} is newer than this service's {WIRE_SCHEMA}: upgrade it first")
        batch = _decode(SampleBatch, body, encoding)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise Rejected("undecodable", f"body is not a sample batch in {encoding or 'MessagePack'}: {error}") from None
    if (batch.plant, batch.machine) != (key.plant, key.machine):
        raise Rejected("key_mismatch", f"body says {batch.plant}/{batch.machine}, key says {key.plant}/{key.machine}")
    _check_shape(batch)
    return batch


def source_key(batch: SampleBatch) -> SourceKey:
    """Whose samples these are."""
    return SourceKey(batch.machine, batch.source, batch.epoch)


def require_size(size: int) -> None:
    """Raises Rejected for a payload of more bytes than are taken."""
    if size > LARGEST_MESSAGE:
        raise Rejected("too_large", f"{size} bytes; at most {LARGEST_MESSAGE} are taken")


def _unframed(payload: bytes) -> bytes:
    require_size(len(payload))
    match = _FRAME.match(payload)
    if match is None:
        raise Rejected("bad_frame", "the payload does not begin with 'rundown/1 <length> <crc32>' and a newline")
    body = payload[match.end() :]
    length, checksum = int(match[1]), int(match[2], 16)
    if len(body) != length:
        raise Rejected("bad_frame", f"the frame promises {length} bytes, {len(body)} came")
    if zlib.crc32(body) != checksum:
        raise Rejected("bad_frame", "the checksum does not fit the body")
    return body


def _check_shape(batch: SampleBatch) -> None:
    count, channels = len(batch.time_ns), len(batch.channels)
    if not 1 <= count <= LARGEST_BATCH:
        raise Rejected("wrong_shape", f"{count} samples; a batch has 1 to {LARGEST_BATCH}")
    if not 1 <= channels <= LARGEST_CHANNEL_COUNT or len(set(batch.channels)) != channels:
        raise Rejected("wrong_shape", f"{channels} channels; a batch has 1 to {LARGEST_CHANNEL_COUNT}, each once")
    if not _IDENTIFIER.match(batch.source):
        raise Rejected("wrong_shape", "source must be letters, digits, '_' and '-', up to 64")
    if not (0 <= batch.epoch < 2**63 and 0 <= batch.sequence < 2**62):
        raise Rejected("wrong_shape", "epoch and sequence must not be negative and must fit 63 bits")
    if len(batch.speed) != count:
        raise Rejected("wrong_shape", f"speed has {len(batch.speed)} values for {count} samples")
    if (batch.amplitude_2x is None) != (batch.phase_2x is None):
        raise Rejected("wrong_shape", "amplitude_2x and phase_2x come together or not at all")
    for name in ("amplitude", "phase", "status", "scatter", "amplitude_2x", "phase_2x"):
        rows = getattr(batch, name)
        if rows is not None and (len(rows) != count or any(len(row) != channels for row in rows)):
            raise Rejected("wrong_shape", f"{name} must have {count} rows of {channels} values")


@dataclass(frozen=True)
class Fault:
    """A sample, or one channel of it, that is not taken: its place in the batch and the reason."""

    index: int
    reason: Reason
    detail: str


def to_samples(batch: SampleBatch, machine: Machine, *, received_at: int) -> tuple[Samples, NDArray[np.bool_], list[Fault]]:
    """Convert a batch to SI in the document's channel order.

    Returns all samples, which of them can be taken at all (S,), and every fault. A channel's bad value makes that channel
    unusable in that sample; a bad time or speed the whole sample. Raises Rejected for what is wrong with all of it.
    """
    _check_channels(batch, machine)
    factors = _metres(batch, machine) * _factor(batch, "amplitude_kind", PEAK)
    turn = _factor(batch, "phase_convention", LEAD) * _factor(batch, "phase_unit", RADIANS)
    count = len(batch.time_ns)
    shape = (count, len(machine.probes))
    phasor = np.full(shape, _NO_PHASOR)
    second = np.full(shape, _NO_PHASOR)
    scatter = np.full(shape, np.nan)
    status = np.full(shape, ChannelStatus.NOT_AVAILABLE, dtype=np.uint8)
    columns = [machine.channels.index(channel) for channel in batch.channels]
    with np.errstate(invalid="ignore", over="ignore"):
        speed = np.array(batch.speed, dtype=float) * _factor(batch, "speed_unit", RAD_PER_S)
        size, phase = _table(batch.amplitude) * factors, _table(batch.phase)
        number = _is_amplitude(size) & (np.abs(phase) <= LARGEST_PHASE)
        told = np.full(size.shape, np.nan) if batch.scatter is None else _table(batch.scatter) * factors
        sensible = number & (~np.isfinite(told) | _is_amplitude(told))
        phasor[:, columns] = np.where(number, size * np.exp(1j * turn * phase), _NO_PHASOR)
        if batch.amplitude_2x is not None and batch.phase_2x is not None:
            twice, phase_2x = _table(batch.amplitude_2x) * factors, _table(batch.phase_2x)
            number_2x = _is_amplitude(twice) & (np.abs(phase_2x) <= LARGEST_PHASE)
            second[:, columns] = np.where(number_2x, twice * np.exp(1j * turn * phase_2x), _NO_PHASOR)
    called = _called(batch)
    wrong = (called == ChannelStatus.GOOD) & ~sensible
    faults = _channel_faults(batch, size, wrong)
    status[:, columns] = np.where(wrong, np.where(_is_too_large(size), ChannelStatus.OUT_OF_RANGE, ChannelStatus.BAD), called)
    scatter[:, columns] = np.where(sensible & np.isfinite(told), told, np.nan)
    time = np.array([min(max(t, -(2**62)), 2**62) for t in batch.time_ns], dtype=np.int64)
    taken = np.ones(count, dtype=bool)
    for fault in _sample_faults(machine, time, speed, received_at):
        faults.append(fault)
        taken[fault.index] = False
    direction = np.full(count, _factor(batch, "direction", DIRECTIONS), dtype=np.int8)
    return Samples(time, speed, direction, phasor, status, scatter, second), taken, faults


def _is_amplitude(size: NDArray[np.float64]) -> NDArray[np.bool_]:
    return np.asarray((size >= 0.0) & (size <= LARGEST_AMPLITUDE))


def _is_too_large(size: NDArray[np.float64]) -> NDArray[np.bool_]:
    return np.asarray(np.isfinite(size) & ~_is_amplitude(size))


def _factor(batch: SampleBatch, name: str, table: Mapping[Any, float]) -> float:
    value = getattr(batch, name)
    if value not in table:
        raise Rejected("wrong_unit", f"{name} '{value[:40]}' is not one of {', '.join(table)}")
    return table[value]


def _check_channels(batch: SampleBatch, machine: Machine) -> None:
    unknown = [channel[:64] for channel in batch.channels if channel not in machine.channels]
    if unknown:
        known = ", ".join(machine.channels)
        raise Rejected("unknown_channel", f"machine '{machine.id}' has no channel {', '.join(unknown)}; it has {known}")


def _metres(batch: SampleBatch, machine: Machine) -> NDArray[np.float64]:
    """Factor to metres per channel of the batch."""
    if batch.amplitude_unit != "V":
        return np.full(len(batch.channels), _factor(batch, "amplitude_unit", METRES))
    sensitivity = {probe.id: probe.sensitivity for probe in machine.probes}
    missing = [channel for channel in batch.channels if sensitivity[channel] is None]
    if missing:
        raise Rejected("wrong_unit", f"amplitudes in V need a sensitivity [V/m] in the document for {', '.join(missing)}")
    return np.array([1.0 / (sensitivity[channel] or np.nan) for channel in batch.channels])


def _table(rows: list[list[float | None]]) -> NDArray[np.float64]:
    return np.array([[np.nan if value is None else value for value in row] for row in rows], dtype=float)


def _called(batch: SampleBatch) -> NDArray[np.uint8]:
    """What the source itself says of each value: a null is as good as `not_available`."""
    there = np.array(
        [
            [a is not None and p is not None for a, p in zip(amplitudes, phases, strict=True)]
            for amplitudes, phases in zip(batch.amplitude, batch.phase, strict=True)
        ]
    )
    if batch.status is None:
        said = np.full(there.shape, ChannelStatus.GOOD)
    else:
        unknown = {status for row in batch.status for status in row} - set(STATUSES)
        if unknown:
            raise Rejected("wrong_unit", f"status '{min(unknown)[:40]}' is not one of {', '.join(STATUSES)}")
        said = np.array([[STATUSES[status] for status in row] for row in batch.status])
    missing = ~there & (said == ChannelStatus.GOOD)
    return np.where(missing, ChannelStatus.NOT_AVAILABLE, said).astype(np.uint8)


def _channel_faults(batch: SampleBatch, size: NDArray[np.float64], wrong: NDArray[np.bool_]) -> list[Fault]:
    """Why values that the source calls good are not taken; size: amplitudes 0-to-peak [m]."""
    faults = []
    for index, column in np.argwhere(wrong):
        channel, amplitude = batch.channels[column], size[index, column]
        if _is_too_large(amplitude):
            detail = f"channel {channel}: {amplitude:.4g} m is not between 0 and {LARGEST_AMPLITUDE} m"
            faults.append(Fault(int(index), "amplitude_out_of_range", detail))
        else:
            detail = f"channel {channel}: amplitude, phase and scatter must be sensible finite numbers"
            faults.append(Fault(int(index), "not_finite", detail))
    return faults


def _sample_faults(machine: Machine, time: NDArray[np.int64], speed: NDArray[np.float64], received_at: int) -> Iterator[Fault]:
    fastest = OVERSPEED * rpm_to_rad_per_s(machine.speed_range.maximum_rpm)
    for index, (moment, value) in enumerate(zip(time, speed, strict=True)):
        if not np.isfinite(value):
            yield Fault(index, "not_finite", "speed is not a finite number")
        elif not 0.0 <= value <= fastest:
            yield Fault(index, "speed_out_of_range", f"speed {value:.6g} rad/s is not between 0 and {fastest:.6g} rad/s")
        elif not EARLIEST_TIME <= moment <= received_at + FUTURE_TOLERANCE:
            yield Fault(index, "time_out_of_range", f"time {moment} ns is before 2000 or more than a minute ahead")
