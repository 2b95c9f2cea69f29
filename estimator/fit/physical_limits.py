"""Exclusion of models that no machine can have: those with modes that grow at speeds at which it ran.

A fit may end there all the same, where data are few or the model is wrong; balancing masses computed from such a model are
worthless. Where the data allow a model without growing modes nearly as well, that is the fit's end; else the fit is refused.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import chi2

from estimator.arrays import Complexes, Floats
from estimator.fit.coordinates import Coordinates
from estimator.fit.fit_problem import FitProblem, FitResult
from estimator.fit.maximum_likelihood import descend
from estimator.fit.reweighting import with_fitted_noise
from estimator.machine.document import Machine
from estimator.machine.scaled_materials import with_scaled_materials
from estimator.modes.eigenmodes import Modes, damping_ratio, eigenvalue_slopes
from estimator.rotor.modal_reduction import reduced_basis
from estimator.rotor.system_matrices import system_matrices
from estimator.units import rad_per_s_to_rpm

SPEEDS = 5
"""Number of speeds of the range at which modes are looked at where coefficients follow the speed."""
HIGHEST_MODE = 2.0
"""Multiple of the highest speed up to which modes are looked at [-]: coefficients are known at the speeds that were run."""
SMALLEST_DAMPING_RATIO = -1e-4
"""Damping ratio below which a mode grows [-]; an undamped one is computed with rounding errors."""
SMALLEST_ROOT = 1e-3
"""Part of that frequency below which a root is zero but for rounding [-]: a train that nothing holds."""
MARGIN = 2e-4
"""Damping ratio to which a growing mode is brought [-]."""
NEAR = 0.02
"""Damping ratio below which a mode is watched in a step [-]."""
CHANCE = 0.01
"""Chance at which χ² rises more than is allowed where the true modes decay [-].

The rise has at most as many degrees of freedom as modes grow (Self and Liang 1987, doi:10.1080/01621459.1987.10478472).
"""
LARGEST_STEP_COUNT = 30
"""Most steps to such a model."""
STEP_LIMIT = 0.5
"""Largest change of a coordinate in one step [-]."""
SETTLED = 0.5
"""Change of the merit function in a step up to which the steps have ended [-]."""
FIRST_DAMPING = 1e-3
"""Part of the diagonal of the curvature that is added to it in the first step [-]."""
MOST_HALVINGS = 6
"""Most times a step is tried, each time half as long."""
PRIOR_FACTORS = tuple(1.4**power for power in range(1, 9))
"""Factors by which the prior's spread is made smaller, one after the other, to draw what the data leave open [-]."""
DRAWN_STEP_COUNT = 8
"""Most steps with each of them."""
PENALTY = 300.0
"""Weight of lacking damping in the merit function [-]: a damping ratio of -0.01 counts as much as three units of χ²."""


@dataclass(frozen=True)
class LeastDampedMode:
    """Mode of the smallest damping ratio at a speed.

    Attributes:
        speed: Spin speed [rad/s, without sign].
        eigenvalue: Its eigenvalue λ [rad/s].
    """

    speed: float
    eigenvalue: complex

    @property
    def damping_ratio(self) -> float:
        """Return the damping ratio [-]; negative where the mode grows."""
        return float(damping_ratio(np.array(self.eigenvalue)))

    @property
    def lacking(self) -> float:
        """Return how much damping is lacking [-]: the rate of growth over the speed.

        A damping ratio would not do: of every mode that grows without oscillating it is -1, however slowly it grows.
        """
        return max(0.0, self.eigenvalue.real + MARGIN / 2 * abs(self.eigenvalue)) / self.speed

    @property
    def grows(self) -> bool:
        """Return whether the mode grows."""
        return self.damping_ratio < SMALLEST_DAMPING_RATIO

    @property
    def words(self) -> str:
        """Return the sentence about a mode that grows."""
        speed, frequency = rad_per_s_to_rpm(self.speed), rad_per_s_to_rpm(self.eigenvalue.imag)
        mode = f"a mode of {frequency:.0f} cycles per minute grows (damping ratio {self.damping_ratio:.2g})"
        if self.eigenvalue.imag == 0.0:
            mode = "the shaft leaves its bearings without oscillating"
        return f"not physically possible: at {speed:.0f} rpm, where the machine ran, {mode}"


class PhysicalLimits:
    """Least damped modes of a fitted machine at speeds at which it ran."""

    def __init__(self, machine: Machine, speed: Floats, coordinates: Coordinates, scale_names: tuple[str, ...]) -> None:
        """Prepare the search.

        Args:
            machine: The machine.
            speed: Speeds of the samples (S,), without sign [rad/s].
            coordinates: Coordinates of its fit.
            scale_names: Names of the scale factors of E and ρ among them.
        """
        low, high = float(speed.min()), float(speed.max())
        follows = bool(coordinates.models) and high > low
        # Gyroscopic moments alone hardly change what grows.
        self.speeds = np.linspace(low, high, SPEEDS) if follows else np.array([high])
        self.machine = machine
        self.highest = HIGHEST_MODE * high
        self.coordinates = coordinates.at_speeds(self.speeds)
        self.scale_names = scale_names

    def least_damped(self, theta: Floats) -> tuple[LeastDampedMode, ...]:
        """Return the least damped mode at each speed.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            The modes; none for a speed at which there is none.
        """
        return tuple(
            LeastDampedMode(spin, complex(slow[np.argmin(damping_ratio(slow))]))
            for spin, slow in self._slow_modes(theta)
            if slow.size
        )

    def watched(self, theta: Floats) -> tuple[LeastDampedMode, ...]:
        """Return all modes of little or negative damping at all speeds.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            The modes.
        """
        return tuple(
            LeastDampedMode(spin, complex(root))
            for spin, slow in self._slow_modes(theta)
            for root in slow[damping_ratio(slow) < NEAR]
        )

    def growing_mode(self, theta: Floats) -> LeastDampedMode | None:
        """Find a mode that grows.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            The mode of the smallest damping ratio that grows; None where all decay.
        """
        worst = min(self.least_damped(theta), key=lambda one: one.damping_ratio, default=None)
        return worst if worst is not None and worst.grows else None

    def slopes(self, theta: Floats, mode: LeastDampedMode) -> Floats:
        """Compute the derivatives of Re λ by the coordinates of coefficients (Nelson 1976, doi:10.2514/3.7211).

        Args:
            theta: Fit coordinates θ (n,) [-].
            mode: The mode.

        Returns:
            Derivatives (n,), 0 for coordinates of other kinds [rad/s].
        """
        machine, root = self._scaled(theta), mode.eigenvalue
        basis = reduced_basis(machine, self.highest)
        at = self.coordinates.at_speeds(np.array([mode.speed]))
        base = at.coefficients(theta).reshape(-1)
        spin = self.machine.direction * mode.speed
        matrices = system_matrices(machine, coefficients=base, basis=basis)
        left, _, right = np.linalg.svd(matrices.dynamic_stiffness(root, spin=spin))
        shape, other = right[-1].conj()[:, None], left[:, -1][:, None]
        momentum = (2.0 * root * matrices.mass + matrices.damping + spin * matrices.gyroscopic) @ shape
        other = other / np.conj(np.vdot(other, momentum))
        by_coefficient = eigenvalue_slopes(machine, Modes(np.array([root]), shape, other), basis)[0].real
        found = np.zeros(theta.size)
        free = at.place >= 0
        np.add.at(found, at.place[free], (by_coefficient * np.where(at.logarithmic, base, at.scale))[free])
        for one in at.models:
            found[one.first : one.places.stop] += (
                by_coefficient[list(one.coefficients)] @ one.derivatives(theta, slice(0, 1))[0]
            )
        return found

    def _slow_modes(self, theta: Floats) -> Iterator[tuple[float, Complexes]]:
        """Yield each speed with the eigenvalues of its modes up to the highest frequency [rad/s]."""
        machine = self._scaled(theta)
        basis = reduced_basis(machine, self.highest)
        for spin, row in zip(self.speeds.tolist(), self._coefficients(theta), strict=True):
            matrices = system_matrices(machine, coefficients=row, basis=basis)
            roots = np.linalg.eigvals(matrices.state_matrix(spin=self.machine.direction * spin))
            size = np.abs(roots)
            yield spin, roots[(roots.imag >= 0.0) & (size <= self.highest) & (size > SMALLEST_ROOT * self.highest)]

    def _scaled(self, theta: Floats) -> Machine:
        factors = self.coordinates.scales(theta)
        named = dict(zip(self.scale_names, map(float, factors), strict=True))
        return with_scaled_materials(self.machine, named) if named else self.machine

    def _coefficients(self, theta: Floats) -> Floats:
        """Return the coefficients at the speeds looked at (G, K) [SI]."""
        return np.atleast_2d(self.coordinates.coefficients(theta))


Limits = Callable[[FitProblem], PhysicalLimits]
"""Function that returns the limits of a fit's problem."""


def limits_for(machine: Machine) -> Limits:
    """Return the function that prepares the search for growing modes of a machine's fit.

    Args:
        machine: The machine.

    Returns:
        Function of the fit's problem.
    """
    return lambda problem: PhysicalLimits(
        machine, problem.measurement.speed, problem.coordinates, tuple(problem.train.scale_names)
    )


def without_growing_modes(
    limits: PhysicalLimits, problem: FitProblem, found: FitResult
) -> tuple[FitResult, LeastDampedMode | None]:
    """Fit a train again so that no mode grows, from a fit in which one does.

    What the data leave open is drawn to the document's values until no mode grows. From there Gauss-Newton steps lower the
    misfit under the linearised conditions that modes decay (sequential quadratic programming; Nocedal and Wright, Numerical
    Optimization, 2006, ch. 18).

    Args:
        limits: Limits of the machine.
        problem: The fit's problem.
        found: The fit.

    Returns:
        The fit and None, or, where the data do not allow a model without growing modes, the fit as it was and its growing
        mode.
    """
    first = limits.growing_mode(found.theta)
    if first is None:
        return found, None
    final = with_fitted_noise(problem, found)
    weight = final.weight(np.abs(final.model(found.theta)), 0.0)
    growing = sum(one.grows for one in limits.watched(found.theta))
    highest = _linearised(final, found.theta, weight)[0] + float(chi2.isf(CHANCE, growing))
    search = _Search(limits, final, weight, highest)
    kept = search.run(search.nearer_to_document(found.theta))
    return (found, first) if kept is None else (replace(found, theta=kept), None)


class _Search:
    """Search for the best model without growing modes, with steps that are shortened until they lower a merit function."""

    def __init__(self, limits: PhysicalLimits, problem: FitProblem, weight: Floats, highest: float) -> None:
        self.limits = limits
        self.problem = problem
        self.weight = weight
        self.highest = highest

    def run(self, theta: Floats) -> Floats | None:
        """Return θ (n,) of such a model that the data allow; None where none is found."""
        modes = self.limits.watched(theta)
        cost, slope, hessian = _linearised(self.problem, theta, self.weight)
        merit, kept = _merit(cost, modes), None
        if cost <= self.highest and not any(one.grows for one in modes):
            kept = theta
        damping = FIRST_DAMPING
        for _ in range(LARGEST_STEP_COUNT):
            damped = hessian + damping * np.diag(np.diag(hessian))
            step = _constrained_step(slope, damped, modes, self.limits, theta)
            for halving in range(MOST_HALVINGS):
                trial = theta + 0.5**halving * step
                modes = self.limits.watched(trial)
                trial_merit = _merit(self._cost(trial), modes)
                if trial_merit < merit:
                    break
                damping *= 2.0
            else:
                return kept
            damping /= 4.0
            settled = merit - trial_merit < SETTLED
            theta, merit = trial, trial_merit
            cost, slope, hessian = _linearised(self.problem, theta, self.weight)
            if cost <= self.highest and not any(one.grows for one in modes):
                kept = theta
                if settled:
                    break
        return kept

    def nearer_to_document(self, theta: Floats) -> Floats:
        """Return θ (n,) with what the data leave open drawn to the document's values until no mode grows."""
        coordinates = self.problem.coordinates
        for factor in PRIOR_FACTORS:
            held = replace(self.problem, coordinates=_drawn(coordinates, factor))
            theta, _, _ = descend(held, theta, self.weight, DRAWN_STEP_COUNT)
            if self.limits.growing_mode(theta) is None:
                break
        return theta

    def _cost(self, theta: Floats) -> float:
        """Return χ² with its prior."""
        return self.problem.chi_square(theta, self.weight) + self.problem.coordinates.prior.cost(theta)


def _drawn(coordinates: Coordinates, factor: float) -> Coordinates:
    """Return the coordinates with a prior whose standard deviations are smaller by a factor."""
    calibrated = None if coordinates.calibrated is None else coordinates.calibrated * factor**2
    return replace(coordinates, spread=coordinates.spread / factor, calibrated=calibrated)


def _merit(cost: float, modes: tuple[LeastDampedMode, ...]) -> float:
    return cost + PENALTY * sum(one.lacking for one in modes)


def _linearised(problem: FitProblem, theta: Floats, weight: Floats) -> tuple[float, Floats, Floats]:
    """Return χ² with its prior, -½ of its gradient (n,) and its Gauss-Newton curvature (n, n)."""
    prior = problem.coordinates.prior
    data, gradient, curvature = problem.linearised(theta, weight)
    return data + prior.cost(theta), gradient - prior.pull(theta), curvature + prior.precision


def _constrained_step(
    slope: Floats, hessian: Floats, modes: tuple[LeastDampedMode, ...], limits: PhysicalLimits, theta: Floats
) -> Floats:
    """Return the Gauss-Newton step that brings modes of too little damping to the margin."""
    free = np.linalg.solve(hessian, slope)
    if modes:
        normals = np.stack([limits.slopes(theta, one) for one in modes])
        allowed = np.array([-one.eigenvalue.real - MARGIN * abs(one.eigenvalue) for one in modes])
        broken = normals @ free > allowed
        normals, allowed = normals[broken], allowed[broken]
        across = np.linalg.solve(hessian, normals.T)
        free = free + across @ np.linalg.lstsq(normals @ across, allowed - normals @ free, rcond=None)[0]
    return np.asarray(free * min(1.0, STEP_LIMIT / max(float(np.max(np.abs(free))), 1e-300)))
