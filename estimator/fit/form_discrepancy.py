"""Deviation of coefficients from the form that a document gives them over speed, as the residuals of a fit show it.

χ² alone cannot see that an assumed form is wrong: the coefficients of one bearing make up for what those of another may not
do. So each free coefficient is given a deviation over speed beside its form, a Gaussian process of one common relative size τ
(Kennedy and O'Hagan, J. R. Stat. Soc. B 63 (2001) 425, doi:10.1111/1467-9868.00294). τ is estimated by restricted maximum
likelihood (Harville, J. Am. Stat. Assoc. 72 (1977) 320, doi:10.1080/01621459.1977.10480998): where the form is right it is
zero, and nothing changes. Where it is not, the covariance grows by what the deviations leave open; where it is large, the form
is refused.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from estimator.arrays import Floats
from estimator.bearings.deviation_shapes import DeviationShapes
from estimator.fit.goodness_of_fit import Verdict
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.reweighting import with_fitted_noise

SIGNIFICANT = 4.0
"""Twice the logarithm of the likelihood ratio from which on a deviation is believed [-]: 1 in 44 where there is none."""
RULED_OUT = 6.6
"""Twice the logarithm of the likelihood ratio by which a size is ruled out [-]."""
WELL_CONDITIONED = 1e5
"""Condition number up to which data show deviations that matter [-]."""
CONFIRMED_SIZE = 0.01
"""Relative size of deviations up to which they need not be reckoned with, where the data rule out larger ones [-]."""
EXPECTED_SIZE = 0.3
"""Largest relative size of deviations to reckon with where the data could show them in part [-]."""
MARGIN = 3.0
"""Factor on the largest size that the data do not rule out [-]: real films deviate alike, those looked for do not."""
EXPECTED_SIZE_UNSEEN = 0.8
"""Relative size of deviations to reckon with where other coefficients can make up for them at every speed [-]."""
LARGEST_SIZE = 1.0
"""Largest relative size of deviations that is looked for [-]."""


@dataclass(frozen=True, eq=False)
class FormVerdict:
    """Verdict on the forms that coefficients follow over speed.

    Attributes:
        covariance: Covariance (n, n) of the fit coordinates, with the deviations that must be reckoned with [-].
        words: Why the forms are refused; empty where they are not.
    """

    covariance: Floats
    words: str = ""

    def applied(self, verdict: Verdict) -> Verdict:
        """Return a verdict on a fit with this one.

        Args:
            verdict: The verdict on the fit.

        Returns:
            The verdict.
        """
        return verdict.refused(self.words) if self.words else verdict


def judge_form(problem: FitProblem, found: FitResult, covariance: Floats, condition: float) -> FormVerdict:
    """Judge the forms of coefficients that follow the speed (Kennedy and O'Hagan 2001; Harville 1977).

    Where the data show deviations the forms are refused. Where they cannot show them, because the problem is badly
    conditioned, deviations of a size that must be reckoned with widen the covariance; coefficients that the form alone
    determines become not estimable by that.

    Args:
        problem: The fit's problem.
        found: The fit.
        covariance: Covariance (n, n) of the fit coordinates without deviations [-].
        condition: Condition number of the information [-].

    Returns:
        The verdict.
    """
    deviations = _Deviations.of(problem, found, covariance)
    size, evidence = deviations.likeliest()
    if evidence > SIGNIFICANT:
        ratio = f"twice the logarithm of the likelihood ratio {evidence:.3g}; {SIGNIFICANT:g} at most is noise"
        words = (
            f"coefficients do not follow the speed as the document's forms say: they deviate by {100 * size:.2g} % ({ratio})"
        )
        return FormVerdict(covariance, words)
    largest = deviations.largest()
    if condition <= WELL_CONDITIONED or largest <= CONFIRMED_SIZE:
        return FormVerdict(covariance)
    expected = EXPECTED_SIZE_UNSEEN if _form_alone_decides(problem) else min(EXPECTED_SIZE, MARGIN * largest)
    return FormVerdict(deviations.widened(covariance, expected))


def _form_alone_decides(problem: FitProblem) -> bool:
    """Return whether more coefficients follow the speed than m channels give real numbers at one speed, 2m.

    Then others can make up for any deviation of one of them, and the form alone tells them apart. A model with parameters of
    another kind than values at speeds, such as factors on a table, does not leave its coefficients that freedom.
    """
    following = {
        k
        for one in problem.coordinates.models
        if any(parameter.coefficient is not None for parameter in one.model.parameters)
        for k in one.coefficients
    }
    return len(following) > 2 * len(problem.train.channels)


@dataclass(frozen=True, eq=False)
class _Deviations:
    """Deviations of D shapes in all, of unit size, in a fit of n coordinates.

    Attributes:
        curvature: Their information (D, D) after the coordinates were fitted anew [-].
        slope: ½ of the derivative of -χ² by them (D,) [-].
        answer: Change of the coordinates per unit of each (n, D) that leaves the data as they are [-].
        at: Deviation of each coordinate's own coefficient at its own speed (n, D) [-]; 0 for other coordinates.
    """

    curvature: Floats
    slope: Floats
    answer: Floats
    at: Floats

    @classmethod
    def of(cls, problem: FitProblem, found: FitResult, covariance: Floats) -> "_Deviations":
        final = with_fitted_noise(problem, found)
        knots = [one.speed for one in final.coordinates.parameters if one.speed is not None]
        speeds = np.concatenate([final.measurement.speed, knots])
        shapes = DeviationShapes(float(speeds.min()), float(speeds.max()))
        own, mixed, slope, gradient = _information(final, found.theta, shapes)
        coordinates = final.coordinates
        gradient -= coordinates.prior.pull(found.theta)
        answer = -covariance @ mixed
        curvature = own + mixed.T @ answer
        return cls(curvature, slope + answer.T @ gradient, answer, _at_own_speed(final, found.theta, shapes))

    def likeliest(self) -> tuple[float, float]:
        """Return the most likely size [-] and twice the logarithm of its likelihood ratio against none [-]."""
        sizes = self._sizes
        near = int(np.argmax(self._ratios))
        bounds = (sizes[max(0, near - 1)], sizes[min(sizes.size - 1, near + 1)])
        best = scipy.optimize.minimize_scalar(lambda one: -self._ratio(one), bounds=bounds, method="bounded")
        return float(np.exp(best.x)), -float(best.fun)

    def largest(self) -> float:
        """Return the largest size that the data do not rule out [-]."""
        ruled_out = self._ratios < max(0.0, float(self._ratios.max())) - RULED_OUT
        return float(np.exp(self._sizes[int(np.argmax(ruled_out))])) if ruled_out[-1] else LARGEST_SIZE

    def _ratio(self, log_size: float) -> float:
        """Compute twice the logarithm of the likelihood ratio of a size, given as its logarithm, against none."""
        information, power = self._spectrum
        variance = np.exp(2.0 * log_size)
        return float(np.sum(power * variance / (1.0 + variance * information) - np.log1p(variance * information)))

    @cached_property
    def _spectrum(self) -> tuple[Floats, Floats]:
        """Return the information (D,) of independent deviations and the squares (D,) of their slopes."""
        information, vectors = np.linalg.eigh(self.curvature)
        return np.maximum(information, 0.0), (vectors.T @ self.slope) ** 2

    @cached_property
    def _sizes(self) -> Floats:
        """Return logarithms of sizes, from one at which even the best determined deviation would not be seen."""
        highest = float(np.log(LARGEST_SIZE))
        lowest = -0.5 * float(np.log(max(float(self._spectrum[0].max(initial=0.0)), 1e-300))) - 2.0
        return np.linspace(min(lowest, highest - 1.0), highest, 100)

    @cached_property
    def _ratios(self) -> Floats:
        return np.array([self._ratio(one) for one in self._sizes])

    def widened(self, covariance: Floats, size: float) -> Floats:
        """Return the covariance (n, n) of the coordinates with deviations of some size, their most likely shift included."""
        open_part = np.linalg.inv(self.curvature + np.eye(self.slope.size) / size**2)
        moved = self.answer + self.at
        shift = moved @ (open_part @ self.slope)
        return np.asarray(covariance + moved @ open_part @ moved.T + np.outer(shift, shift))


def _information(problem: FitProblem, theta: Floats, shapes: DeviationShapes) -> tuple[Floats, Floats, Floats, Floats]:
    """Compute the information of unit deviations (D, D), that which they share with the coordinates (n, D), and ½ of the
    derivative of -χ² by them (D,) and by the coordinates (n,)."""
    coordinates = problem.coordinates
    weight = np.where(problem.used, problem.weight(np.abs(problem.model(theta)), 0.0), 0.0)
    owner = _owners(problem)
    sizes = _sizes(problem, coordinates.coefficients(theta))
    count = (int(owner.max(initial=-1)) + 1) * shapes.weight.shape[1]
    own, mixed, slope = np.zeros((count, count)), np.zeros((theta.size, count)), np.zeros(count)
    gradient = np.zeros(theta.size)
    for found in problem.linear_phasors(theta):
        block, by_coefficient = found.block, found.sensitivity.by_coefficient
        rows, residual = found.weighted(problem.measurement.phasor, weight)
        moved = np.zeros((count // shapes.weight.shape[1], *found.phasor.shape), dtype=complex)
        for k in np.flatnonzero(owner >= 0).tolist():
            moved[owner[k]] += by_coefficient[k] * sizes[k if sizes.ndim == 1 else (block, k)][..., None]
        moved *= coordinates.channels.gains(theta) * weight[block]
        shape = shapes.at(problem.measurement.speed[block])
        deviations = (moved[:, None] * shape.T[:, :, None]).reshape(count, -1).view(float)
        own += deviations @ deviations.T
        mixed += rows @ deviations.T
        slope += deviations @ residual
        gradient += rows @ residual
    return own, mixed, slope, gradient


def _owners(problem: FitProblem) -> "np.ndarray[tuple[int], np.dtype[np.intp]]":
    """Return for each coefficient the number of its deviation (K,).

    A tied one has its leader's; a fixed one has none (-1), nor one whose model has deviations of its own.
    """
    coefficients, deviating = problem.train.unknowns.coefficients, _with_own_deviations(problem)
    free = [one.name for k, one in enumerate(coefficients) if not one.fixed and one.tied_to is None and k not in deviating]
    names = [one.tied_to or one.name for one in coefficients]
    return np.array(
        [-1 if one.fixed or name not in free else free.index(name) for one, name in zip(coefficients, names, strict=True)],
        dtype=np.intp,
    )


def _with_own_deviations(problem: FitProblem) -> frozenset[int]:
    """Return the coefficients whose models have parameters that stand for deviations."""
    return frozenset(
        k
        for one in problem.coordinates.models
        if any(parameter.nuisance for parameter in one.model.parameters)
        for k in one.coefficients
    )


def needs_form(problem: FitProblem) -> bool:
    """Return whether a coefficient follows the speed in a form that the document assumes, with no deviations of its own.

    Args:
        problem: The fit's problem.

    Returns:
        Whether one does.
    """
    following = {k for one in problem.coordinates.models for k in one.coefficients}
    return bool(following - _with_own_deviations(problem))


def _sizes(problem: FitProblem, values: Floats) -> Floats:
    """Return what a deviation of each coefficient is a part of, (K,) or (S, K): itself, or the direct terms beside it [SI]."""
    coefficients = problem.train.unknowns.coefficients
    index = {one.name: k for k, one in enumerate(coefficients)}
    beside = [[index[f"{one.element}.{name}"] for name in one.term.beside] for one in coefficients]
    first, second = (values[..., [pair[side] for pair in beside]] for side in (0, 1))
    return np.asarray(np.sqrt(np.abs(first * second)))


def _at_own_speed(problem: FitProblem, theta: Floats, shapes: DeviationShapes) -> Floats:
    """Return by how much each coordinate's coefficient deviates, at the speed whose value the coordinate is (n, D) [-]."""
    coordinates, names = problem.coordinates, [one.name for one in problem.train.unknowns.coefficients]
    owner, shape_count = _owners(problem), shapes.weight.shape[1]
    found = np.zeros((coordinates.size, (int(owner.max(initial=-1)) + 1) * shape_count))
    everywhere = shapes.at(problem.measurement.speed).mean(axis=0)
    sizes = _sizes(problem, coordinates.coefficients(theta))
    for place, one in enumerate(coordinates.parameters):
        if one.coefficient is None:
            continue
        k = names.index(one.coefficient)
        own = everywhere if one.speed is None else shapes.at(np.array([one.speed]))[0]
        part = 1.0
        if not one.positive:
            size = sizes[k] if sizes.ndim == 1 else np.interp(one.speed or 0.0, *_ascending(problem, sizes[:, k]))
            part = float(size) / one.step
        found[place, owner[k] * shape_count : (owner[k] + 1) * shape_count] = part * own
    return found


def _ascending(problem: FitProblem, values: Floats) -> tuple[Floats, Floats]:
    order = np.argsort(problem.measurement.speed)
    return problem.measurement.speed[order], values[order]
