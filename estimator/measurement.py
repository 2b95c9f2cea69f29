"""What an identification is fed with: 1× phasors over speed, which of them count, and how well each is known."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from estimator.condensation import Complexes, Floats
from estimator.machine import Noise


@dataclass(frozen=True)
class Measurement:
    """S samples of m channels.

    speed: (S,) spin speed [rad/s]. direction: (S,) +1 or -1. phasor: (S, m) complex 0-to-peak displacement [m], phase
    lead. usable: (S, m) False where a value must not be used. scatter: (S, m) rms of the complex error [m] as the source
    measured it, NaN where it did not.
    """

    speed: Floats
    direction: Floats
    phasor: Complexes
    usable: NDArray[np.bool_]
    scatter: Floats

    @classmethod
    def of(cls, *, speed: Floats, phasor: Complexes, direction: float = 1.0) -> Self:
        """A measurement in one sense of rotation in which every finite phasor is usable and no scatter is known."""
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
        if np.any(self.usable & ~np.isfinite(self.phasor)):
            raise ValueError("a phasor marked usable is not finite")

    def pick(self, which: NDArray[np.bool_]) -> "Measurement":
        """Some of the samples, (S,) True for those wanted."""
        return Measurement(
            self.speed[which], self.direction[which], self.phasor[which], self.usable[which], self.scatter[which]
        )


def joined(measurements: list[Measurement]) -> Measurement:
    """Several measurements of the same machine and channels as one. Raises ValueError when there is none."""
    if not measurements:
        raise ValueError("no measurement to join")
    return Measurement(
        *(
            np.concatenate([getattr(one, name) for one in measurements])
            for name in ("speed", "direction", "phasor", "usable", "scatter")
        )
    )


def error_size(noise: Noise, amplitude: Floats, scatter: Floats) -> Floats:
    """Rms of the complex error of each phasor [m]: the source's own scatter where it gave one, else the noise model.

    amplitude: |X| 0-to-peak [m], best taken from the fitted response: weights from noisy amplitudes bias the fit.
    """
    modelled = np.sqrt((noise.relative * amplitude) ** 2 + noise.floor**2)
    return np.where(scatter > 0.0, np.maximum(scatter, noise.floor), modelled)
