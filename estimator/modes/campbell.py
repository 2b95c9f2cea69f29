"""Campbell diagram: natural frequencies and damping over spin speed, each curve one mode, and the critical speeds.

Curves are followed by the shapes, not by the order of the frequencies: between neighbouring speeds modes are paired by the
modal assurance criterion (Allemang & Brown, 1st IMAC, 1982, weighted with the mass matrix) and by how little the frequency
moved. Where shapes change too much from one speed to the next, speeds between them are computed too: this distinguishes
curves that veer away from each other from curves that cross.
"""

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.modes.critical_speed import HEAVILY_DAMPED, CriticalSpeed, MatricesOverSpeed, lightly_damped_crossings
from estimator.modes.eigenmodes import Modes, damping_ratio, log_decrement, modes
from estimator.modes.snapshot_reduction import projected_matrices, snapshot_basis
from estimator.rotor.modal_reduction import EVERYTHING, modal_basis
from estimator.rotor.system_matrices import CoefficientsOverSpeed, system_matrices_over_speed
from estimator.rotor.whirl import whirl

SURE_ASSURANCE = 0.9
"""Assurance from which on two shapes are surely the same mode [-]."""
LEAST_ASSURANCE = 0.1
"""Assurance below which two shapes are not the same mode, even if nothing better is there [-]."""
HALVINGS = 7
"""Most halvings of the step between two speeds while shapes change too much."""
COINCIDING = 1e-6
"""Relative distance within which frequencies cannot be told apart, and need not be [-]."""


@dataclass(frozen=True)
class Campbell:
    """Campbell diagram: n curves over S spin speeds.

    Attributes:
        speed: Spin speeds (S,) [rad/s].
        eigenvalue: Eigenvalues λ (S, n) [rad/s], NaN where a mode is overdamped.
        whirl: Sense of whirl (S, n) from +1 forward to -1 backward [-], NaN likewise.
        critical_speeds: Crossings with the synchronous line, found exactly and not on the diagram.
    """

    speed: Floats
    eigenvalue: Complexes
    whirl: Floats
    critical_speeds: tuple[CriticalSpeed, ...]

    @property
    def frequency(self) -> Floats:
        """Return the damped natural frequencies Im λ (S, n) [rad/s]."""
        return np.asarray(self.eigenvalue.imag)

    @property
    def damping_ratio(self) -> Floats:
        """Return the damping ratios -Re λ / |λ| (S, n) [-]; negative where a mode grows."""
        return damping_ratio(self.eigenvalue)

    @property
    def log_decrement(self) -> Floats:
        """Return the logarithmic decrements -2π Re λ / Im λ (S, n) [-]."""
        return log_decrement(self.eigenvalue)


def campbell(
    machine: Machine,
    *,
    speed: Floats,
    highest_frequency: float,
    coefficients: CoefficientsOverSpeed = None,
    crossings: tuple[CriticalSpeed, ...] | None = None,
) -> Campbell:
    """Compute the Campbell diagram of a machine in its sense of rotation.

    Modes are paired by the modal assurance criterion (Allemang & Brown 1982). A curve that is everywhere so heavily damped
    that it cannot be felt is left out.

    Args:
        machine: The machine.
        speed: Spin speeds (S,) [rad/s], ascending, not negative, the last above zero; critical speeds are found up to the
            last.
        highest_frequency: Frequency [rad/s] below which a curve must come somewhere to be shown.
        coefficients: Coefficients (K,) [SI], or a function of the speed that returns them; None for the expected ones.
        crossings: The critical speeds up to the last speed, where they are known already; None searches them.

    Returns:
        The diagram.

    Raises:
        ValueError: The speeds do not ascend, are negative, or end at zero.
    """
    speed = np.asarray(speed, dtype=float)
    if speed.ndim != 1 or speed.size == 0 or speed[0] < 0 or speed[-1] <= 0 or np.any(np.diff(speed) <= 0):
        raise ValueError("speed must be an ascending list of spin speeds [rad/s], not negative, the last above zero")
    basis = modal_basis(machine, max(highest_frequency, float(speed[-1])))
    matrices = system_matrices_over_speed(machine, coefficients=coefficients, basis=basis)
    if basis is not EVERYTHING:
        basis = snapshot_basis(
            matrices,
            direction=machine.direction,
            fastest=float(speed[-1]),
            highest=max(highest_frequency, float(speed[-1])),
        )
        matrices = projected_matrices(matrices, basis)
    follower = _Follower(matrices, machine.direction, highest_frequency)
    at = [follower.modes(float(one)) for one in speed]
    curves: list[dict[int, int]] = [{0: number} for number in range(at[0].eigenvalue.size)]
    ends = dict(enumerate(curves))
    for step in range(1, speed.size):
        successor = follower.pairs(float(speed[step - 1]), at[step - 1], float(speed[step]), at[step], HALVINGS)
        continued = {new: ends[old] for old, new in successor.items()}
        ends = {}
        for number in range(at[step].eigenvalue.size):
            curve = continued.get(number, {})
            if not curve:
                curves.append(curve)
            curve[step] = number
            ends[number] = curve
    if crossings is None:
        crossings = lightly_damped_crossings(matrices, direction=machine.direction, highest=float(speed[-1]))
    return _diagram(machine, matrices, speed, at, curves, highest_frequency, crossings)


def assurance(one: Complexes, other: Complexes, mass: Floats) -> Floats:
    """Compute the modal assurance criterion |xᴴMy|² / (xᴴMx · yᴴMy) (Allemang & Brown 1982, weighted with the mass matrix).

    Args:
        one: Shapes x (N, n) [-].
        other: Shapes y (N, m) [-].
        mass: Mass matrix M (N, N) [SI].

    Returns:
        Assurance (n, m), 0 to 1 [-].
    """
    cross = np.abs(np.conj(one).T @ mass @ other) ** 2
    norms = [np.real(np.sum(np.conj(shape) * (mass @ shape), axis=0)) for shape in (one, other)]
    return np.asarray(cross / np.outer(*norms))


def modal_assurance(before: Modes, after: Modes, mass: Floats) -> Floats:
    """Compute the assurance of each mode with each.

    One among coinciding modes counts as all of them: their shapes are arbitrary.

    Source: Allemang and Brown, 1st IMAC, 1982.

    Args:
        before: n modes.
        after: m modes.
        mass: Mass matrix (N, N) [SI].

    Returns:
        Assurance (n, m), 0 to 1 [-].
    """
    old, new = _coinciding(before.eigenvalue), _coinciding(after.eigenvalue)
    each = assurance(_orthogonal(before.shape, old, mass), _orthogonal(after.shape, new, mass), mass)
    return np.asarray(np.minimum(old @ each @ new, 1.0))


@dataclass(frozen=True)
class _Follower:
    matrices: MatricesOverSpeed
    direction: int
    highest_frequency: float

    def modes(self, speed: float) -> Modes:
        return modes(self.matrices(speed), spin=self.direction * speed, left_vectors=False)

    def pairs(self, lower: float, before: Modes, upper: float, after: Modes, halvings: int) -> dict[int, int]:
        """Pair the modes at `upper` with the modes at `lower` that they continue."""
        alike = modal_assurance(before, after, self.matrices(0.0).mass)
        moved = np.abs(after.eigenvalue[None, :] - before.eigenvalue[:, None]) / np.abs(before.eigenvalue)[:, None]
        rows, columns = scipy.optimize.linear_sum_assignment((1 - alike) + np.minimum(moved, 1.0))
        pairs = {int(i): int(j) for i, j in zip(rows, columns, strict=True) if alike[i, j] >= LEAST_ASSURANCE}
        matters = map(int, np.flatnonzero(before.eigenvalue.imag <= self.highest_frequency))
        if halvings == 0 or all(i in pairs and alike[i, pairs[i]] >= SURE_ASSURANCE for i in matters):
            return pairs
        middle = (lower + upper) / 2
        between = self.modes(middle)
        first = self.pairs(lower, before, middle, between, halvings - 1)
        second = self.pairs(middle, between, upper, after, halvings - 1)
        return {old: second[new] for old, new in first.items() if new in second}


def _coinciding(eigenvalue: Complexes) -> NDArray[np.bool_]:
    """Mark the modes with the same eigenvalue (n, n), each with itself too."""
    distance = np.abs(eigenvalue[:, None] - eigenvalue[None, :])
    return np.asarray(distance < COINCIDING * np.abs(eigenvalue))


def _orthogonal(shapes: Complexes, coinciding: NDArray[np.bool_], mass: Floats) -> Complexes:
    """Replace the shapes of coinciding modes by orthogonal ones that span the same."""
    result = shapes.copy()
    for first in np.flatnonzero(coinciding.sum(axis=1) > 1):
        group = np.flatnonzero(coinciding[first])
        if first == group[0]:
            gram = np.conj(shapes[:, group]).T @ mass @ shapes[:, group]
            result[:, group] = shapes[:, group] @ np.linalg.inv(np.linalg.cholesky(gram)).conj().T
    return result


def _diagram(
    machine: Machine,
    matrices: MatricesOverSpeed,
    speed: Floats,
    at: list[Modes],
    curves: list[dict[int, int]],
    highest_frequency: float,
    crossings: tuple[CriticalSpeed, ...],
) -> Campbell:
    eigenvalue = np.full((speed.size, len(curves)), complex(np.nan, np.nan))
    sense = np.full(eigenvalue.shape, np.nan)
    senses = [whirl(one.shape, matrices(0.0).mass, direction=machine.direction) for one in at]
    for column, curve in enumerate(curves):
        for step, number in curve.items():
            eigenvalue[step, column] = at[step].eigenvalue[number]
            sense[step, column] = senses[step][number]
    exists = ~np.isnan(sense)
    lowest = np.min(np.where(exists, eigenvalue.imag, np.inf), axis=0)
    lightest = np.min(np.where(exists, damping_ratio(eigenvalue), np.inf), axis=0)
    shown = np.flatnonzero((lowest <= highest_frequency) & (lightest < HEAVILY_DAMPED))
    shown = shown[np.argsort(lowest[shown], kind="stable")]
    return Campbell(
        speed=speed,
        eigenvalue=eigenvalue[:, shown],
        whirl=sense[:, shown],
        critical_speeds=crossings,
    )
