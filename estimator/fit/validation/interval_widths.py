"""Widths of a fit's intervals: what residuals, forms over speed and deviations of films add to its own covariance."""

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.fit.optimisation.nuisance_parameters import excessive_deviations
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.form_discrepancy import FormVerdict, judge_form, needs_form
from estimator.fit.validation.goodness_of_fit import VerdictRemark, remark
from estimator.fit.validation.omitted_forces import judge_exact_forces
from estimator.fit.validation.omitted_warming import viscosity_trend, warming_words
from estimator.fit.validation.prior_conflict import judge_priors
from estimator.fit.validation.sharp_film_deviations import judge_sharp_deviations
from estimator.fit.validation.table_cross_terms import judge_table_cross_terms
from estimator.fit.validation.table_factors import judge_table_factors
from estimator.symmetric_eigen import condition_number


class IntervalWidths(Struct, frozen=True, eq=False):
    """Covariance of a fit of n coordinates as it is told.

    Attributes:
        own: Covariance (n, n) of the Gaussian approximation alone [-].
        covariance: Covariance (n, n) with all that widens it [-].
        condition: Condition number of the information [-].
        inflation: Factor by which residuals that are alike widen it [-].
        form: Verdict on the forms over speed, and what it adds.
        words: What is said of residuals, behind the verdict.
        without_forms: Covariance (n, n) without what possible deviations from assumed forms leave open [-].
    """

    own: Floats
    covariance: Floats
    condition: float
    inflation: float
    form: FormVerdict
    without_forms: Floats
    words: str = ""

    @property
    def besides(self) -> Floats:
        """Return what is added to the covariance (n, n), widened as residuals ask for [-]."""
        return self.covariance - self.inflation * self.own

    def of_first(self, size: int, *, covariance: Floats) -> "IntervalWidths":
        """Return the widths of the first coordinates, beside which others were free.

        Args:
            size: Their number.
            covariance: Their covariance (size, size) as it is told [-].

        Returns:
            The widths.
        """
        form, standing_in = self.form, self.form.standing_in
        return replace(
            self,
            own=self.own[:size, :size],
            covariance=covariance,
            form=replace(
                form,
                covariance=form.covariance[:size, :size],
                forces=tuple(replace(one, answer=one.answer[:size]) for one in form.forces),
                standing_in=None if standing_in is None else standing_in[:size],
            ),
            without_forms=self.without_forms[:size, :size],
        )


def plain_widths(problem: FitProblem, found: FitResult) -> IntervalWidths:
    """Compute the covariance of a fit without anything that widens it, as a refused one's is told.

    Source: Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 3.4 (Gaussian approximation at the
    maximum).

    Args:
        problem: The problem.
        found: The fit.

    Returns:
        The widths.
    """
    covariance, condition = _covariance(problem, found)
    return IntervalWidths(covariance, covariance, condition, 1.0, FormVerdict(covariance), covariance)


def interval_widths(problem: FitProblem, found: FitResult) -> IntervalWidths:
    """Compute the covariance of an accepted fit, as wide as neighbouring residuals and all deviations ask for.

    Source: Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 3.4; derived here: each deviation adds
    what it alone leaves open.

    Args:
        problem: The problem.
        found: The fit.

    Returns:
        The widths.
    """
    covariance, condition = _covariance(problem, found)
    beside = remark(problem, found)
    of_tables = judge_table_factors(problem, found, covariance)
    form = _form_verdict(problem, found, covariance, condition, beside, of_tables)
    return IntervalWidths(
        own=covariance,
        covariance=form.covariance if beside.left_open is None else form.covariance + beside.left_open,
        condition=condition,
        inflation=beside.inflation,
        form=form,
        without_forms=of_tables.covariance,
        words=beside.words,
    )


def _form_verdict(
    problem: FitProblem,
    found: FitResult,
    covariance: Floats,
    condition: float,
    beside: VerdictRemark,
    of_tables: FormVerdict,
) -> FormVerdict:
    """Return the verdict on how coefficients follow the speed: by assumed forms, and by films with their deviations."""
    inflation = beside.inflation
    trend = viscosity_trend(problem, found, covariance, inflation=inflation)
    excess = excessive_deviations(problem, found, covariance) or warming_words(trend)
    whole, words, remarks = inflation * covariance, excess, ""
    of_forces = judge_exact_forces(problem, found, covariance, inflation=inflation)
    if excess:  # what films cannot explain is no force's: scores say nothing then
        return FormVerdict(whole, words, remarks, resting=of_forces.resting)
    far = bool(of_tables.remark)
    of_cross_terms = judge_table_cross_terms(problem, found, covariance, far=far, inflation=inflation)
    of_sharpness = judge_sharp_deviations(problem, found, covariance, inflation=inflation)
    of_priors = judge_priors(problem, found, covariance)
    judged = [of_forces, of_sharpness, of_tables, of_cross_terms, of_priors]
    if needs_form(problem):
        of_form = judge_form(problem, found, covariance, condition)
        judged.append(replace(of_form, covariance=covariance + inflation * (of_form.covariance - covariance)))
    for one in judged:
        # Each is what one deviation alone leaves open.
        whole, words, remarks = whole + (one.covariance - covariance), words or one.words, remarks + one.remark
    return FormVerdict(whole, words, remarks, of_forces.forces, of_forces.resting, of_priors.standing_in)


def _covariance(problem: FitProblem, found: FitResult) -> tuple[Floats, float]:
    """Return the covariance (n, n) of the fit coordinates [-], and the condition number of the information."""
    information = found.information + problem.coordinates.prior.precision
    covariance, size = np.linalg.inv(information), np.sqrt(np.diag(information))
    return (covariance + covariance.T) / 2, condition_number(information / np.outer(size, size))
