"""Input of an identification: 1× phasors over speed, which of them count, and how well each is known."""

from typing import Self

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats


class MeasuredGaps(Struct, frozen=True, eq=False):
    """Gaps of S samples of m channels, in one run or several.

    Attributes:
        place: Mean places (S, m) of the shaft along the probes' axes, towards them, from a zero of each [m]; NaN: unknown.
        time: Times (S,) from an arbitrary moment on [s].
        run: Number of the run that each sample is of (S,); each run has zeros of its own.
    """

    place: Floats
    time: Floats
    run: NDArray[np.intp]

    def pick(self, which: NDArray[np.bool_]) -> "MeasuredGaps":
        """Return some of the samples.

        Args:
            which: True for the samples wanted (S,).

        Returns:
            Their gaps.
        """
        return MeasuredGaps(self.place[which], self.time[which], self.run[which])


class Measurement(Struct, frozen=True, eq=False):
    """S samples of m channels.

    Attributes:
        speed: Spin speeds (S,) [rad/s].
        direction: Sense of rotation (S,), +1 or -1 [-].
        phasor: Complex 0-to-peak displacements (S, m), phase lead [m].
        usable: False where a value must not be used (S, m).
        scatter: Rms of the complex error (S, m) as the source measured it [m], NaN where it did not.
        added: Known unbalances (S, P) beside the residual ones [kg m], such as a trial weight that was on during some of the
            samples; None for none.
        gaps: The gaps; None where no source sends them.
    """

    speed: Floats
    direction: Floats
    phasor: Complexes
    usable: NDArray[np.bool_]
    scatter: Floats
    added: Complexes | None = None
    gaps: MeasuredGaps | None = None

    @classmethod
    def of(cls, *, speed: Floats, phasor: Complexes, direction: float = 1.0) -> Self:
        """Build a measurement in one sense of rotation in which every finite phasor is usable and no scatter is known.

        Args:
            speed: Spin speeds (S,) [rad/s].
            phasor: Complex 0-to-peak displacements (S, m) [m].
            direction: Sense of rotation, +1 or -1 [-].

        Returns:
            The measurement.
        """
        return cls(
            speed=np.asarray(speed, dtype=float),
            direction=np.full(len(speed), float(direction)),
            phasor=np.asarray(phasor, dtype=complex),
            usable=np.isfinite(phasor),
            scatter=np.full(np.shape(phasor), np.nan),
        )

    def __post_init__(self) -> None:
        samples, channels = self.phasor.shape
        shapes = {"speed": (samples,), "direction": (samples,), "usable": (samples, channels)}
        shapes["scatter"] = (samples, channels)
        for name, shape in shapes.items():
            if getattr(self, name).shape != shape:
                raise ValueError(f"{name} has shape {getattr(self, name).shape}, should have {shape}")
        if self.added is not None and (self.added.ndim != 2 or len(self.added) != samples):
            raise ValueError(f"added has shape {self.added.shape}, should have a row for each of {samples} samples")
        if np.any(self.usable & ~np.isfinite(self.phasor)):
            raise ValueError("a phasor marked usable is not finite")
        if self.gaps is not None and self.gaps.place.shape != (samples, channels):
            raise ValueError(f"gaps have shape {self.gaps.place.shape}, should have {(samples, channels)}")

    def pick(self, which: NDArray[np.bool_]) -> "Measurement":
        """Return some of the samples.

        Args:
            which: True for the samples wanted (S,).

        Returns:
            The measurement with these samples.
        """
        return Measurement(
            self.speed[which],
            self.direction[which],
            self.phasor[which],
            self.usable[which],
            self.scatter[which],
            None if self.added is None else self.added[which],
            None if self.gaps is None else self.gaps.pick(which),
        )

    def with_trial_weight(self, unbalances: Complexes) -> "Measurement":
        """Return the same samples as taken while known unbalances were added at the discs.

        Args:
            unbalances: Added unbalances (P,) [kg m].

        Returns:
            The measurement with these unbalances.
        """
        return replace(self, added=np.tile(unbalances, (self.speed.size, 1)))


def joined(measurements: list[Measurement]) -> Measurement:
    """Join several measurements of the same machine and channels.

    Args:
        measurements: The measurements.

    Returns:
        One measurement.

    Raises:
        ValueError: There is no measurement.
    """
    if not measurements:
        raise ValueError("no measurement to join")
    planes = max(0 if one.added is None else one.added.shape[1] for one in measurements)
    added = [np.zeros((one.speed.size, planes), dtype=complex) if one.added is None else one.added for one in measurements]
    return Measurement(
        speed=np.concatenate([one.speed for one in measurements]),
        direction=np.concatenate([one.direction for one in measurements]),
        phasor=np.concatenate([one.phasor for one in measurements]),
        usable=np.concatenate([one.usable for one in measurements]),
        scatter=np.concatenate([one.scatter for one in measurements]),
        added=np.concatenate(added) if planes else None,
        gaps=_joined_gaps(measurements),
    )


def _joined_gaps(measurements: list[Measurement]) -> MeasuredGaps | None:
    """Return the gaps of several measurements, the runs of each numbered behind those before it."""
    if all(one.gaps is None for one in measurements):
        return None
    found, runs = [], 0
    for one in measurements:
        own = one.gaps or MeasuredGaps(
            np.full(one.phasor.shape, np.nan), np.zeros(one.speed.size), np.zeros(one.speed.size, np.intp)
        )
        found.append((own.place, own.time, own.run + runs))
        runs += int(own.run.max(initial=0)) + 1
    place, time, run = (np.concatenate(parts) for parts in zip(*found, strict=True))
    return MeasuredGaps(place, time, run)
