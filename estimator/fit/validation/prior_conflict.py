"""Conflict between a fit of a train on oil films and what its document says of clearances, oils, pedestals and couplings.

Each number is held by what the document says that it may be off. Where a document is wrong in many at once, such as an oil of
the next grade, diametral clearances written as radial ones or pedestals that are damped far less, χ² hardly shows it: each is
pulled a part of the way back, and what else the fit determines is bent by that. Parameters of one kind are therefore compared
with the predictions of their prior (Box, J. R. Stat. Soc. A 143 (1980) 383, doi:10.2307/2982063): each for itself, and what
they have in common, as one wrong oil has. Where chance hardly explains how far they are from it, that is told, and the
covariance grows by what a prior off by as much does to the estimates: in fit coordinates C P^½ times how far it is off, with C
the fit's covariance and P the prior's precision. Only directions count of which the data say something. Elevations are left
out: they move.

A viscosity that contradicts its document is either the oil's, or stands for a length that is written wrongly: a short film
carries by viscosity times length cubed (Ocvirk, NACA TN 2808, 1952). A clearance is either the bearing's, or stands for a
preload: what a film of pads or lobes shows is (1 - preload) times it. Data cannot tell these two, so each has half the
probability, and the value that is told has the variance of both together beside its own. What the film does is the same.
"""

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.fit.optimisation.prior_check import PriorCheck, prior_check
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.form_discrepancy import FormVerdict
from estimator.machine.parameter_description import describe

UNLIKELY = 2e-3
"""Chance of parameters of one kind as far from what the document says, beneath which that is told [-]."""
KINDS = {
    ("film", "clearance"): "radial clearances",
    ("film", "viscosity"): "viscosities",
    ("film", "viscosity ratio"): "ratios of viscosities",
    ("film", "slope"): "falls of the viscosity with speed",
    ("pedestal", "stiffness"): "stiffnesses of pedestals",
    ("pedestal", "damping"): "dampings of pedestals",
    ("pedestal", "inertia"): "masses of pedestals",
    ("coupling", "stiffness"): "stiffnesses of couplings",
    ("coupling", "damping"): "dampings of couplings",
}
"""Kinds of parameters that are judged together, in words, by whose they are and their physical quantity."""
ASKED = {
    "radial clearances": "are the clearances radial ones, and is the bearings' geometry right?",
    "viscosities": "are the oil, its temperature and the bearings' geometry right?",
}
"""Questions to a kind that contradicts its document."""
STANDING_IN = ("radial clearances", "viscosities")
"""Kinds that may stand for geometry which the document gives wrongly."""


class _Conflict(Struct, frozen=True, eq=False):
    """Parameters of one kind that are further from their prior than chance explains.

    Attributes:
        kind: The kind, in words.
        places: Their coordinates (k,).
        away: How far each (k,) is from its prior's centre, in the prior's standard deviations [-].
        check: The comparison.
    """

    kind: str
    places: NDArray[np.intp]
    away: Floats
    check: PriorCheck


def judge_priors(problem: FitProblem, found: FitResult, covariance: Floats) -> FormVerdict:
    """Judge whether a fit is where the document says that it should be (Box 1980; module's docstring).

    Args:
        problem: The fit's problem.
        found: The fit.
        covariance: Covariance (n, n) of the fit coordinates [-].

    Returns:
        The verdict, with the covariance as it is where there is no conflict, or no films.
    """
    coordinates = problem.coordinates
    whole, remark, standing_in = covariance, "", np.zeros(len(found.theta))
    for one in _conflicts(coordinates, found.theta, covariance):
        answer = covariance[:, one.places] / coordinates.spread[one.places] @ one.check.directions
        whole = whole + one.check.misplaced**2 * answer @ answer.T
        remark += f"; {_words(one, coordinates, found.theta)}"
        if one.kind in STANDING_IN:
            standing_in[one.places] = 0.5 * (one.away * coordinates.spread[one.places]) ** 2
    return FormVerdict(whole, remark=remark, standing_in=standing_in if standing_in.any() else None)


def _conflicts(coordinates: Coordinates, theta: Floats, covariance: Floats) -> list[_Conflict]:
    found = []
    for kind, places in _kinds(coordinates).items():
        spread = coordinates.spread[places]
        away = (theta[places] - coordinates.centre[places]) / spread
        left = covariance[np.ix_(places, places)] / np.outer(spread, spread)
        check, count = prior_check(away, left), len(places)
        in_common = prior_check(away.sum(keepdims=True) / np.sqrt(count), left.sum(keepdims=True) / count)
        if min(check.chance, in_common.chance) < UNLIKELY:
            found.append(_Conflict(kind, places, away, check))
    return found


def _kinds(coordinates: Coordinates) -> dict[str, NDArray[np.intp]]:
    """Return the places of the coordinates that are judged together, by what they are in words; none without films."""
    if not coordinates.nuisance.any():
        return {}
    places: dict[str, list[int]] = {}
    for place, name in enumerate(coordinates.names):
        said = describe(name)
        whose = said.element_kind if said.element_kind in ("pedestal", "coupling") else "film"
        kind = KINDS.get((whose, said.physical_quantity or ""))
        if kind is not None and not coordinates.nuisance[place] and place not in coordinates.calibrated_places:
            places.setdefault(kind, []).append(place)
    return {kind: np.array(listed, dtype=np.intp) for kind, listed in places.items()}


def _words(one: _Conflict, coordinates: Coordinates, theta: Floats) -> str:
    """Describe a conflict by the parameter that is furthest from what the document says."""
    worst = int(np.argmax(np.abs(one.away)))
    place = one.places[worst]
    size = f"{abs(one.away[worst]):.1f} times as far as it may be off"
    if describe(coordinates.names[place]).positive:
        size = f"{np.exp(theta[place] - coordinates.centre[place]):.2g} times what it says, {size}"
    words = f"{one.kind} contradict the document, {coordinates.names[place]} most ({size}): intervals are widened"
    return "; ".join((words, *([ASKED[one.kind]] if one.kind in ASKED else [])))
