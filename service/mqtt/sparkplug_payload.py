"""Payloads of Sparkplug B: what of them is needed, read from the protocol buffers' wire format.

Written here instead of generated: twenty fields of four messages are needed, and generated code would bind the service to one
release of a library. Source: Eclipse Sparkplug Specification 3.0.0 (2022), §6.4, and the field numbers of its
`sparkplug_b.proto`; Protocol Buffers, "Encoding".
"""

import struct
from collections.abc import Iterator
from dataclasses import dataclass, field

from formats.wire import Rejected

LARGEST_METRIC_COUNT = 5_000
SIGNED_BITS = {1: 8, 2: 16, 3: 32, 4: 64}
"""Bits of the signed integer types by their number; they come as unsigned ones."""
FLOAT, DOUBLE, BOOLEAN = 9, 10, 11
REBIRTH = "Node Control/Rebirth"
"""Name of the metric that asks a node for its names again."""
QUALITY, GOOD = b"Quality", 192
"""Property that says what a value is worth (§6.4.18: 0 bad, 192 good, 500 stale), and its value where all is well."""
COMPRESSED = b"SPBV1.0_COMPRESSED"
"""Name by which a payload says that its body is compressed (Eclipse Tahu)."""
VARINT, FIXED64, BYTES, FIXED32 = 0, 1, 2, 5

Field = tuple[int, int, int | bytes]


@dataclass(frozen=True)
class SparkplugMetric:
    """A metric: its name, or the alias that stands for it, its value and the time of it [ms]; None where there is none.

    A value that the node itself calls bad or stale is none.
    """

    name: str | None
    alias: int | None
    value: float | None
    timestamp: int | None = None
    is_historical: bool = False


@dataclass(frozen=True)
class SparkplugPayload:
    """A payload: the time [ms], the node's count of messages modulo 256, the metrics."""

    timestamp: int | None = None
    sequence: int | None = None
    metrics: list[SparkplugMetric] = field(default_factory=list)


def decoded(body: bytes) -> SparkplugPayload:
    """Return a payload. Raises Rejected."""
    timestamp = sequence = None
    metrics: list[SparkplugMetric] = []
    for number, kind, value in _fields(body):
        if number == 1 and isinstance(value, int):
            timestamp = value
        elif number == 2 and isinstance(value, bytes):
            if len(metrics) >= LARGEST_METRIC_COUNT:
                raise Rejected("undecodable", f"more than {LARGEST_METRIC_COUNT} metrics in one Sparkplug payload")
            metrics.append(_metric(value))
        elif number == 3 and isinstance(value, int) and kind == VARINT:
            sequence = value % 256
        elif number == 4 and value == COMPRESSED:
            raise Rejected("undecodable", "a compressed Sparkplug payload is not read: let the node send it as it is")
    return SparkplugPayload(timestamp, sequence, metrics)


def rebirth(timestamp: int) -> bytes:
    """Return the payload that asks a node for its names again. timestamp: [ms]."""
    name = REBIRTH.encode()
    metric = b"\x0a" + _varint(len(name)) + name + b"\x20" + _varint(BOOLEAN) + b"\x70\x01"
    return b"\x08" + _varint(timestamp) + b"\x12" + _varint(len(metric)) + metric


def _metric(body: bytes) -> SparkplugMetric:
    found: dict[int, int | bytes] = {number: value for number, _, value in _fields(body)}
    name, datatype = found.get(1), found.get(4)
    return SparkplugMetric(
        name=None if not isinstance(name, bytes) or not name else name.decode("utf-8", "replace"),
        alias=_whole(found.get(2)),
        value=None if found.get(7) or not _is_good(found.get(9)) else _value(found, _whole(datatype)),
        timestamp=_whole(found.get(3)),
        is_historical=bool(found.get(5)),
    )


def _is_good(properties: int | bytes | None) -> bool:
    """Return whether a metric's quality is good; it is, unless its properties say otherwise."""
    if not isinstance(properties, bytes):
        return True
    told = list(_fields(properties))
    keys = [value for number, _, value in told if number == 1]
    values = [value for number, _, value in told if number == 2 and isinstance(value, bytes)]
    return all(_quality(value) == GOOD for key, value in zip(keys, values, strict=False) if key == QUALITY)


def _quality(value: bytes) -> int | None:
    return next((_whole(one) for number, _, one in _fields(value) if number in (3, 4)), None)


def _value(found: dict[int, int | bytes], datatype: int | None) -> float | None:
    """Return a number; None for texts, tables and other types."""
    for number in (10, 11):
        whole = _whole(found.get(number))
        if whole is not None:
            bits = SIGNED_BITS.get(datatype or 0)
            return float(whole if bits is None or whole < 1 << (bits - 1) else whole % (1 << bits) - (1 << bits))
    for number, form in ((12, "<f"), (13, "<d")):
        raw = found.get(number)
        if isinstance(raw, bytes) and len(raw) == struct.calcsize(form):
            (value,) = struct.unpack(form, raw)
            return float(value)
    flag = _whole(found.get(14))
    return None if flag is None else float(flag)


def _whole(value: int | bytes | None) -> int | None:
    return value if isinstance(value, int) else None


def _fields(body: bytes) -> Iterator[Field]:
    """Yield number, wire type and value of each field; of fixed ones the bytes. Raises Rejected."""
    at = 0
    while at < len(body):
        tag, at = _read_varint(body, at)
        number, kind = tag >> 3, tag & 7
        if kind == VARINT:
            value, at = _read_varint(body, at)
            yield number, kind, value
            continue
        if kind == BYTES:
            size, at = _read_varint(body, at)
        elif kind in (FIXED64, FIXED32):
            size = 8 if kind == FIXED64 else 4
        else:
            raise Rejected("undecodable", f"no Sparkplug payload: wire type {kind} at byte {at}")
        if at + size > len(body):
            raise Rejected(
                "undecodable", f"no Sparkplug payload: {size} bytes promised at byte {at}, {len(body) - at} are there"
            )
        yield number, kind, body[at : at + size]
        at += size


def _read_varint(body: bytes, at: int) -> tuple[int, int]:
    """Return a number of variable length and where the next field begins. Raises Rejected."""
    value = shift = 0
    while at < len(body) and shift < 70:
        byte = body[at]
        value |= (byte & 0x7F) << shift
        at, shift = at + 1, shift + 7
        if byte < 0x80:
            return value & (1 << 64) - 1, at
    raise Rejected("undecodable", f"no Sparkplug payload: a number that does not end at byte {at}")


def _varint(value: int) -> bytes:
    parts = bytearray()
    while value >= 0x80:
        parts.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes((*parts, value))
