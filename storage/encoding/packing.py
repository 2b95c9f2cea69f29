"""Numbers packed tightly and exactly: whole multiples of a quantum as differences from one sample to the next.

Measured values are rounded to that quantum at the door (`on_grid`), far below what any probe resolves; what a block takes is
then the noise that is left. Numbers that are no such multiples are kept as they are, to the bit.
"""

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Floats

Bytes = NDArray[np.uint8]

QUANTUM = 2.0**-36
"""14.6 pm, a thousandth of what the best probes resolve. A power of two, so that scaling rounds nothing [m]."""
_LARGEST = 2.0**52
_EXACT, _GRID = b"\x00", b"\x01"


def on_grid(values: Floats) -> Floats:
    """Rounded to whole multiples of the quantum; every NaN is the same."""
    with np.errstate(over="ignore"):
        rounded = np.round(values / QUANTUM) * QUANTUM + 0.0  # no negative zero
    return np.where(np.isnan(rounded), np.nan, rounded)


def pack(table: Floats) -> bytes:
    """(S, n) numbers, sample by sample, as bytes that compress well."""
    whole = _whole(table)
    if whole is None:
        return _EXACT + shuffled(table)
    missing, numbers = whole
    steps = np.diff(numbers, axis=0, prepend=np.zeros((1, numbers.shape[1]), np.int64))
    unsigned = (steps << 1) ^ (steps >> 63)  # small ones of either sign are small numbers
    return _GRID + np.packbits(missing).tobytes() + shuffled(unsigned)


def unpack(body: memoryview, at: int, shape: tuple[int, int]) -> tuple[Floats, int]:
    """What was packed at a place, and the place behind it. Raises ValueError."""
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
    """Numbers of eight bytes, all first bytes first, then all second ones, …"""
    little = np.ascontiguousarray(values).astype(values.dtype.newbyteorder("<"), copy=False)
    return little.view(np.uint8).reshape(-1, 8).T.tobytes()


def unshuffled(body: memoryview, at: int, size: int, kind: str) -> NDArray[np.generic]:
    """The numbers again. Raises ValueError."""
    planes = np.frombuffer(body, np.uint8, 8 * size, at).reshape(8, size)
    return np.ascontiguousarray(planes.T).view(kind).reshape(size)


def _whole(table: Floats) -> tuple[NDArray[np.bool_], NDArray[np.int64]] | None:
    """Where there is NaN, and the multiples of the quantum elsewhere; None unless that is all there is, to the bit."""
    missing = np.isnan(table)
    with np.errstate(over="ignore"):
        scaled = np.where(missing, 0.0, table) / QUANTUM
    if not np.all(np.abs(scaled) <= _LARGEST):
        return None
    numbers = scaled.astype(np.int64)
    again = np.where(missing, np.nan, numbers * QUANTUM)
    return (missing, numbers) if again.tobytes() == table.tobytes() else None
