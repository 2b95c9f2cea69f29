"""Arrays of samples, and the compressed block in which they are stored, exact to the bit."""

import struct
import zlib
from collections.abc import Sequence

import numpy as np
from msgspec import Struct, field
from msgspec.structs import force_setattr
from numpy.typing import NDArray

from estimator.errors import Damaged
from estimator.phasors.channel_status import ChannelStatus
from estimator.phasors.measurement import MeasuredGaps, Measurement
from estimator.phasors.recorded_run import RecordedRun
from storage.encoding.packing import pack, shuffled, unpack, unshuffled

_HEADER = struct.Struct("<4sHHII")  # magic, format, channels, samples, checksum of channels, samples and body
_MAGIC = b"RDSB"
_FORMAT = 6
_WITHOUT_OVERALL = 5  # of samples without overall levels, so that an older release reads them, too
_WITHOUT_GAP = 4  # of samples without overall levels and gaps
_OLDEST_FORMAT = 1  # unpacked numbers up to 3; no conditions before 3; no 2× and one bit of status in 1


class DamagedBlock(Damaged):
    """A stored block cannot be read."""


class Samples(Struct, frozen=True, eq=False):
    """S samples of one machine's m channels, SI.

    time: (S,) [ns since 1970]. speed: (S,) [rad/s]. direction: (S,) +1 or -1. phasor: (S, m) complex 1× 0-to-peak [m], NaN
    where there is none. status: (S, m) ChannelStatus. scatter: (S, m) rms of the complex error of the 1× [m], NaN where
    unknown. second: (S, m) complex 2× 0-to-peak [m], NaN where there is none; it does not enter the fit. conditions: (S, k)
    operating conditions in the document's order and units, NaN where one was not measured; by default none. gap: (S, m) mean
    place of the shaft towards the probe [m], NaN where there is none. overall: (S, m) unfiltered vibration, half of the
    largest less the smallest displacement [m], NaN where there is none; it does not enter the fit.
    """

    time: NDArray[np.int64]
    speed: NDArray[np.float64]
    direction: NDArray[np.int8]
    phasor: NDArray[np.complex128]
    status: NDArray[np.uint8]
    scatter: NDArray[np.float64]
    second: NDArray[np.complex128]
    conditions: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 0)))
    gap: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 0)))
    overall: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 0)))

    def __post_init__(self) -> None:
        if self.conditions.size == 0 and len(self.conditions) != len(self):
            force_setattr(self, "conditions", np.empty((len(self), 0)))
        for name in ("gap", "overall"):
            table = getattr(self, name)
            if table.size == 0 and table.shape != self.phasor.shape:
                force_setattr(self, name, np.full(self.phasor.shape, np.nan))

    @property
    def usable(self) -> NDArray[np.bool_]:
        """Return (S, m) where the 1× phasor is good."""
        return np.asarray(self.status == ChannelStatus.GOOD)

    def __len__(self) -> int:
        return int(self.time.size)

    def pick(self, which: NDArray[np.bool_] | NDArray[np.intp] | slice) -> "Samples":
        """Return some of the samples."""
        if isinstance(which, np.ndarray) and which.dtype == np.bool_ and which.all():
            return self
        return Samples(*(getattr(self, name)[which] for name in _FIELDS))

    def between(self, first: int, last: int) -> "Samples":
        """Return the samples with first <= time <= last [ns]."""
        return self.pick((self.time >= first) & (self.time <= last))

    def recorded(self, channels: tuple[str, ...]) -> RecordedRun:
        """Return the samples in the form by which the quality of a run is assessed."""
        return RecordedRun(self.time / 1e9, self.speed, self.phasor, self.status, self.scatter, channels)

    def measurement(self) -> Measurement:
        """Return the samples in the form of an identification's input."""
        usable = self.usable
        place = np.where(usable, self.gap, np.nan)
        gaps = None
        if np.isfinite(place).any():
            gaps = MeasuredGaps(place, (self.time - self.time[0]) / 1e9, np.zeros(len(self), np.intp))
        return Measurement(self.speed, self.direction.astype(float), self.phasor, usable, self.scatter, gaps=gaps)


_FIELDS = ("time", "speed", "direction", "phasor", "status", "scatter", "second", "conditions", "gap", "overall")


def join(parts: Sequence[Samples], *, channels: int) -> Samples:
    """Concatenate several parts in the order given."""
    if not parts:
        return Samples(
            np.empty(0, np.int64),
            np.empty(0),
            np.empty(0, np.int8),
            np.empty((0, channels), complex),
            np.empty((0, channels), np.uint8),
            np.empty((0, channels)),
            np.empty((0, channels), complex),
        )
    if len(parts) == 1:
        return parts[0]
    width = max(part.conditions.shape[1] for part in parts)
    conditions = np.concatenate([_wider(part.conditions, width) for part in parts])
    rest = {name: np.concatenate([getattr(part, name) for part in parts]) for name in _FIELDS if name != "conditions"}
    return Samples(**rest, conditions=conditions)


def mean_conditions(parts: Sequence[Samples], names: Sequence[str]) -> dict[str, float | None]:
    """Return the mean of each condition over several parts by name, in the document's order; None where never measured."""
    table = np.concatenate([np.empty((0, len(names))), *(_wider(part.conditions, len(names)) for part in parts)])
    counts, sums = np.count_nonzero(np.isfinite(table), axis=0), np.nansum(table, axis=0)
    return {name: float(sums[i] / counts[i]) if counts[i] else None for i, name in enumerate(names)}


def encode(samples: Samples) -> bytes:
    """Encode samples as a block."""
    count, channels = samples.phasor.shape
    with_overall = bool(np.any(~np.isnan(samples.overall)))
    with_gap = with_overall or bool(np.any(~np.isnan(samples.gap)))
    body = b"".join(
        [
            shuffled(np.diff(samples.time, prepend=np.int64(0))),
            shuffled(samples.speed),
            samples.direction.astype("i1").tobytes(),
            pack(_parts(samples.phasor)),
            samples.status.astype("u1").tobytes(),
            pack(samples.scatter),
            pack(_parts(samples.second)),
            pack(samples.gap) if with_gap else b"",
            pack(samples.overall) if with_overall else b"",
            samples.conditions.astype("<f8").tobytes(),
        ]
    )
    packed = zlib.compress(body, 1)
    version = _FORMAT if with_overall else _WITHOUT_OVERALL if with_gap else _WITHOUT_GAP
    return _HEADER.pack(_MAGIC, version, channels, count, _checksum(channels, count, packed)) + packed


def decode(data: bytes) -> Samples:
    """Decode the samples of a block. Raises DamagedBlock."""
    try:
        magic, version, channels, count, checksum = _HEADER.unpack_from(data)
        if magic != _MAGIC or not _OLDEST_FORMAT <= version <= _FORMAT:
            raise DamagedBlock(f"not a sample block of format {_OLDEST_FORMAT} to {_FORMAT}")
        if checksum != _checksum(channels, count, data[_HEADER.size :]):
            raise DamagedBlock("sample block is damaged: its checksum does not fit")
        body = memoryview(zlib.decompress(data[_HEADER.size :]))
        if version < _WITHOUT_GAP:
            return _plain(body, count, channels, version)
        return _packed(body, count, channels, version)
    except DamagedBlock:
        raise
    except (struct.error, zlib.error, ValueError) as error:
        raise DamagedBlock(f"sample block cannot be read: {error}") from error


def _packed(body: memoryview, count: int, channels: int, version: int) -> Samples:
    """Decode the current format, and those before it without overall levels and without gaps."""
    time = np.cumsum(unshuffled(body, 0, count, "<i8").astype(np.int64))
    speed = unshuffled(body, 8 * count, count, "<f8").astype(np.float64)
    at = 16 * count
    direction = np.frombuffer(body, "i1", count, at).copy()
    phasor, at = unpack(body, at + count, (count, 2 * channels))
    status = np.frombuffer(body, "u1", count * channels, at).copy().reshape(count, channels)
    scatter, at = unpack(body, at + count * channels, (count, channels))
    second, at = unpack(body, at, (count, 2 * channels))
    nothing = np.full((count, channels), np.nan)
    gap, at = unpack(body, at, (count, channels)) if version > _WITHOUT_GAP else (nothing, at)
    overall, at = unpack(body, at, (count, channels)) if version > _WITHOUT_OVERALL else (nothing.copy(), at)
    conditions = np.frombuffer(body, "<f8", (len(body) - at) // 8, at).astype(np.float64)
    return Samples(
        time,
        speed,
        direction,
        _complex(phasor),
        status,
        scatter,
        _complex(second),
        conditions.reshape(count, -1 if count else 0),
        gap,
        overall,
    )


def _parts(values: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Return (S, 2 m) real and imaginary parts side by side, to the bit."""
    return np.ascontiguousarray(values).view(np.float64)


def _complex(parts: NDArray[np.float64]) -> NDArray[np.complex128]:
    return np.ascontiguousarray(parts).view(np.complex128)


def _plain(body: memoryview, count: int, channels: int, version: int) -> Samples:
    """Decode the formats of older releases."""
    values = count * channels
    at = 0

    def take(kind: str, size: int) -> NDArray[np.generic]:
        nonlocal at
        taken = np.frombuffer(body, kind, size, at).copy()
        at += taken.nbytes
        return taken

    table = count, channels
    return Samples(
        time=take("<i8", count).astype(np.int64),
        speed=take("<f8", count).astype(np.float64),
        direction=take("i1", count).astype(np.int8),
        phasor=take("<c16", values).astype(np.complex128).reshape(table),
        status=_status(take("u1", values if version > 1 else -(-values // 8)), values, version).reshape(table),
        scatter=take("<f8", values).astype(np.float64).reshape(table),
        second=(
            take("<c16", values).astype(np.complex128) if version > 1 else np.full(values, complex(np.nan, np.nan))
        ).reshape(table),
        conditions=take("<f8", (len(body) - at) // 8).astype(np.float64).reshape(count, -1 if version > 2 else 0),
    )


def _wider(conditions: NDArray[np.float64], width: int) -> NDArray[np.float64]:
    """Return conditions (S, k) padded with columns of NaN to a width: an older block lacks conditions added later."""
    missing = np.full((len(conditions), max(width - conditions.shape[1], 0)), np.nan)
    return np.hstack([conditions, missing]) if missing.shape[1] else conditions


def _status(stored: NDArray[np.generic], values: int, version: int) -> NDArray[np.uint8]:
    if version > 1:
        return stored.astype(np.uint8)
    usable = np.unpackbits(stored.astype(np.uint8), count=values).astype(bool)
    return np.where(usable, ChannelStatus.GOOD, ChannelStatus.NOT_AVAILABLE).astype(np.uint8)


def _checksum(channels: int, count: int, packed: bytes) -> int:
    return zlib.crc32(packed, zlib.crc32(struct.pack("<HI", channels, count)))
