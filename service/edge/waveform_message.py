"""The message that carries raw waveforms on a zenoh topic, for data acquisition that has no file.

All numbers are little-endian:

| bytes | type | meaning |
|---|---|---|
| 0 | 4 bytes | `RDWF` |
| 4 | u16 | version, 1 |
| 6 | u16 | type of a value: 0 float64, 1 float32, 2 int16 |
| 8 | u32 | length of the whole message in bytes |
| 12 | u32 | CRC-32 of all bytes from 16 on |
| 16 | u64 | number of the first sample since the acquisition began: it tells what is missing |
| 24 | i64 | time of that sample, UTC, ns since 1970 |
| 32 | f64 | sampling rate [Hz] |
| 40 | f64 | what one unit of a value stands for, in the configured unit; 1 unless the values are int16 |
| 48 | u32 | samples N |
| 52 | u16 | channels C |
| 54 | u16 | length of the names in bytes |
| 56 | UTF-8 | names of the channels, a newline between two |
| then | | C × N values, channel by channel |
"""

import math
import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from estimator.arrays import Floats

MAGIC = b"RDWF"
VERSION = 1
LARGEST_WAVEFORM_MESSAGE = 8 << 20
"""Largest size of one message [bytes]."""
TYPES = ("<f8", "<f4", "<i2")
ValueType = Literal["<f8", "<f4", "<i2"]

_HEADER = struct.Struct("<4sHHIIQqddIHH")
_FROM_CHECKSUM_ON = 16


class BadMessage(ValueError):
    """The bytes are not a message of waveforms; the message states the reason."""


@dataclass(frozen=True)
class WaveformMessage:
    """A message of waveforms. first: number of the first sample; time_ns: its time; sampling_rate: [Hz]; values: (C, N)."""

    first: int
    time_ns: int
    sampling_rate: float
    channels: tuple[str, ...]
    values: Floats


def encode_waveforms(
    values: Floats,
    *,
    channels: Sequence[str],
    first: int,
    time_ns: int,
    sampling_rate: float,
    kind: ValueType = "<f4",
    unit: float = 1.0,
) -> bytes:
    """Return the message of waveforms (C, N). unit: value of 1 in the message; for int16 the step of the converter."""
    names = "\n".join(channels).encode()
    numbers = values / unit if kind != "<i2" else np.clip(np.rint(values / unit), -32768, 32767)
    body = names + np.ascontiguousarray(numbers, dtype=kind).tobytes()
    parts = (first, time_ns, sampling_rate, unit, values.shape[1], len(channels), len(names))
    without = _HEADER.pack(MAGIC, VERSION, TYPES.index(kind), _HEADER.size + len(body), 0, *parts)
    checksum = zlib.crc32(without[_FROM_CHECKSUM_ON:] + body)
    return _HEADER.pack(MAGIC, VERSION, TYPES.index(kind), _HEADER.size + len(body), checksum, *parts) + body


def decode_waveforms(payload: bytes) -> WaveformMessage:
    """Return the waveforms in a message. Raises BadMessage."""
    if len(payload) > LARGEST_WAVEFORM_MESSAGE:
        raise BadMessage(f"{len(payload)} bytes; at most {LARGEST_WAVEFORM_MESSAGE} are taken")
    if len(payload) < _HEADER.size or payload[:4] != MAGIC:
        raise BadMessage("does not begin with RDWF and a header of 56 bytes")
    _, version, kind, length, checksum, first, time_ns, rate, unit, samples, channels, named = _HEADER.unpack_from(payload)
    _require_whole(payload, version, length, checksum)
    if kind >= len(TYPES):
        raise BadMessage(f"values of type {kind}; there are 0 to {len(TYPES) - 1}")
    if not all(math.isfinite(one) and one > 0.0 for one in (rate, unit)):
        raise BadMessage(f"sampling rate {rate:g} Hz and unit {unit:g} must be positive")
    if _HEADER.size + named + channels * samples * np.dtype(TYPES[kind]).itemsize != length or not samples:
        raise BadMessage(f"{channels} channels of {samples} samples are not what {length} bytes hold")
    names = _names(payload[_HEADER.size : _HEADER.size + named], channels)
    values = np.frombuffer(payload, TYPES[kind], channels * samples, _HEADER.size + named)
    return WaveformMessage(first, time_ns, rate, names, values.reshape(channels, samples) * unit)


def _require_whole(payload: bytes, version: int, length: int, checksum: int) -> None:
    """Raise BadMessage for a message of another version, or one that was changed on its way."""
    if version != VERSION:
        raise BadMessage(f"version {version}; this agent knows {VERSION}")
    if length != len(payload):
        raise BadMessage(f"says {length} bytes, {len(payload)} came")
    if zlib.crc32(payload[_FROM_CHECKSUM_ON:]) != checksum:
        raise BadMessage("the checksum does not fit")


def _names(text: bytes, count: int) -> tuple[str, ...]:
    """Return the names of the channels. Raises BadMessage."""
    try:
        names = tuple(text.decode().split("\n"))
    except UnicodeDecodeError:
        raise BadMessage("the names of the channels are not UTF-8") from None
    if len(names) != count or len(set(names)) != count:
        raise BadMessage(f"{len(set(names))} different names for {count} channels")
    return names
