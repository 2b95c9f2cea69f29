"""Deviation of coefficients from the form that a document gives them over speed, as the residuals of a fit show it.

χ² alone cannot see that an assumed form is wrong: the coefficients of one bearing make up for what those of another may not
do. So each free coefficient is given a deviation over speed beside its form, a Gaussian process of one common relative size τ
(Kennedy and O'Hagan, J. R. Stat. Soc. B 63 (2001) 425, doi:10.1111/1467-9868.00294). τ is estimated by restricted maximum
likelihood (Harville, J. Am. Stat. Assoc. 72 (1977) 320, doi:10.1080/01621459.1977.10480998): where the form is right it is
zero, and nothing changes. Where it is not, the covariance grows by what the deviations leave open; where it is large, the form
is refused.
"""

import numpy as np
from msgspec import Struct

from estimator.arrays import Floats
from estimator.bearings.deviation_shapes import DeviationShapes
from estimator.fit.optimisation.reweighting import with_fitted_noise
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.coefficient_deviations import CoefficientDeviations, Owners, direct_sizes
from estimator.fit.validation.doubted_force import DoubtedForce
from estimator.fit.validation.goodness_of_fit import Verdict

SIGNIFICANT = 4.0
"""Twice the logarithm of the likelihood ratio from which on a deviation is believed [-]: 1 in 44 where there is none."""
WELL_CONDITIONED = 1e5
"""Condition number up to which data show deviations that matter [-]."""
CONFIRMED_SIZE = 0.01
"""Relative size up to which deviations are neglected, where the data rule out larger ones [-]."""
EXPECTED_SIZE = 0.45
"""Largest relative size of deviations that is assumed where the data could show them in part [-]."""
MARGIN = 3.0
"""Factor on the largest size that the data do not rule out [-]: real films deviate alike, those looked for do not."""
EXPECTED_SIZE_UNSEEN = 0.8
"""Relative size of deviations that is assumed where other coefficients can compensate them at every speed [-]."""


class FormVerdict(Struct, frozen=True, eq=False):
    """Verdict on the forms that coefficients follow over speed.

    Attributes:
        covariance: Covariance (n, n) of the fit coordinates, with the deviations that must be reckoned with [-].
        words: Why the forms are refused; empty where they are not.
        remark: What is said of forms that are accepted, behind the verdict; empty where nothing is.
        forces: Static loads called exact for which the covariance has grown, their answers in fit coordinates.
        resting: What is said of those that nothing has checked, whatever the verdict.
        standing_in: Variance (n,) of each told value beside the covariance, as it may stand for what the document says wrongly
            [-]; None where none does.
    """

    covariance: Floats
    words: str = ""
    remark: str = ""
    forces: tuple[DoubtedForce, ...] = ()
    resting: str = ""
    standing_in: Floats | None = None

    def applied(self, verdict: Verdict) -> Verdict:
        """Return a verdict on a fit with this verdict on its form added.

        Args:
            verdict: The verdict on the fit.

        Returns:
            The verdict.
        """
        return verdict.refused(self.words) if self.words else verdict

    def reported_errors(self, covariance: Floats) -> Floats:
        """Compute the standard errors that are reported with the values of a fit.

        Derived here: variances of errors that do not depend on each other add.

        Args:
            covariance: Covariance (n, n) of the fit coordinates [-].

        Returns:
            Standard errors (n,) [-].
        """
        beside = 0.0 if self.standing_in is None else self.standing_in
        return np.asarray(np.sqrt(np.diag(covariance) + beside))


def judge_form(problem: FitProblem, found: FitResult, covariance: Floats, condition: float) -> FormVerdict:
    """Judge the forms of coefficients that follow the speed (Kennedy and O'Hagan 2001; Harville 1977).

    Where the data show deviations the forms are refused; beside films, whose own sharper deviations look like that, small ones
    widen the covariance. Where they cannot show them, because the problem is badly
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
    deviations = _deviations(problem, found)
    size, evidence = deviations.likeliest()
    if evidence > SIGNIFICANT and size <= CONFIRMED_SIZE and _with_own_deviations(problem):
        told = f"coefficients deviate by {100 * size:.2g} % over speed from the document's forms"
        remark = f"; {told}, beside oil films that deviate themselves: intervals are widened"
        return FormVerdict(deviations.widened(covariance, MARGIN * size), remark=remark)
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

    Then a deviation of one coefficient can be compensated by others, and only the form tells them apart. A model with
    parameters of another kind than values at speeds, such as factors on a table, does not leave its coefficients that freedom.
    """
    following = {
        k
        for one in problem.coordinates.models
        if any(parameter.coefficient is not None for parameter in one.model.parameters)
        for k in one.coefficients
    }
    return len(following) > 2 * len(problem.train.channels)


def _deviations(problem: FitProblem, found: FitResult) -> CoefficientDeviations:
    final = with_fitted_noise(problem, found)
    knots = [one.speed for one in final.coordinates.parameters if one.speed is not None]
    speeds = np.concatenate([final.measurement.speed, knots])
    shapes = DeviationShapes(float(speeds.min()), float(speeds.max()))
    at = _at_own_speed(final, found.theta, shapes)
    return CoefficientDeviations.of(final, found, shapes=shapes, owners=_owners(final), at=at)


def _owners(problem: FitProblem) -> Owners:
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


def _at_own_speed(problem: FitProblem, theta: Floats, shapes: DeviationShapes) -> Floats:
    """Return by how much each coordinate's coefficient deviates, at the speed whose value the coordinate is (n, D) [-]."""
    coordinates, names = problem.coordinates, [one.name for one in problem.train.unknowns.coefficients]
    owner, shape_count = _owners(problem), shapes.weight.shape[1]
    found = np.zeros((coordinates.size, (int(owner.max(initial=-1)) + 1) * shape_count))
    everywhere = shapes.at(problem.measurement.speed).mean(axis=0)
    sizes = direct_sizes(problem, coordinates.coefficients(theta))
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
