"""Judgement of those terms of makers' tables that have no factors of their own: cross-coupled ones, and all of exact tables.

Cross-coupled terms go with the geometric mean of the factors on the direct terms beside them. Where a table's terms are off
each by itself, that is wrong, and a fit bends the factors and whatever else the data leave open. The score of a factor on each
such term shows it (Rao, Proc. Camb. Phil. Soc. 44 (1948) 50, doi:10.1017/S0305004100023987; `omitted_parameter`): a large one
refuses the fit, a smaller one widens its intervals. Where the factors show that a table is off by more than its document says
(`table_factors`), the smaller one refuses, too: such a table is wrong in more than factors. A table that is said to be exact
has no factors, and all its terms are judged so. Limits follow the number of terms, as of forces (`omitted_forces`).
"""

from collections.abc import Iterator

import numpy as np
from msgspec import Struct

from estimator.arrays import Floats
from estimator.bearings.table import TableModel
from estimator.fit.optimisation.reweighting import with_fitted_noise
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.form_discrepancy import FormVerdict
from estimator.fit.validation.omitted_forces import DOUBTFUL_CHANCE, largest_score
from estimator.fit.validation.omitted_parameter import OmittedParameter, omitted_parameter
from estimator.machine.parameter_description import describe

REFUSED_CHANCE = 0.001
"""Chance of scores so large where all terms are as stated beneath which a fit is refused [-]: 3.7 standard deviations for four
terms. Smaller than that of forces, as no document can state how far such a term may be off."""
LARGEST_ERROR = 1.0
"""Largest standard error of a change, as part of the term, for anything to be said of it [-]: no table is off by several times
its terms, and what such a change would mend is something else's."""


class _WantedFactor(Struct, frozen=True):
    """Term of a table without a factor of its own, and the part of it by which the residuals want it changed."""

    name: str
    exact: bool
    change: OmittedParameter

    @property
    def words(self) -> str:
        said, part = describe(self.name), 100 * self.change.value
        table, beside = ("exact table", "") if self.exact else ("table", " beside its factors")
        return (
            f"the data want {said.quantity} of the {table} of {said.element} to be off by {part:.2g} %{beside} "
            f"({abs(self.change.score):.2g} standard errors)"
        )


def judge_table_cross_terms(
    problem: FitProblem, found: FitResult, covariance: Floats, *, far: bool = False, inflation: float = 1.0
) -> FormVerdict:
    """Judge the terms of tables that have no factors of their own (Rao 1948, see `omitted_parameter`).

    Source: Rao, Proc. Camb. Phil. Soc. 44 (1948) 50, doi:10.1017/S0305004100023987.

    Args:
        problem: The fit's problem.
        found: The fit.
        covariance: Covariance (n, n) of the fit coordinates, as independent residuals have it [-].
        far: Whether the factors on the tables show that these are off by more than the document says.
        inflation: Factor on variances, as neighbouring residuals are alike [-].

    Returns:
        The verdict, in words on the term that the residuals contradict most; the covariance grows by what each doubtful one
        leaves open.
    """
    wanted = sorted(_wanted(problem, found, covariance, inflation), key=lambda one: -abs(one.change.score))
    if not wanted:
        return FormVerdict(covariance)
    limit = largest_score(DOUBTFUL_CHANCE, len(wanted))
    whole = covariance
    for one in wanted:
        if abs(one.change.score) > limit:
            whole = one.change.widened(whole)
    worst = wanted[0]
    if abs(worst.change.score) > largest_score(DOUBTFUL_CHANCE if far else REFUSED_CHANCE, len(wanted)):
        mend = "state the table's coefficients as they are" + (", or its scale_spread" if worst.exact else "")
        return FormVerdict(whole, f"{worst.words}: {mend}")
    remark = f"; {worst.words}: intervals are widened" if abs(worst.change.score) > limit else ""
    return FormVerdict(whole, remark=remark)


def _wanted(problem: FitProblem, found: FitResult, covariance: Floats, inflation: float) -> Iterator[_WantedFactor]:
    """Yield what the residuals ask of each term of a table that has no factor of its own."""
    tables = [one for one in problem.coordinates.models if isinstance(one.model, TableModel)]
    if not tables:
        return
    final = with_fitted_noise(problem, found)
    for placed in tables:
        values, exact = placed.values(found.theta), not placed.places
        for column, own in enumerate(placed.columns):
            name = placed.model.coefficients[own]
            term = describe(name).term
            if term is None or (term.direct and not exact) or not values[:, column].any():
                continue
            by_factor = np.zeros_like(values)
            by_factor[:, column] = values[:, column]
            change = omitted_parameter(final, found.theta, covariance, placed, by_factor, inflation=inflation)
            if change is not None and change.error < LARGEST_ERROR:
                yield _WantedFactor(name, exact, change)
