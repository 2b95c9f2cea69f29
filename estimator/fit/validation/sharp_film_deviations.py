"""Deviations of oil films that turn over speed more sharply than those which the document's discrepancy stands for.

A table of a film, or a film that changes its state, may be off by a few per cent here and not there. Such deviations cannot
follow the smooth ones that a fit has (`estimator.statics.film_deviations`); unbalances and clearances make up for them, and χ²
hardly shows it. They are sought as further Gaussian processes over speed, of a shorter correlation length (Kennedy and
O'Hagan, J. R. Stat. Soc. B 63 (2001) 425, doi:10.1111/1467-9868.00294): where the data show them, the covariance grows by
what they leave open; where they are larger than the document's discrepancy, the films' model is refused.
"""

import numpy as np

from estimator.arrays import Floats
from estimator.bearings.deviation_shapes import DeviationShapes
from estimator.bearings.journal import DEVIATING
from estimator.bearings.terms import LATERAL
from estimator.fit.optimisation.reweighting import with_fitted_noise
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.problem.placed_models import PlacedModel
from estimator.fit.validation.coefficient_deviations import CoefficientDeviations, Owners
from estimator.fit.validation.form_discrepancy import SIGNIFICANT, FormVerdict

LENGTHS = (0.2, 0.1)
"""Distances over which a sharp deviation stays alike, as parts of the speed range [-]: a half and a quarter of smooth."""

MARGIN = 2.0
"""Factor on the likeliest size by which intervals widen [-]: films off by one table deviate alike, those looked for do not."""


def judge_sharp_deviations(
    problem: FitProblem, found: FitResult, covariance: Floats, *, inflation: float = 1.0
) -> FormVerdict:
    """Judge whether films deviate sharply over speed (Kennedy and O'Hagan 2001; module's docstring).

    They are refused where the likeliest size is more than the document says, and far likelier than what it says.

    Args:
        problem: The fit's problem.
        found: The fit.
        covariance: Covariance (n, n) of the fit coordinates without such deviations, as independent residuals have it [-].
        inflation: Factor on variances, as neighbouring residuals are alike [-].

    Returns:
        The verdict, with the covariance as it is where there are none, or no films.
    """
    if not problem.coordinates.models:
        return FormVerdict(covariance)
    from estimator.statics.film_model import FilmModel  # films are loaded where a train has them

    placed = next((one for one in problem.coordinates.models if isinstance(one.model, FilmModel)), None)
    if placed is None or not isinstance(placed.model, FilmModel):
        return FormVerdict(covariance)
    stated = [one.discrepancy for one in placed.model.deviations.forms]
    if not any(stated):
        return FormVerdict(covariance)
    final, owners = with_fitted_noise(problem, found), _owners(problem, placed, stated)
    size, evidence, length, deviations = max(
        (_sought(final, found, owners, length, inflation) for length in LENGTHS), key=lambda one: one[1]
    )
    if evidence <= SIGNIFICANT:
        return FormVerdict(covariance)
    told = f"by about {100 * size:.2g} % from one {100 * length:.0f} % of the speed range to the next"
    whole = deviations.widened(covariance, MARGIN * size)
    if size > max(stated) and evidence - deviations.ratio(max(stated)) > SIGNIFICANT:
        words = f"oil films deviate from their model {told}: more than the document says (discrepancy)"
        return FormVerdict(whole, words)
    remark = f"; oil films deviate from their model more sharply over speed than it allows for, {told}: intervals are widened"
    return FormVerdict(whole, remark=remark)


def _sought(
    problem: FitProblem, found: FitResult, owners: Owners, length: float, inflation: float
) -> tuple[float, float, float, CoefficientDeviations]:
    """Return the likeliest size of deviations that are alike over a length, its evidence, the length, and the deviations."""
    speed = problem.measurement.speed
    shapes = DeviationShapes(float(speed.min()), float(speed.max()), length=length)
    nothing = np.zeros((found.theta.size, (int(owners.max()) + 1) * shapes.count))
    deviations = CoefficientDeviations.of(problem, found, shapes=shapes, owners=owners, at=nothing)
    deviations = deviations.inflated(inflation)
    return (*deviations.likeliest(), length, deviations)


def _owners(problem: FitProblem, placed: PlacedModel, stated: list[float]) -> Owners:
    """Return for each coefficient (K,) the number of its film's term, -1 where it has none: cyx deviates as cxy."""
    found = np.full(len(problem.train.unknowns.coefficients), -1, dtype=np.intp)
    deviating = [number for number, size in enumerate(stated) if size > 0.0]
    for k, column in zip(placed.coefficients, placed.columns, strict=True):
        film, term = column // len(LATERAL), LATERAL[column % len(LATERAL)].name
        if film in deviating:
            found[k] = deviating.index(film) * len(DEVIATING) + DEVIATING.index("cxy" if term == "cyx" else term)
    return found
