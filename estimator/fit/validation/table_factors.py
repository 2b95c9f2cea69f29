"""Factors on makers' tables: what they leave open where a table is off as a whole, or by more than its document allows.

A fit believes in each factor by itself (`scale_spread`). But a table of one calculation is often off as a whole, by the oil,
the clearance or the load that was assumed: believed in so, the mean of its factors would be known better than any of them,
though no data show it. So a factor common to the table is believed in besides, of the same spread, and the covariance grows by
what it leaves open. Where the factors that the data show are far larger than that, the spread of all is estimated from them
(empirical Bayes: Morris, J. Am. Stat. Assoc. 78 (1983) 47, doi:10.1080/01621459.1983.10477920), and the verdict says so.
"""

from collections.abc import Sequence

import numpy as np
import scipy
from msgspec import Struct
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.bearings.table import TableModel
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.form_discrepancy import SIGNIFICANT, FormVerdict
from estimator.machine.parameter_description import describe
from estimator.symmetric_eigen import symmetric_eigen

LARGEST_TIMES = 20.0
"""Largest spread of factors that is looked for, in spreads that are stated [-]."""


class _Table(Struct, frozen=True):
    """Factors on one table.

    Attributes:
        element: The element whose table it is, such as `bearing.B1`.
        places: Their coordinates.
        spread: How far each may be off, as the document says [-].
    """

    element: str
    places: tuple[int, ...]
    spread: float


def judge_table_factors(problem: FitProblem, found: FitResult, covariance: Floats) -> FormVerdict:
    """Judge the factors on makers' tables, and widen what rests on believing that they are small (Morris 1983).

    Source: Morris, J. Am. Stat. Assoc. 78 (1983) 47, doi:10.1080/01621459.1983.10477920.

    Args:
        problem: The fit's problem.
        found: The fit.
        covariance: Covariance (n, n) of the fit coordinates, with each factor believed in by itself [-].

    Returns:
        The verdict, which never refuses; with the covariance as it is where no table may be off.
    """
    coordinates = problem.coordinates
    tables = _tables(coordinates)
    if not tables:
        return FormVerdict(covariance)
    places = np.array([place for one in tables for place in one.places], dtype=np.intp)
    spread = np.array([one.spread for one in tables for _ in one.places])
    together = scipy.linalg.block_diag(*(np.ones((len(one.places), len(one.places))) for one in tables))
    times, evidence = _likeliest_times(problem, found, covariance, places, spread)
    far = evidence > SIGNIFICANT
    own = spread * (times if far else 1.0)
    prior = coordinates.prior
    precision = prior.precision.copy()
    precision[np.ix_(places, places)] = np.linalg.inv((np.eye(places.size) + together) * np.outer(own, own))
    wider = np.linalg.inv(found.information + precision)
    shift = wider @ (prior.pull(found.theta) - precision @ (found.theta - prior.centre))
    widened = (wider + wider.T) / 2 + np.outer(shift, shift)
    return FormVerdict(widened, remark=_words(tables, found.theta) if far else "")


def _tables(coordinates: Coordinates) -> tuple[_Table, ...]:
    """Return the factors on each table whose factors no calibration holds; tied elements have one in common."""
    found: dict[int, _Table] = {}
    for one in coordinates.models:
        free = not set(one.places) & set(coordinates.calibrated_places)
        if isinstance(one.model, TableModel) and one.model.parameters and free:
            element = describe(one.model.parameters[0].name).element
            found[one.first] = _Table(element, tuple(one.places), one.model.scale_spread)
    return tuple(found.values())


def _likeliest_times(
    problem: FitProblem, found: FitResult, covariance: Floats, places: NDArray[np.intp], spread: Floats
) -> tuple[float, float]:
    """Return the likeliest spread of factors, in those stated (k,), at least 1 [-], and its evidence against 1 [-].

    The evidence is twice the logarithm of the ratio of the likelihoods, of which all other coordinates were integrated out.
    """
    prior = problem.coordinates.prior
    posterior = np.linalg.inv(covariance[np.ix_(places, places)])
    information = (posterior - prior.precision[np.ix_(places, places)]) * np.outer(spread, spread)
    size, directions = symmetric_eigen((information + information.T) / 2)
    seen = np.maximum(size, 0.0)
    power = (directions.T @ (spread * (posterior @ (found.theta - prior.centre)[places]))) ** 2

    def ratio(logarithm: float) -> float:
        variance = np.exp(2.0 * logarithm)
        return float(np.sum(power * variance / (1.0 + variance * seen) - np.log1p(variance * seen)))

    best = scipy.optimize.minimize_scalar(lambda one: -ratio(one), bounds=(0.0, np.log(LARGEST_TIMES)), method="bounded")
    return float(np.exp(best.x)), -float(best.fun) - ratio(0.0)


def _words(tables: Sequence[_Table], theta: Floats) -> str:
    """State which table is off by the most, by how much, and what would be right."""

    def size(one: _Table) -> float:
        return float(np.sqrt(np.mean(theta[list(one.places)] ** 2)))

    worst = max(tables, key=lambda one: size(one) / one.spread)
    return (
        f"; the table of {worst.element} seems off by {100 * size(worst):.2g} %, more than its scale_spread of "
        f"{100 * worst.spread:.2g} % says: intervals are widened (state its coefficients, or its spread, as they are)"
    )
