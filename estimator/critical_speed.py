"""Critical speeds: where a natural frequency of the train equals its spin speed.

Without damping they are the eigenvalues of one problem: a synchronous whirl e^{jΩt} at spin Ω turns Z into
K - Ω² (M - jG) for rotation from +x to +y, so that K q = Ω² (M - jG) q (Nelson & McVaugh, J. Eng. Ind. 98 (1976) 593,
doi:10.1115/1.3438942). With damping, each natural frequency is followed to the synchronous line.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
import scipy.linalg
import scipy.optimize

from estimator.arrays import Complexes, Floats
from estimator.crossing_correction import corrected, mode_of
from estimator.machine import Machine
from estimator.modal_reduction import SMALL, modal_basis
from estimator.modes import Modes
from estimator.snapshot_reduction import narrowed, snapshot_basis
from estimator.system_matrices import CoefficientsOverSpeed, SystemMatrices, system_matrices_over_speed
from estimator.whirl import whirl

HEAVILY_DAMPED = 0.9
"""Damping ratio above which a crossing is no critical speed."""
EVEN_SAMPLES = 12
"""Speeds looked at beside those between the undamped critical speeds."""
STEEPEST = 2.0
"""Rate at which a frequency is taken to come nearer to the synchronous line, or leave it, at most."""
FINEST = 2e-3
"""Part of the highest speed below which two crossings of one curve are not told apart."""
TOLERANCE = 1e-9
"""Relative error of a crossing."""
SEARCHED_PART = 1e-3
"""Shapes of a large train's modes that are left out while its crossings are looked for, and …"""
SEARCHED_WITHIN = 1e-2
"""… relative distance within which they are corrected then."""


@dataclass(frozen=True)
class CriticalSpeed:
    """One crossing. speed: [rad/s]. eigenvalue: λ [rad/s] with Im λ = speed. whirl: +1 forward to -1 backward; see `whirl`."""

    speed: float
    eigenvalue: complex
    whirl: float

    @property
    def damping_ratio(self) -> float:
        """-Re λ / |λ|."""
        return -self.eigenvalue.real / abs(self.eigenvalue)

    @property
    def log_decrement(self) -> float:
        """-2π Re λ / Im λ."""
        return -2 * np.pi * self.eigenvalue.real / self.eigenvalue.imag


MatricesOverSpeed = Callable[[float], SystemMatrices]
"""What gives the matrices at a spin speed [rad/s, without sign]."""


def critical_speed_table(
    machine: Machine, *, highest: float, coefficients: CoefficientsOverSpeed = None
) -> tuple[CriticalSpeed, ...]:
    """Critical speeds up to `highest` [rad/s], ascending, those of modes that are hardly felt in passing left out.

    coefficients: (K,) in SI or what gives them at a speed, by default what the document expects.
    """
    matrices = system_matrices_over_speed(machine, coefficients=coefficients, basis=modal_basis(machine, highest))
    return felt_crossings(matrices, direction=machine.direction, highest=highest)


def critical_speeds(machine: Machine, *, highest: float, coefficients: CoefficientsOverSpeed = None) -> Floats:
    """Speeds up to `highest` [rad/s] at which a damped natural frequency equals the spin speed, ascending.

    The crossings of the Campbell diagram's curves with the synchronous line, both whirl directions counted. Modes so heavily
    damped that nothing is felt in passing are left out.
    """
    found = critical_speed_table(machine, highest=highest, coefficients=coefficients)
    return np.array([one.speed for one in found])


def undamped_critical_speeds(matrices: SystemMatrices, *, direction: int) -> Floats:
    """All critical speeds [rad/s] of constant matrices without damping, ascending, from one generalised eigenvalue problem.

    direction: +1 for rotation from +x to +y, else -1. Unequal cross-coupled stiffnesses make some of them complex; their
    real part is given then.
    """
    inertia = matrices.mass - 1j * direction * matrices.gyroscopic
    # Solved for 1/Ω², which is negative where gyroscopic moments keep a disc from ever being overtaken.
    inverse_square = scipy.linalg.eigvals(inertia, matrices.stiffness)
    inverse_square = inverse_square[np.isfinite(inverse_square)]
    positive = inverse_square[inverse_square.real > 1e-12 * np.max(np.abs(inverse_square), initial=0.0)]
    return np.asarray(np.sort((1 / np.sqrt(positive)).real))


def felt_crossings(matrices: MatricesOverSpeed, *, direction: int, highest: float) -> tuple[CriticalSpeed, ...]:
    """The synchronous crossings of modes that are not so heavily damped that nothing is felt in passing."""
    large = matrices(highest).mass.shape[0] > SMALL
    search = _searched if large else synchronous_crossings
    found = search(matrices, direction=direction, highest=highest)
    return tuple(one for one in found if one.damping_ratio < HEAVILY_DAMPED)


def _searched(matrices: MatricesOverSpeed, *, direction: int, highest: float) -> tuple[CriticalSpeed, ...]:
    """The crossings that a large train's modes at a few speeds make, each corrected."""
    basis = snapshot_basis(matrices, direction=direction, fastest=highest, highest=highest, smallest=SEARCHED_PART)
    narrow = narrowed(matrices, basis)
    found: list[Modes] = []
    for root, _ in crossing_modes(narrow, direction=direction, highest=highest):
        shape, left = mode_of(narrow(root.imag), root, spin=direction * root.imag)
        guess = Modes(np.array([root]), basis.expanded(shape[:, None]), basis.expanded(left[:, None]))
        exact = corrected(matrices, guess, direction=direction)
        # Of two that nearly coincide, both corrections may lead to one.
        lost = exact is None or abs(exact.eigenvalue[0] - root) > SEARCHED_WITHIN * abs(root)
        found.append(guess if lost or exact is None or any(_same(one, exact) for one in found) else exact)
    return tuple(
        CriticalSpeed(
            speed=float(one.eigenvalue[0].imag),
            eigenvalue=complex(one.eigenvalue[0]),
            whirl=float(whirl(one.shape, matrices(highest).mass, direction=direction)[0]),
        )
        for one in sorted(found, key=lambda one: float(one.eigenvalue[0].imag))
    )


def _same(one: Modes, other: Modes) -> bool:
    return bool(abs(one.eigenvalue[0] - other.eigenvalue[0]) <= TOLERANCE * abs(other.eigenvalue[0]))


def synchronous_crossings(matrices: MatricesOverSpeed, *, direction: int, highest: float) -> tuple[CriticalSpeed, ...]:
    """Every crossing of a damped natural frequency with the synchronous line up to `highest` [rad/s], ascending.

    Raises ValueError when `highest` is not positive.
    """
    found = []
    for root, shape in crossing_modes(matrices, direction=direction, highest=highest):
        sense = float(whirl(shape[:, None], matrices(root.imag).mass, direction=direction)[0])
        found.append(CriticalSpeed(speed=root.imag, eigenvalue=root, whirl=sense))
    return tuple(found)


def crossing_modes(matrices: MatricesOverSpeed, *, direction: int, highest: float) -> tuple[tuple[complex, Complexes], ...]:
    """The modes that cross the synchronous line up to `highest` [rad/s]: eigenvalue λ [rad/s] and shape (N,), ascending.

    Frequencies in ascending order, zero for overdamped modes, are continuous in the spin speed, so that a change of sign of
    (frequency - spin) between two speeds holds a crossing. The speeds looked at separate the undamped critical speeds from
    each other; between them intervals are halved while some frequency is so near the line that it could cross it and come
    back. Where coefficients follow the speed, the undamped critical speeds are those of either end and the middle.
    Raises ValueError when `highest` is not positive.
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
    """Pieces of an interval in which no frequency can cross the line twice, or that are as fine as `finest`."""
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
    """The crossing of the mode that is `mode`-th in ascending order of frequency, overdamped ones counted as zero."""
    here = matrices(speed)
    roots, vectors = np.linalg.eig(here.state_matrix(spin=direction * speed))
    size = here.mass.shape[0]
    overdamped = size - int(np.count_nonzero(roots.imag > 0))
    rising = np.flatnonzero(roots.imag > 0)
    chosen = rising[np.argsort(roots[rising].imag)][mode - overdamped]
    return complex(roots[chosen].real, speed), vectors[:size, chosen]
