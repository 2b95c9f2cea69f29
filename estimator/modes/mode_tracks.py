"""Modes followed over the spin speed, where coefficients and gyroscopic moments change them.

The modes at two speeds belong together by the orthogonality of the quadratic eigenproblem: yᵢᴴ ((λᵢ + λⱼ) M + C + ΩG) xⱼ = 0
of different modes at one speed (Lancaster, Lambda-Matrices and Vibrating Systems, 1966, ch. 4), and 1 of the same.
"""

from collections.abc import Callable

import numpy as np
import scipy
from msgspec import Struct
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.modes.eigenmodes import Modes, modes
from estimator.rotor.system_matrices import SystemMatrices

SMALLEST_OVERLAP = 0.7
"""Overlap of a mode with the one at the speed before below which a speed between them is looked at [-]."""
LARGEST_DAMPING_RATIO = 0.5
"""Largest damping ratio of a mode that rings [-]: others decay within a turn of theirs."""
LARGEST_DEPTH = 2
"""Most times that the step from speed to speed is halved."""
LOST = 0.3
"""Overlap below which a mode is not followed even over the smallest step [-]."""
CANDIDATES = 2.0
"""Multiple of the highest frequency followed up to which a mode at another speed may be one of those [-]."""
SAME_EIGENVALUE = 1e-8
"""Relative difference of eigenvalues that count as equal [-]."""


class ModeTracks(Struct, frozen=True, eq=False):
    """Modes of a train at ascending speeds, each followed from speed to speed.

    Shapes and left vectors change from speed to speed as little as they can: y(Ω)ᴴ (2λM + C + ΩG) dx/dΩ = 0.

    Attributes:
        speed: Speeds (G,), without sign [rad/s].
        modes: Modes at each speed, n of them in the same order.
    """

    speed: Floats
    modes: tuple[Modes, ...]

    @property
    def eigenvalue(self) -> Complexes:
        """Return the eigenvalues (G, n) [rad/s]."""
        return np.stack([one.eigenvalue for one in self.modes])

    def pick(self, chosen: NDArray[np.bool_]) -> "ModeTracks":
        """Return some of the modes.

        Args:
            chosen: Which of the n modes (n,).

        Returns:
            Their tracks.
        """
        return ModeTracks(self.speed, tuple(_picked(one, np.flatnonzero(chosen)) for one in self.modes))


def mode_tracks(matrices: Callable[[float], SystemMatrices], speeds: Floats, *, direction: int, highest: float) -> ModeTracks:
    """Follow the modes of a train that ring, from the middle of some speeds to both ends.

    Args:
        matrices: Function that returns the train's matrices at a speed.
        speeds: Speeds (G,), ascending, without sign [rad/s].
        direction: Sense of rotation, +1 or -1 [-].
        highest: Damped natural frequency at the middle speed up to which modes are followed [rad/s]; those of a damping ratio
            above `LARGEST_DAMPING_RATIO` are left out.

    Returns:
        The modes that can be followed over all of the speeds; one that is overdamped at some of them cannot.
    """
    return _ModeFollower(matrices, direction, highest).tracks(speeds)


class _ModeFollower:
    def __init__(self, matrices: Callable[[float], SystemMatrices], direction: int, highest: float) -> None:
        self.matrices = matrices
        self.direction = direction
        self.highest = highest

    def tracks(self, speeds: Floats) -> ModeTracks:
        middle = speeds.size // 2
        found = {middle: self._start(float(speeds[middle]))}
        for way in (range(middle + 1, speeds.size), range(middle - 1, -1, -1)):
            behind = middle
            for place in way:
                after, kept = self._follow(found[behind], float(speeds[behind]), float(speeds[place]), LARGEST_DEPTH)
                if not kept.all():
                    found = {at: _picked(one, np.flatnonzero(kept)) for at, one in found.items()}
                found[place], behind = after, place
        return ModeTracks(speeds, tuple(found[place] for place in range(speeds.size)))

    def _start(self, speed: float) -> Modes:
        found = self._modes(speed)
        chosen = (found.eigenvalue.imag < self.highest) & (found.damping_ratio <= LARGEST_DAMPING_RATIO)
        return _picked(found, np.flatnonzero(chosen))

    def _candidates(self, speed: float) -> Modes:
        found = self._modes(speed)
        return _picked(found, np.flatnonzero(found.eigenvalue.imag < CANDIDATES * self.highest))

    def _modes(self, speed: float) -> Modes:
        """Solve for the modes at a speed, left vectors of equal eigenvalues made orthogonal to the others' shapes."""
        held = self.matrices(speed)
        found = modes(held, spin=self.direction * speed)
        left = found.left.copy()
        for group in _equal(found.eigenvalue):
            if len(group) > 1:
                shape = found.shape[:, group]
                momentum = 2.0 * found.eigenvalue[group[0]] * (held.mass @ shape) + self._resistance(held, speed) @ shape
                product = left[:, group].conj().T @ momentum
                left[:, group] = left[:, group] @ np.linalg.pinv(product).conj().T
        return Modes(found.eigenvalue, found.shape, left)

    def _follow(self, before: Modes, speed: float, other: float, depth: int) -> tuple[Modes, NDArray[np.bool_]]:
        """Follow modes to another speed. Returns the modes found there, and to which earlier mode each belongs."""
        there = self._candidates(other)
        overlap = self._overlap(before, there, speed)
        own, place = scipy.optimize.linear_sum_assignment(np.abs(overlap), maximize=True)
        picked, found = _picked(there, place), overlap[np.ix_(own, place)]
        reached = np.zeros(before.eigenvalue.size)
        for group in _equal(picked.eigenvalue):
            block = found[np.ix_(group, group)]
            reached[own[group]] = np.linalg.svd(block, compute_uv=False)[-1]
        if depth > 0 and np.any((reached < SMALLEST_OVERLAP) & (reached > 0.0)):
            between = (speed + other) / 2
            half, first = self._follow(before, speed, between, depth - 1)
            end, second = self._follow(half, between, other, depth - 1)
            kept = first.copy()
            kept[first] = second
            return end, kept
        kept = reached >= LOST
        chosen = kept[own]
        return _aligned(_picked(picked, np.flatnonzero(chosen)), found[np.ix_(chosen, chosen)]), kept

    def _overlap(self, before: Modes, there: Modes, speed: float) -> Complexes:
        """Compute yᵢᴴ ((λᵢ + λⱼ) M + C + ΩG) xⱼ (n, m) with the matrices at the speed before."""
        held = self.matrices(speed)
        left = before.left.conj().T
        mass, resistance = left @ held.mass @ there.shape, left @ self._resistance(held, speed) @ there.shape
        return np.asarray((before.eigenvalue[:, None] + there.eigenvalue) * mass + resistance)

    def _resistance(self, held: SystemMatrices, speed: float) -> Floats:
        return held.damping + self.direction * speed * held.gyroscopic


def _picked(found: Modes, places: NDArray[np.intp]) -> Modes:
    return Modes(found.eigenvalue[places], found.shape[:, places], found.left[:, places])


def _equal(eigenvalue: Complexes) -> list[NDArray[np.intp]]:
    """Return the places of modes by groups of the same eigenvalue, whose shapes may be combined at will."""
    left = list(range(eigenvalue.size))
    groups = []
    while left:
        value = eigenvalue[left[0]]
        group = [place for place in left if abs(eigenvalue[place] - value) <= SAME_EIGENVALUE * abs(value)]
        groups.append(np.array(group, dtype=np.intp))
        left = [place for place in left if place not in group]
    return groups


def _aligned(found: Modes, overlap: Complexes) -> Modes:
    """Return modes rescaled: the overlap of each shape is 1 with its predecessor, 0 with the others of the same eigenvalue."""
    shape, left = found.shape.copy(), found.left.copy()
    for group in _equal(found.eigenvalue):
        block = overlap[np.ix_(group, group)]
        shape[:, group] = shape[:, group] @ np.linalg.inv(block)
        left[:, group] = left[:, group] @ block.conj().T
    return Modes(found.eigenvalue, shape, left)
