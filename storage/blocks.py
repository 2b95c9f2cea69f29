"""Samples as arrays, and the compressed block in which they are stored, exact to the bit."""

import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.measurement import Measurement

_HEADER = struct.Struct("<4sHHII")  # magic, format, channels, samples, checksum of all that and the body
_MAGIC = b"RDSB"
_FORMAT = 1


class DamagedBlock(ValueError):
    """A stored block cannot be read."""


@dataclass(frozen=True)
class Samples:
    """S samples of one machine's m channels, SI.

    time: (S,) [ns since 1970]. speed: (S,) [rad/s]. direction: (S,) +1 or -1. phasor: (S, m) complex 0-to-peak [m], NaN
    where there is none. usable: (S, m). scatter: (S, m) [m], NaN where unknown.
    """

    time: NDArray[np.int64]
    speed: NDArray[np.float64]
    direction: NDArray[np.int8]
    phasor: NDArray[np.complex128]
    usable: NDArray[np.bool_]
    scatter: NDArray[np.float64]

    def __len__(self) -> int:
        return int(self.time.size)

    def pick(self, which: NDArray[np.bool_] | NDArray[np.intp] | slice) -> "Samples":
        """Some of the samples."""
        return Samples(*(getattr(self, name)[which] for name in _FIELDS))

    def between(self, first: int, last: int) -> "Samples":
        """Samples with first <= time <= last [ns]."""
        return self.pick((self.time >= first) & (self.time <= last))

    def measurement(self) -> Measurement:
        """What an identification is fed with."""
        return Measurement(self.speed, self.direction.astype(float), self.phasor, self.usable, self.scatter)


_FIELDS = ("time", "speed", "direction", "phasor", "usable", "scatter")


def join(parts: Sequence[Samples], *, channels: int) -> Samples:
    """Several pieces as one, in the order given."""
    if not parts:
        return Samples(
            np.empty(0, np.int64),
            np.empty(0),
            np.empty(0, np.int8),
            np.empty((0, channels), complex),
            np.empty((0, channels), bool),
            np.empty((0, channels)),
        )
    return Samples(*(np.concatenate([getattr(part, name) for part in parts]) for name in _FIELDS))


def encode(samples: Samples) -> bytes:
    """The block that holds the samples."""
    count, channels = samples.phasor.shape
    body = b"".join(
        [
            samples.time.astype("<i8").tobytes(),
            samples.speed.astype("<f8").tobytes(),
            samples.direction.astype("i1").tobytes(),
            samples.phasor.astype("<c16").tobytes(),
            np.packbits(samples.usable.reshape(-1)).tobytes(),
            samples.scatter.astype("<f8").tobytes(),
        ]
    )
    packed = zlib.compress(body, 1)
    return _HEADER.pack(_MAGIC, _FORMAT, channels, count, _checksum(channels, count, packed)) + packed


def decode(data: bytes) -> Samples:
    """The samples of a block. Raises DamagedBlock."""
    try:
        magic, version, channels, count, checksum = _HEADER.unpack_from(data)
        if magic != _MAGIC or version != _FORMAT:
            raise DamagedBlock(f"not a sample block of format {_FORMAT}")
        if checksum != _checksum(channels, count, data[_HEADER.size :]):
            raise DamagedBlock("sample block is damaged: its checksum does not fit")
        body = memoryview(zlib.decompress(data[_HEADER.size :]))
        values = count * channels
        at = 0

        def take(kind: str, size: int) -> NDArray[np.generic]:
            nonlocal at
            taken = np.frombuffer(body, kind, size, at).copy()
            at += taken.nbytes
            return taken

        return Samples(
            time=take("<i8", count).astype(np.int64),
            speed=take("<f8", count).astype(np.float64),
            direction=take("i1", count).astype(np.int8),
            phasor=take("<c16", values).astype(np.complex128).reshape(count, channels),
            usable=np.unpackbits(take("u1", -(-values // 8)).astype(np.uint8), count=values)
            .astype(bool)
            .reshape(count, channels),
            scatter=take("<f8", values).astype(np.float64).reshape(count, channels),
        )
    except (struct.error, zlib.error, ValueError) as error:
        raise DamagedBlock(f"sample block cannot be read: {error}") from error


def _checksum(channels: int, count: int, packed: bytes) -> int:
    return zlib.crc32(packed, zlib.crc32(struct.pack("<HI", channels, count)))
