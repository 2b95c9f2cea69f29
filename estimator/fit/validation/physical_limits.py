"""Exclusion of impossible models: those with growing modes at a speed at which the machine has run.

A fit may end there all the same, where data are few or the model is wrong; balancing masses computed from such a model are
worthless. Where the data allow a model without growing modes nearly as well, that is the fit's end; else the fit is refused.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
import scipy
from msgspec import Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.fit.optimisation.maximum_likelihood import CURVED, bent, descend
from estimator.fit.optimisation.reweighting import with_fitted_noise
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.problem.narrowed_prior import narrowed
from estimator.machine.document import Machine
from estimator.machine.scaled_materials import with_scaled_materials
from estimator.modes.eigenmodes import Modes, damping_ratio, eigenvalue_slopes, log_decrement
from estimator.rotor.modal_reduction import reduced_basis
from estimator.rotor.system_matrices import system_matrices
from estimator.units import rad_per_s_to_rpm

if TYPE_CHECKING:
    from estimator.statics.equilibrium import FilmEquilibrium

SPEEDS = 5
"""Number of speeds of the range at which modes are looked at where coefficients follow the speed."""
HIGHEST_MODE = 2.0
"""Multiple of the highest speed up to which modes are looked at [-]: coefficients are known at the speeds that were run."""
SMALLEST_DAMPING_RATIO = -1e-4
"""Damping ratio below which a mode grows [-]; an undamped one is computed with rounding errors."""
SMALLEST_ROOT = 1e-3
"""Part of that frequency below which a root is zero but for rounding [-]: a train that nothing holds."""
MARGIN = 1e-3
"""Damping ratio to which a growing mode is brought [-]."""
NEAR = 0.02
"""Damping ratio below which a mode is watched in a step [-]."""
NEAR_STATIC = 0.5
"""Part of the speed below which a root without oscillation is watched: it may leave its bearings in the next step [-]."""
CHANCE = 0.01
"""Chance at which χ² rises more than is allowed where the true modes decay [-].

The rise has at most as many degrees of freedom as modes grow (Self and Liang 1987, doi:10.1080/01621459.1987.10478472).
"""
LARGEST_STEP_COUNT = 40
"""Most steps to such a model, also those that are not taken."""
STEP_LIMIT = 0.5
"""Largest change of a coordinate in one step [-]."""
SETTLED = 0.5
"""Change of the merit function in a step up to which the steps have ended [-]."""
FIRST_DAMPING = 1e-3
"""Part of the diagonal of the curvature that is added to it in the first step [-]."""
LARGEST_DAMPING = 1e6
"""Part of the diagonal from which on steps are too short to bring anything [-]."""
SMALLEST_GAIN = 1e-4
"""Part of the decrease that a step promises from which on it is taken [-]."""
ACTIVE_SET_PASSES = 6
"""Largest number of times that the modes near the margin are determined again after a step."""
PRIOR_FACTORS = tuple(1.4**power for power in range(1, 9))
"""Factors by which the prior's spread is made smaller, one after the other, to draw what the data leave open [-]."""
DRAWN_STEP_COUNT = 8
"""Most steps with each of them."""
PENALTY = 1e6
"""Weight of the square of lacking damping in the merit function [-]: a rate of growth of 0.001 of the speed counts as one unit
of χ²."""


class LeastDampedMode(Struct, frozen=True):
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
    def log_decrement(self) -> float:
        """Return its logarithmic decrement [-]; negative where the mode grows."""
        return float(log_decrement(np.array(self.eigenvalue)))

    @property
    def lacking(self) -> float:
        """Return how much damping is lacking [-]: the rate of growth over the speed; negative where there is enough.

        A damping ratio would not do: of every mode that grows without oscillating it is -1, however slowly it grows.
        """
        return (self.eigenvalue.real + MARGIN * abs(self.eigenvalue)) / self.speed

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
        return f"not physically possible: at {speed:.0f} r/min, where the machine ran, {mode}"


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

        Source: standard result: eigenvalues of the train's state matrix.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            The modes; none for a speed at which there is none.
        """
        return self._least_damped(theta, lambda _spin, found: np.ones(found.size, dtype=bool))

    def least_damped_below_speed(self, theta: Floats) -> tuple[LeastDampedMode, ...]:
        """Return the least damped of the modes that oscillate more slowly than the shaft turns, at each speed.

        Source: standard result: eigenvalues of the train's state matrix.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            The modes; none for a speed at which there is none.
        """
        return self._least_damped(theta, lambda spin, found: (found.imag > 0.0) & (found.imag < spin))

    def _least_damped(
        self, theta: Floats, among: Callable[[float, Complexes], NDArray[np.bool_]]
    ) -> tuple[LeastDampedMode, ...]:
        return tuple(
            LeastDampedMode(spin, complex(slow[np.argmin(damping_ratio(slow))]))
            for spin, found in self._slow_modes(theta)
            if (slow := found[self._is_root(found) & among(spin, found)]).size
        )

    def grow(self, modes: Sequence[LeastDampedMode]) -> bool:
        """Return whether one of some modes grows.

        Args:
            modes: The modes.

        Returns:
            Whether one does; a root that is zero but for rounding does not.
        """
        return any(one.grows and bool(self._is_root(np.array(one.eigenvalue))) for one in modes)

    def _is_root(self, eigenvalue: Complexes) -> NDArray[np.bool_]:
        """Return which eigenvalues are not zero but for rounding."""
        return np.asarray(np.abs(eigenvalue) > SMALLEST_ROOT * self.highest)

    def watched(self, theta: Floats) -> tuple[LeastDampedMode, ...]:
        """Return all modes of little or negative damping at all speeds.

        Source: standard result: eigenvalues of the train's state matrix.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            The modes.
        """
        return tuple(
            LeastDampedMode(spin, complex(root))
            for spin, slow in self._slow_modes(theta)
            for root in slow[
                (slow.imag > 0.0) & (damping_ratio(slow) < NEAR) | ((slow.imag == 0.0) & (slow.real > -NEAR_STATIC * spin))
            ]
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
        return np.asarray(self.root_slopes(theta, mode).real)

    def root_slopes(self, theta: Floats, mode: LeastDampedMode) -> Complexes:
        """Compute the derivatives of λ by the coordinates of coefficients (Nelson 1976, doi:10.2514/3.7211).

        Args:
            theta: Fit coordinates θ (n,) [-].
            mode: The mode.

        Returns:
            Derivatives (n,), 0 for coordinates of other kinds [rad/s].
        """
        machine = self._scaled(theta)
        at = self.coordinates.at_speeds(np.array([mode.speed]))
        base = at.coefficients(theta).reshape(-1)
        shapes = self._shapes(machine, at, theta, base, mode)
        by_coefficient = eigenvalue_slopes(machine, shapes, reduced_basis(machine, self.highest))[0]
        found = np.zeros(theta.size, dtype=complex)
        free = at.place >= 0
        np.add.at(found, at.place[free], (by_coefficient * np.where(at.logarithmic, base, at.scale))[free])
        for one in at.models:
            found[one.numbers] += by_coefficient[list(one.coefficients)] @ one.derivatives(theta, slice(0, 1))[0]
        return found

    def _shapes(self, machine: Machine, at: Coordinates, theta: Floats, base: Floats, mode: LeastDampedMode) -> Modes:
        """Return the right and the left vector of a mode, of the train and not of its pads."""
        basis, root = reduced_basis(machine, self.highest), mode.eigenvalue
        spin = self.machine.direction * mode.speed
        tilted = _tilted(at, theta)
        if tilted is not None:
            # Pads are states of their own; that their own numbers change with θ is left out.
            from estimator.statics.pad_states import state_matrix_with_pads

            state = state_matrix_with_pads(machine, tilted[0], basis, coefficients=base)
            left, _, right = np.linalg.svd(state - root * np.eye(len(state)))
            mass = system_matrices(machine, coefficients=base, basis=basis).mass
            whole, adjoint, size = right[-1].conj(), left[:, -1], len(mass)
            other = np.linalg.solve(mass, adjoint[size : 2 * size]) / np.conj(np.vdot(adjoint, whole))
            return Modes(np.array([root]), whole[:size, None], other[:, None])
        matrices = system_matrices(machine, coefficients=base, basis=basis)
        left, _, right = np.linalg.svd(matrices.dynamic_stiffness(root, spin=spin))
        shape, other = right[-1].conj()[:, None], left[:, -1][:, None]
        momentum = (2.0 * root * matrices.mass + matrices.damping + spin * matrices.gyroscopic) @ shape
        return Modes(np.array([root]), shape, other / np.conj(np.vdot(other, momentum)))

    def _slow_modes(self, theta: Floats) -> Iterator[tuple[float, Complexes]]:
        """Yield each speed with the eigenvalues of its modes up to the highest frequency [rad/s].

        Pads that tilt are degrees of freedom of their own: reduced at the spin speed they would not damp a slower mode as they
        do.
        """
        machine = self._scaled(theta)
        basis = reduced_basis(machine, self.highest)
        tilted = _tilted(self.coordinates, theta)
        for place, (speed, row) in enumerate(zip(self.speeds.tolist(), self._coefficients(theta), strict=True)):
            if tilted is not None:
                from estimator.statics.pad_states import state_matrix_with_pads

                state = state_matrix_with_pads(machine, tilted[place], basis, coefficients=row)
            else:
                matrices = system_matrices(machine, coefficients=row, basis=basis)
                state = matrices.state_matrix(spin=self.machine.direction * speed)
            roots = np.linalg.eigvals(state)
            yield speed, roots[(roots.imag >= 0.0) & (np.abs(roots) <= self.highest)]

    def _scaled(self, theta: Floats) -> Machine:
        factors = self.coordinates.scales(theta)
        named = dict(zip(self.scale_names, map(float, factors), strict=True))
        return with_scaled_materials(self.machine, named) if named else self.machine

    def _coefficients(self, theta: Floats) -> Floats:
        """Return the coefficients at the speeds looked at (G, K) [SI]."""
        return np.atleast_2d(self.coordinates.coefficients(theta))


def _tilted(coordinates: Coordinates, theta: Floats) -> "tuple[FilmEquilibrium, ...] | None":
    """Return the equilibria of films with pads that tilt; None where there are none."""
    if not coordinates.models:
        return None
    from estimator.statics.film_curves import FilmCurves  # films are loaded where coefficients follow the speed

    placed = ((one, one.curves) for one in coordinates.models)
    return next((curves.tilted(one.own(theta)) for one, curves in placed if isinstance(curves, FilmCurves)), None)


LimitsFunction = Callable[[FitProblem], PhysicalLimits]
"""Function that returns the limits of a fit's problem."""


def limits_for(machine: Machine) -> LimitsFunction:
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
    """Fit a train again without growing modes, from a fit that has one.

    What the data leave open is drawn to the document's values until no mode grows. From there, and else from the fit itself,
    damped Gauss-Newton steps lower the misfit with a quadratic penalty on modes that lack damping (Nocedal and Wright,
    Numerical Optimization, 2006, ch. 17).

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
    highest = _linearised(final, found.theta, weight)[0] + float(scipy.special.chdtri(growing, CHANCE))
    search = _Search(limits, final, weight, highest)
    for start in (search.nearer_to_document, np.copy):
        kept = search.run(start(found.theta))
        if kept is not None:
            return replace(found, theta=kept), None
    return found, first


class _Search:
    """Search for the best model without growing modes: Levenberg-Marquardt steps under a penalty on lacking damping."""

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
        if cost <= self.highest and not self.limits.grow(modes):
            kept = theta
        damping, growth, curved = FIRST_DAMPING, 2.0, False
        watched = [(one, self.limits.slopes(theta, one)) for one in modes]
        for _ in range(LARGEST_STEP_COUNT):
            damped = np.asarray(hessian + damping * np.diag(np.diag(hessian)), dtype=float)
            step, promised = _penalised_step(slope, damped, watched)
            trial = bent(self.problem, theta, self.weight, step, damped) if curved else theta + step
            trial_cost = self._cost(trial)
            trial_modes = self.limits.watched(trial) if np.isfinite(trial_cost) else ()
            trial_merit = _merit(trial_cost, trial_modes)
            gain = (merit - trial_merit) / promised
            curved = not gain > CURVED
            if not gain > SMALLEST_GAIN:
                damping, growth = damping * growth, 2.0 * growth
                if damping > LARGEST_DAMPING:
                    break
                continue
            damping, growth = damping * max(0.2, 1.0 - (2.0 * min(gain, 1.0) - 1.0) ** 3), 2.0
            settled = merit - trial_merit < SETTLED
            theta, merit, modes = trial, trial_merit, trial_modes
            watched = [(one, self.limits.slopes(theta, one)) for one in modes]
            cost, slope, hessian = _linearised(self.problem, theta, self.weight)
            if cost <= self.highest and not self.limits.grow(modes):
                kept = theta
                if settled:
                    break
        return kept

    def nearer_to_document(self, theta: Floats) -> Floats:
        """Return θ (n,) in which coordinates that the data leave open approach the document's values until no mode grows."""
        coordinates = self.problem.coordinates
        for factor in PRIOR_FACTORS:
            held = replace(self.problem, coordinates=narrowed(coordinates, factor))
            theta, _, _ = descend(held, theta, self.weight, DRAWN_STEP_COUNT)
            if self.limits.growing_mode(theta) is None:
                break
        return theta

    def _cost(self, theta: Floats) -> float:
        """Return χ² with its prior."""
        return self.problem.chi_square(theta, self.weight) + self.problem.coordinates.prior.cost(theta)


def _merit(cost: float, modes: tuple[LeastDampedMode, ...]) -> float:
    return cost + PENALTY * sum(max(0.0, one.lacking) ** 2 for one in modes)


def _linearised(problem: FitProblem, theta: Floats, weight: Floats) -> tuple[float, Floats, Floats]:
    """Return χ² with its prior, -½ of its gradient (n,) and its Gauss-Newton curvature (n, n)."""
    prior = problem.coordinates.prior
    data, gradient, curvature = problem.linearised(theta, weight)
    return data + prior.cost(theta), gradient - prior.pull(theta), curvature + prior.precision


def _penalised_step(slope: Floats, hessian: Floats, modes: Sequence[tuple[LeastDampedMode, Floats]]) -> tuple[Floats, float]:
    """Return the step that lowers cost and penalty most where both are linearised, and the decrease that it promises."""
    lacking = np.array([one.lacking for one, _ in modes])
    normals = np.array([by / one.speed for one, by in modes]).reshape(len(modes), slope.size)
    active = lacking > 0.0
    for _ in range(ACTIVE_SET_PASSES):
        rows, short = normals[active], lacking[active]
        step = np.linalg.solve(hessian + PENALTY * rows.T @ rows, slope - PENALTY * rows.T @ short)
        before, active = active, lacking + normals @ step > 0.0
        if np.array_equal(before, active):
            break
    step *= min(1.0, STEP_LIMIT / max(float(np.max(np.abs(step))), 1e-300))
    left = np.maximum(0.0, lacking + normals @ step)
    penalty = PENALTY * float(np.maximum(0.0, lacking) @ np.maximum(0.0, lacking) - left @ left)
    return np.asarray(step), max(float(2 * slope @ step - step @ hessian @ step) + penalty, 1e-12)
