"""Judgement of static loads on the shafts that the document calls exact: whether the films want other ones.

A process force that is stated wrongly loads the films otherwise than they are; a fit bends clearances, elevations and
viscosities until the data are met. The score of each component shows it (Rao, Proc. Camb. Phil. Soc. 44 (1948) 50,
doi:10.1017/S0305004100023987; `omitted_parameter`): a large one refuses the fit, a smaller one widens its intervals.
The limits follow the number of components, so that their chances are those of all together. A force that the films hardly see
may be off by much without any of this: then the verdict says what the bearings' loads rest on, and how far that was checked.
"""

import math
from collections.abc import Iterator

import numpy as np
import scipy
from msgspec import Struct

from estimator.arrays import Floats
from estimator.fit.optimisation.reweighting import with_fitted_noise
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.doubted_force import DoubtedForce
from estimator.fit.validation.form_discrepancy import FormVerdict
from estimator.fit.validation.omitted_parameter import OmittedParameter, omitted_parameter
from estimator.machine.parameter_description import describe

REFUSED_CHANCE = 0.01
"""Chance of scores so large where all forces are as stated beneath which a fit is refused [-]: 2.6 standard deviations for one
component; to state how far it may be off mends that."""
DOUBTFUL_CHANCE = 0.1
"""Chance beneath which intervals are widened [-]: 1.6 standard deviations for one component."""
CHECKED_PART = 0.1
"""Part of a force by which it may be off unseen and still counts as checked by the films [-]."""


class _WantedForce(Struct, frozen=True):
    """Component of a static load: its name, its value in the document [N], and the change that the residuals ask for."""

    name: str
    stated: float
    change: OmittedParameter

    @property
    def words(self) -> str:
        return (
            f"the oil films want {self.name} to be about {self.stated + self.change.value:.3g} N, where the document says "
            f"{self.stated:.3g} N exactly ({abs(self.change.score):.2g} standard errors): state how far it may be off "
            f"({describe(self.name).quantity}_spread)"
        )

    def resting_words(self, limit: float) -> str:
        """Return the words on a force of whose size the films show too little; empty where it is none, or they show it.

        limit: Score up to which it is not doubted [-].
        """
        unseen = limit * self.change.error
        if self.stated == 0.0 or unseen <= CHECKED_PART * abs(self.stated):
            return ""
        off = "any error in it" if math.isinf(unseen) else f"an error of {unseen:.3g} N in it"
        return f"; loads of bearings rest on {self.name} being {self.stated:.3g} N: the films would not show {off}"


def judge_exact_forces(problem: FitProblem, found: FitResult, covariance: Floats, *, inflation: float = 1.0) -> FormVerdict:
    """Judge the components of static loads that the document calls exact (Rao 1948, see `omitted_parameter`).

    The chance of a large score is shared among the components that are looked at (Bonferroni).

    Args:
        problem: The fit's problem.
        found: The fit.
        covariance: Covariance (n, n) of the fit coordinates with these forces, as independent residuals have it [-].
        inflation: Factor on variances, as neighbouring residuals are alike [-].

    Returns:
        The verdict, in words on the component that the residuals contradict most; the covariance grows by what each doubtful
        one leaves open. Others of whose size the films show too little are said to be what loads rest on.
    """
    if not problem.coordinates.models:
        return FormVerdict(covariance)
    wanted = sorted(_wanted(problem, found, covariance, inflation), key=lambda one: -abs(one.change.score))
    if not wanted:
        return FormVerdict(covariance)
    seen = sum(math.isfinite(one.change.error) for one in wanted) or 1
    limit = largest_score(DOUBTFUL_CHANCE, seen)
    doubtful = [one for one in wanted if abs(one.change.score) > limit]
    resting = "".join(one.resting_words(limit) for one in wanted[len(doubtful) :])
    if not doubtful:
        return FormVerdict(covariance, resting=resting)
    whole = covariance
    for one in doubtful:
        whole = one.change.widened(whole)
    forces = tuple(DoubtedForce(one.name, math.sqrt(one.change.variance), one.change.answer) for one in doubtful)
    if abs(doubtful[0].change.score) > largest_score(REFUSED_CHANCE, seen):
        return FormVerdict(whole, doubtful[0].words, forces=forces, resting=resting)
    remark = f"; {'; '.join(one.words for one in doubtful)}; intervals are widened"
    return FormVerdict(whole, remark=remark, forces=forces, resting=resting)


def largest_score(chance: float, count: int) -> float:
    """Return the limit that the largest of some scores exceeds with a given probability at most.

    Source: Bonferroni's inequality; score test of Rao, Math. Proc. Camb. Phil. Soc. 44 (1948) 50,
    doi:10.1017/S0305004100023987.

    Args:
        chance: The chance [-].
        count: Number of the scores.

    Returns:
        The size, in standard deviations [-].
    """
    return -float(scipy.special.ndtri(chance / 2.0 / count))


def _wanted(problem: FitProblem, found: FitResult, covariance: Floats, inflation: float) -> Iterator[_WantedForce]:
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
            change = omitted_parameter(final, found.theta, covariance, placed, by_load[..., place], inflation=inflation)
            yield _WantedForce(name, stated, change or OmittedParameter(0.0, math.inf, np.zeros(found.theta.size)))
