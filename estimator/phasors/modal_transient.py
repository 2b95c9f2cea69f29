"""One mode under a force that follows the speed of a sweep: its steady part, and what it deviates from it by.

A mode obeys ẇ = (λ - jω) w + force in the frame that turns with the shaft, with its eigenvalue λ; at constant speed
w = force / (jω - λ). It is integrated step by step, exactly however far it turns within a step.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.phasors.speed_law import SpeedLaw


@dataclass(frozen=True)
class Sweep:
    """A speed law on a grid (n,) of instants: speed, acceleration, and what time [s] and angle [rad] each step takes."""

    grid: Floats
    speed: Floats
    acceleration: Floats
    step: Floats
    turned: Floats

    @classmethod
    def along(cls, law: SpeedLaw, grid: Floats) -> "Sweep":
        """Return the law on a grid of instants (n,) [s], ascending."""
        return cls(grid, law.speed(grid), law.acceleration(grid), np.diff(grid), np.diff(law.angle(grid)))


@dataclass(frozen=True)
class ModalCourse:
    """A modal coordinate on the grid (n,): steady part, deviation from it, and the integral of both up to each instant."""

    grid: Floats
    rest: Complexes
    deviation: Complexes
    integral: Complexes

    def mean(self, place: NDArray[np.intp]) -> Complexes:
        """Mean of the coordinate around each of the instants (S,), half way to their neighbours."""
        half = (place[1:] + place[:-1]) // 2
        edges = np.concatenate([place[:1], half, place[-1:]])
        return np.asarray(np.diff(self.integral[edges]) / np.diff(self.grid[edges]))


def modal_course(sweep: Sweep, eigenvalue: Complexes, force: Complexes, steady: Complexes) -> ModalCourse:
    """A modal coordinate for the modal force (n,) and that of a steady speed.

    Its deviation d obeys ḋ = (λ - jω) d - ẇ_steady + (force - steady force); within a step λ - jω is its mean.
    """
    exponent, step = eigenvalue - 1j * sweep.speed, sweep.step
    rest = -steady / exponent
    z = (eigenvalue[1:] + eigenvalue[:-1]) / 2 * step - 1j * sweep.turned
    growth = np.exp(z)
    beside = force - steady
    driven = step * (beside[1:] + beside[:-1]) / 2 - np.diff(rest)
    # Before the first sample the mode lagged behind its steady state as it does in a slow sweep.
    lag = ((rest[1] - rest[0]) / step[0] - beside[0]) / exponent[0]
    bands = np.ones((2, rest.size), dtype=complex)
    bands[1, :-1] = -growth
    right = np.concatenate([[lag], (growth - 1.0) / z * driven])
    deviation = scipy.linalg.solve_banded((1, 0), bands, right, check_finite=False)
    # The equation integrated over a step: the deviation's integral is exact however often it turns within it.
    gained = step * ((np.diff(deviation) - driven) / z + (rest[1:] + rest[:-1]) / 2)
    return ModalCourse(sweep.grid, rest, np.asarray(deviation), np.concatenate([[0.0], np.cumsum(gained)]))


def modal_deviation(law: SpeedLaw, time: Floats, eigenvalue: complex) -> Complexes:
    """What a single mode λ under unbalance deviates from its steady state by (n,), per unit of modal force over ω².

    time: (n,) [s], dense enough to follow the phase.
    """
    sweep = Sweep.along(law, time)
    steady = (sweep.speed**2).astype(np.complex128)
    force = steady - 1j * sweep.acceleration
    return modal_course(sweep, np.full(time.size, eigenvalue, dtype=np.complex128), force, steady).deviation
