"""Compact exact packing of numbers: multiples of a quantum, as differences from one sample to the next.

Measured values are rounded to the quantum on arrival (`on_grid`), far below the resolution of any probe, so that a block holds
little more than their noise. Numbers that are no such multiples are stored exactly, to the bit.
"""

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Floats

Bytes = NDArray[np.uint8]

QUANTUM = 2.0**-36
"""Quantum of 14.6 pm [m], a thousandth of the resolution of the best probes; a power of two, so that scaling is exact."""
_LARGEST = 2.0**52
_EXACT, _GRID = b"\x00", b"\x01"


def on_grid(values: Floats) -> Floats:
    """Return the values rounded to multiples of the quantum; every NaN has the same bits."""
    with np.errstate(over="ignore"):
        rounded = np.round(values / QUANTUM) * QUANTUM + 0.0  # no negative zero
    return np.where(np.isnan(rounded), np.nan, rounded)


def pack(table: Floats) -> bytes:
    """Pack (S, n) numbers, sample by sample, into bytes that compress well."""
    whole = _as_multiples(table)
    if whole is None:
        return _EXACT + shuffled(table)
    missing, numbers = whole
    steps = np.diff(numbers, axis=0, prepend=np.zeros((1, numbers.shape[1]), np.int64))
    unsigned = (steps << 1) ^ (steps >> 63)  # zigzag: small steps of either sign become small numbers
    return _GRID + np.packbits(missing).tobytes() + shuffled(unsigned)


def unpack(body: memoryview, at: int, shape: tuple[int, int]) -> tuple[Floats, int]:
    """Return the numbers packed at a position, and the position behind them. Raises ValueError."""
    kind, at = bytes(body[at : at + 1]), at + 1
    size = shape[0] * shape[1]
    if kind == _EXACT:
        return unshuffled(body, at, size, "<f8").reshape(shape).astype(np.float64), at + 8 * size
    if kind != _GRID:
        raise ValueError("numbers are packed in a way that is not known")
    marks = -(-size // 8)
    missing = np.unpackbits(np.frombuffer(body, np.uint8, marks, at), count=size).astype(bool).reshape(shape)
    at += marks
    unsigned = unshuffled(body, at, size, "<u8").astype(np.uint64).reshape(shape)
    steps = (unsigned >> np.uint64(1)).astype(np.int64) ^ -(unsigned & np.uint64(1)).astype(np.int64)
    numbers = np.cumsum(steps, axis=0)
    return np.where(missing, np.nan, numbers * QUANTUM), at + 8 * size


def shuffled(values: NDArray[np.generic]) -> bytes:
    """Return numbers of eight bytes by byte planes: all first bytes, then all second bytes, …"""
    little = np.ascontiguousarray(values).astype(values.dtype.newbyteorder("<"), copy=False)
    return little.view(np.uint8).reshape(-1, 8).T.tobytes()


def unshuffled(body: memoryview, at: int, size: int, kind: str) -> NDArray[np.generic]:
    """Return the numbers from byte planes. Raises ValueError."""
    planes = np.frombuffer(body, np.uint8, 8 * size, at).reshape(8, size)
    return np.ascontiguousarray(planes.T).view(kind).reshape(size)


def _as_multiples(table: Floats) -> tuple[NDArray[np.bool_], NDArray[np.int64]] | None:
    """Return where values are NaN, and the others as multiples of the quantum; None unless that reproduces them to the bit."""
    missing = np.isnan(table)
    if missing.all() and table.tobytes() == np.full(table.shape, np.nan).tobytes():
        return missing, np.zeros(table.shape, np.int64)
    with np.errstate(over="ignore"):
        scaled = np.where(missing, 0.0, table) / QUANTUM
    if not np.all(np.abs(scaled) <= _LARGEST):
        return None
    numbers = scaled.astype(np.int64)
    again = np.where(missing, np.nan, numbers * QUANTUM)
    return (missing, numbers) if again.tobytes() == table.tobytes() else None
