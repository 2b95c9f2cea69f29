"""Transient of one mode under a force that follows the speed of a sweep: its steady part, and its deviation from it.

A mode obeys ẇ = (λ - jω) w + force in the frame that turns with the shaft, with its eigenvalue λ; at constant speed w = force
/ (jω - λ). It is integrated step by step, exactly however far it turns within a step.
"""

import numpy as np
import scipy
from msgspec import Struct
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.phasors.speed_law import SpeedLaw


class Sweep(Struct, frozen=True, eq=False):
    """A speed law on a grid of instants.

    Attributes:
        grid: Instants (n,), ascending [s].
        speed: Speeds (n,) [rad/s].
        acceleration: Accelerations (n,) [rad/s²].
        step: Time of each step (n - 1,) [s].
        turned: Angle of each step (n - 1,) [rad].
    """

    grid: Floats
    speed: Floats
    acceleration: Floats
    step: Floats
    turned: Floats

    @classmethod
    def along(cls, law: SpeedLaw, grid: Floats) -> "Sweep":
        """Compute speed and acceleration of a law on a grid of instants.

        Args:
            law: The speed law.
            grid: Instants (n,), ascending [s].

        Returns:
            The sweep.
        """
        return cls(grid, law.speed(grid), law.acceleration(grid), np.diff(grid), np.diff(law.angle(grid)))


class ModalCourse(Struct, frozen=True, eq=False):
    """A modal coordinate on a grid.

    Attributes:
        grid: Instants (n,) [s].
        rest: Steady part (n,) [unit of the coordinate].
        deviation: Deviation from the steady part (n,) [unit of the coordinate].
        integral: Integral of both up to each instant (n,) [unit of the coordinate times s].
    """

    grid: Floats
    rest: Complexes
    deviation: Complexes
    integral: Complexes

    def mean(self, place: NDArray[np.intp]) -> Complexes:
        """Compute the mean of the coordinate around some instants, half way to their neighbours.

        Args:
            place: Indices of the S instants (S,).

        Returns:
            Means (S,) [unit of the coordinate].
        """
        half = (place[1:] + place[:-1]) // 2
        edges = np.concatenate([place[:1], half, place[-1:]])
        return np.asarray(np.diff(self.integral[edges]) / np.diff(self.grid[edges]))


def modal_course(sweep: Sweep, eigenvalue: Complexes, force: Complexes, steady: Complexes) -> ModalCourse:
    """Integrate a modal coordinate.

    Its deviation d obeys ḋ = (λ - jω) d - ẇ_steady + (force - steady force); within a step λ - jω is its mean.

    Source: own derivation: one mode in the frame that turns with the shaft, exact within a step, in the module's docstring.

    Args:
        sweep: The sweep.
        eigenvalue: Eigenvalue λ at each instant (n,) [rad/s].
        force: Modal force (n,) [unit of the coordinate per s].
        steady: Modal force of a steady speed (n,) [unit of the coordinate per s].

    Returns:
        The course of the coordinate.
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
    """Compute the deviation of a single mode under unbalance from its steady state, per unit of modal force over ω².

    Args:
        law: The speed law.
        time: Instants (n,), dense enough to follow the phase [s].
        eigenvalue: Eigenvalue λ of the mode [rad/s].

    Returns:
        Deviations (n,) [rad/s].
    """
    sweep = Sweep.along(law, time)
    steady = (sweep.speed**2).astype(np.complex128)
    force = steady - 1j * sweep.acceleration
    return modal_course(sweep, np.full(time.size, eigenvalue, dtype=np.complex128), force, steady).deviation
