"""Judgement of static loads on the shafts that the document calls exact: whether the films want other ones.

A process force that is stated wrongly loads the films otherwise than they are; a fit bends clearances, elevations and
viscosities until the data are met. The score of each component shows it (`omitted_parameter`): a large one refuses the fit,
a smaller one widens its intervals.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from estimator.arrays import Floats
from estimator.fit.form_discrepancy import FormVerdict
from estimator.fit.omitted_parameter import OmittedParameter, omitted_parameter
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.reweighting import with_fitted_noise

LARGEST_SCORE = 2.6
"""Score in standard deviations from which on a fit is refused [-]: 1 of 100 is larger where the force is as stated, and to
state how far it may be off mends that."""
DOUBTFUL_SCORE = 1.6
"""Score from which on intervals are widened [-]: 1 of 10 is larger."""


@dataclass(frozen=True)
class _WantedForce:
    """Component of a static load: its name, its value in the document [N], and the change that the residuals ask for."""

    name: str
    stated: float
    change: OmittedParameter

    @property
    def words(self) -> str:
        return (
            f"the oil films want {self.name} to be about {self.stated + self.change.value:.3g} N, where the document says "
            f"{self.stated:.3g} N exactly ({abs(self.change.score):.2g} standard errors): state how far it may be off "
            f"({self.name.rpartition('.')[2]}_spread)"
        )


def judge_exact_forces(problem: FitProblem, found: FitResult, covariance: Floats) -> FormVerdict:
    """Judge the components of static loads that the document calls exact (Rao 1948, see `omitted_parameter`).

    Args:
        problem: The fit's problem.
        found: The fit.
        covariance: Covariance (n, n) of the fit coordinates with these forces [-].

    Returns:
        The verdict, on the one that the residuals contradict most.
    """
    if not problem.coordinates.models:
        return FormVerdict(covariance)
    worst = max(_wanted(problem, found, covariance), key=lambda one: abs(one.change.score), default=None)
    if worst is None or abs(worst.change.score) <= DOUBTFUL_SCORE:
        return FormVerdict(covariance)
    if abs(worst.change.score) > LARGEST_SCORE:
        return FormVerdict(covariance, worst.words)
    return FormVerdict(worst.change.widened(covariance), remark=f"; {worst.words}; intervals are widened")


def _wanted(problem: FitProblem, found: FitResult, covariance: Floats) -> Iterator[_WantedForce]:
    """Yield what the residuals ask of each component that is called exact."""
    from estimator.statics.film_curves import FilmCurves  # films are loaded where coefficients follow the speed
    from estimator.statics.film_model import FilmModel

    for placed in problem.coordinates.models:
        if not isinstance(placed.model, FilmModel) or not isinstance(placed.curves, FilmCurves):
            continue
        exact = placed.model.own.exact_forces
        if not exact:
            continue
        final, by_load = with_fitted_noise(problem, found), placed.curves.by_load(placed.own(found.theta))
        for name, stated, place in exact:
            change = omitted_parameter(final, found.theta, covariance, placed, by_load[..., place])
            if change is not None:
                yield _WantedForce(name, stated, change)
