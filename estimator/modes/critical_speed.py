"""Critical speeds: where a natural frequency of the train equals its spin speed.

Without damping they are the eigenvalues of one problem: a synchronous whirl e^{jΩt} at spin Ω turns Z into
K - Ω² (M - jG) for rotation from +x to +y, so that K q = Ω² (M - jG) q (Nelson & McVaugh, J. Eng. Ind. 98 (1976) 593,
doi:10.1115/1.3438942). With damping, each natural frequency is followed to the synchronous line.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
import scipy

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.modes.crossing_correction import corrected_crossing, mode_by_inverse_iteration
from estimator.modes.eigenmodes import Modes
from estimator.modes.snapshot_reduction import projected_matrices, snapshot_basis
from estimator.rotor.modal_reduction import SMALL, modal_basis
from estimator.rotor.system_matrices import CoefficientsOverSpeed, SystemMatrices, system_matrices_over_speed
from estimator.rotor.whirl import whirl

HEAVILY_DAMPED = 0.9
"""Damping ratio from which on a crossing is no critical speed [-]."""
EVEN_SAMPLES = 12
"""Number of even steps of speed looked at beside the speeds between the undamped critical speeds."""
STEEPEST = 2.0
"""Largest rate at which a frequency is taken to approach the synchronous line or leave it [-]."""
FINEST = 2e-3
"""Part of the highest speed below which two crossings of one curve are not told apart [-]."""
TOLERANCE = 1e-9
"""Relative error of a crossing [-]."""
SEARCHED_PART = 1e-3
"""Threshold below which shapes of a large train's modes are left out while its crossings are searched [-]."""
SEARCHED_WITHIN = 1e-2
"""Relative distance within which a correction must stay from the crossing that was found in the search [-]."""


@dataclass(frozen=True)
class CriticalSpeed:
    """One crossing of a natural frequency with the synchronous line.

    Attributes:
        speed: Critical speed [rad/s].
        eigenvalue: Eigenvalue λ with Im λ = speed [rad/s].
        whirl: Sense of whirl from +1 forward to -1 backward [-]; see `whirl`.
    """

    speed: float
    eigenvalue: complex
    whirl: float

    @property
    def damping_ratio(self) -> float:
        """Return the damping ratio -Re λ / |λ| [-]."""
        return -self.eigenvalue.real / abs(self.eigenvalue)

    @property
    def log_decrement(self) -> float:
        """Return the logarithmic decrement -2π Re λ / Im λ [-]."""
        return -2 * np.pi * self.eigenvalue.real / self.eigenvalue.imag


MatricesOverSpeed = Callable[[float], SystemMatrices]
"""Function that returns the matrices at a spin speed [rad/s, without sign]."""


def critical_speed_table(
    machine: Machine, *, highest: float, coefficients: CoefficientsOverSpeed = None
) -> tuple[CriticalSpeed, ...]:
    """Compute the critical speeds of a machine, those of modes that are hardly felt in passing left out.

    Args:
        machine: The machine.
        highest: Highest speed, positive [rad/s].
        coefficients: Coefficients (K,) [SI], or a function of the speed that returns them; None for the expected ones.

    Returns:
        Critical speeds [rad/s], ascending.

    Raises:
        ValueError: The highest speed is not positive.
    """
    matrices = system_matrices_over_speed(machine, coefficients=coefficients, basis=modal_basis(machine, highest))
    return lightly_damped_crossings(matrices, direction=machine.direction, highest=highest)


def critical_speeds(machine: Machine, *, highest: float, coefficients: CoefficientsOverSpeed = None) -> Floats:
    """Compute the speeds at which a damped natural frequency equals the spin speed.

    These are the crossings of the Campbell diagram's curves with the synchronous line, both whirl directions counted. Modes so
    heavily damped that nothing is felt in passing are left out.

    Args:
        machine: The machine.
        highest: Highest speed, positive [rad/s].
        coefficients: Coefficients (K,) [SI], or a function of the speed that returns them; None for the expected ones.

    Returns:
        Critical speeds (c,) [rad/s], ascending.

    Raises:
        ValueError: The highest speed is not positive.
    """
    found = critical_speed_table(machine, highest=highest, coefficients=coefficients)
    return np.array([one.speed for one in found])


def undamped_critical_speeds(matrices: SystemMatrices, *, direction: int) -> Floats:
    """Solve K q = Ω² (M - jG) q for the critical speeds of constant matrices without damping.

    Source: Nelson & McVaugh (1976, doi:10.1115/1.3438942). Unequal cross-coupled stiffnesses make some speeds complex; their
    real part is returned then.

    Args:
        matrices: Matrices of the train.
        direction: Sense of rotation, +1 from +x to +y, else -1.

    Returns:
        All critical speeds (c,) [rad/s], ascending.
    """
    inertia = matrices.mass - 1j * direction * matrices.gyroscopic
    # Solved for 1/Ω², which is negative where gyroscopic moments keep a disc from ever being overtaken.
    inverse_square = scipy.linalg.eigvals(inertia, matrices.stiffness)
    inverse_square = inverse_square[np.isfinite(inverse_square)]
    positive = inverse_square[inverse_square.real > 1e-12 * np.max(np.abs(inverse_square), initial=0.0)]
    return np.asarray(np.sort((1 / np.sqrt(positive)).real))


def lightly_damped_crossings(matrices: MatricesOverSpeed, *, direction: int, highest: float) -> tuple[CriticalSpeed, ...]:
    """Find the synchronous crossings of modes whose damping ratio is below HEAVILY_DAMPED.

    Args:
        matrices: Matrices over the spin speed.
        direction: Sense of rotation, +1 from +x to +y, else -1.
        highest: Highest speed, positive [rad/s].

    Returns:
        Critical speeds [rad/s], ascending.

    Raises:
        ValueError: The highest speed is not positive.
    """
    large = matrices(highest).mass.shape[0] > SMALL
    search = _crossings_by_reduction if large else synchronous_crossings
    found = search(matrices, direction=direction, highest=highest)
    return tuple(one for one in found if one.damping_ratio < HEAVILY_DAMPED)


def _crossings_by_reduction(matrices: MatricesOverSpeed, *, direction: int, highest: float) -> tuple[CriticalSpeed, ...]:
    """Find the crossings of a large train in the basis of its modes at a few speeds, and correct each."""
    basis = snapshot_basis(matrices, direction=direction, fastest=highest, highest=highest, smallest=SEARCHED_PART)
    narrow = projected_matrices(matrices, basis)
    found: list[Modes] = []
    for root, _ in crossing_modes(narrow, direction=direction, highest=highest):
        shape, left = mode_by_inverse_iteration(narrow(root.imag), root, spin=direction * root.imag)
        guess = Modes(np.array([root]), basis.expanded(shape[:, None]), basis.expanded(left[:, None]))
        exact = corrected_crossing(matrices, guess, direction=direction)
        # Of two that nearly coincide, both corrections may lead to one.
        lost = exact is None or abs(exact.eigenvalue[0] - root) > SEARCHED_WITHIN * abs(root)
        found.append(guess if lost or exact is None or any(_is_same_mode(one, exact) for one in found) else exact)
    return tuple(
        CriticalSpeed(
            speed=float(one.eigenvalue[0].imag),
            eigenvalue=complex(one.eigenvalue[0]),
            whirl=float(whirl(one.shape, matrices(highest).mass, direction=direction)[0]),
        )
        for one in sorted(found, key=lambda one: float(one.eigenvalue[0].imag))
    )


def _is_same_mode(one: Modes, other: Modes) -> bool:
    return bool(abs(one.eigenvalue[0] - other.eigenvalue[0]) <= TOLERANCE * abs(other.eigenvalue[0]))


def synchronous_crossings(matrices: MatricesOverSpeed, *, direction: int, highest: float) -> tuple[CriticalSpeed, ...]:
    """Find every crossing of a damped natural frequency with the synchronous line.

    Args:
        matrices: Matrices over the spin speed.
        direction: Sense of rotation, +1 from +x to +y, else -1.
        highest: Highest speed, positive [rad/s].

    Returns:
        Critical speeds [rad/s], ascending.

    Raises:
        ValueError: The highest speed is not positive.
    """
    found = []
    for root, shape in crossing_modes(matrices, direction=direction, highest=highest):
        sense = float(whirl(shape[:, None], matrices(root.imag).mass, direction=direction)[0])
        found.append(CriticalSpeed(speed=root.imag, eigenvalue=root, whirl=sense))
    return tuple(found)


def crossing_modes(matrices: MatricesOverSpeed, *, direction: int, highest: float) -> tuple[tuple[complex, Complexes], ...]:
    """Find the modes that cross the synchronous line.

    Frequencies in ascending order, zero for overdamped modes, are continuous in the spin speed, so that a change of sign of
    (frequency - spin) between two speeds holds a crossing. The speeds looked at separate the undamped critical speeds from
    each other; between them intervals are halved while some frequency is so near the line that it could cross it and come
    back. Where coefficients follow the speed, the undamped critical speeds are those of either end and the middle.

    Source: own derivation: change of sign of frequency less spin; undamped ones by Nelson and McVaugh, J. Eng. Ind. 98 (1976)
    593, doi:10.1115/1.3438942.

    Args:
        matrices: Matrices over the spin speed.
        direction: Sense of rotation, +1 from +x to +y, else -1.
        highest: Highest speed, positive [rad/s].

    Returns:
        Eigenvalue λ [rad/s] and shape (N,) [-] of each, by ascending speed.

    Raises:
        ValueError: The highest speed is not positive.
    """
    if not highest > 0:
        raise ValueError(f"the highest speed must be positive, not {highest}")

    @cache
    def frequencies(speed: float) -> Floats:
        roots = np.linalg.eigvals(matrices(speed).state_matrix(spin=direction * speed))
        return np.asarray(np.sort(np.abs(roots.imag))[::2])  # conjugate pairs, and pairs of zeros

    places = {id(one): one for one in (matrices(part * highest) for part in (0.0, 0.5, 1.0))}.values()
    undamped = [undamped_critical_speeds(one, direction=direction) for one in places]
    found = []
    samples = _samples(undamped, highest)
    for lower, upper in zip(samples[:-1], samples[1:], strict=True):
        for start, stop in _intervals(frequencies, lower, upper, FINEST * highest):
            before, after = frequencies(start) - start, frequencies(stop) - stop
            for mode in map(int, np.flatnonzero((before > 0) != (after > 0))):
                if start == 0.0 and before[mode] <= 0.0:
                    continue  # overdamped at standstill: nothing is crossed there
                found.append(_at(matrices, direction, _crossing(frequencies, mode, start, stop), mode))
    return tuple(sorted(found, key=lambda one: one[0].imag))


def _samples(undamped: list[Floats], highest: float) -> list[float]:
    between = [(one[1:] + one[:-1]) / 2 for one in undamped]
    even = np.linspace(0.0, highest, EVEN_SAMPLES + 1)
    samples = np.unique(np.concatenate([even, *between]))
    return [float(one) for one in samples[samples <= highest]]


def _intervals(frequencies: Callable[[float], Floats], lower: float, upper: float, finest: float) -> list[tuple[float, float]]:
    """Divide an interval into pieces in which no frequency can cross the line twice, or that are as fine as `finest`."""
    distance = np.abs(frequencies(lower) - lower) + np.abs(frequencies(upper) - upper)
    if upper - lower <= finest or not np.any(distance < STEEPEST * (upper - lower)):
        return [(lower, upper)]
    middle = (lower + upper) / 2
    return [
        *_intervals(frequencies, lower, middle, finest),
        *_intervals(frequencies, middle, upper, finest),
    ]


def _crossing(frequencies: Callable[[float], Floats], mode: int, lower: float, upper: float) -> float:
    def gap(speed: float) -> float:
        return float(frequencies(speed)[mode] - speed)

    return float(scipy.optimize.brentq(gap, lower, upper, xtol=TOLERANCE * upper, rtol=4 * np.finfo(float).eps))


def _at(matrices: MatricesOverSpeed, direction: int, speed: float, mode: int) -> tuple[complex, Complexes]:
    """Return the crossing of the `mode`-th mode in ascending order of frequency, overdamped ones counted as zero."""
    here = matrices(speed)
    roots, vectors = np.linalg.eig(here.state_matrix(spin=direction * speed))
    size = here.mass.shape[0]
    overdamped = size - int(np.count_nonzero(roots.imag > 0))
    rising = np.flatnonzero(roots.imag > 0)
    chosen = rising[np.argsort(roots[rising].imag)][mode - overdamped]
    return complex(roots[chosen].real, speed), vectors[:size, chosen]
