"""Fits on oil films after bearings have moved far: from where films make up for that, on to where the bearings stand.

A fit starts from the machine's last identification. After a shaft has sunk by several times what is allowed, films may deviate
to make up for it before the elevations have followed, and the fit ends there: χ² is as noise explains it, and films deviate
absurdly. So such a fit goes on, from its end with the deviations held near none (continuation: Allgower and Georg,
Introduction to Numerical Continuation Methods, 2003, doi:10.1137/1.9780898719154), and from starts with the couplings off.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.fit.optimisation.maximum_likelihood import STAGE_MISFITS, fit
from estimator.fit.optimisation.multistart import HELD_FACTOR
from estimator.fit.optimisation.nuisance_parameters import deviates_too_far
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.fit_problem import FitProblem, FitResult, best_excitations
from estimator.fit.problem.narrowed_prior import narrowed
from estimator.fit.validation.goodness_of_fit import judge
from estimator.machine.document import Machine

PARTS = (-0.75, -0.5, -0.25, 0.25, 0.5, 0.75)
"""Offsets and angles that are tried, in standard deviations of what is believed of them [-]."""


def moved_far(problem: FitProblem, found: FitResult, beginning: Floats | None) -> FitResult:
    """Fit again where films deviate too far (module's docstring), and take the best of all.

    Source: own derivation: of several optima of one posterior the highest is taken.

    Args:
        problem: The problem.
        found: Its fit.
        beginning: Coordinates θ (n,) of the machine's last identification [-]; None where there is none.

    Returns:
        The best fit; the one as it was where nothing is better, or no film deviates.
    """
    if problem.train.machine is None or not problem.coordinates.nuisance.any():
        return found
    fresh = replace(problem, outlier=np.zeros_like(problem.outlier))
    found = _better(fresh, [_with_deviations_held(fresh, found.theta)], found)
    if not deviates_too_far(problem, found):
        return found
    return _better(fresh, _misaligned(fresh, problem.train.machine, found.theta if beginning is None else beginning), found)


def _better(problem: FitProblem, starts: Sequence[Floats], found: FitResult) -> FitResult:
    """Return the best of a fit and those from some starts: one that is accepted, else the most probable."""
    again = [fit(problem, start, near=True) for start in starts]

    def rank(one: FitResult) -> tuple[bool, float]:
        refused = not judge(problem, one).accepted or deviates_too_far(problem, one)
        return refused, one.misfit + problem.coordinates.prior.cost(one.theta)

    return min([found, *(one for one in again if one.converged and np.isfinite(one.misfit))], key=rank)


def _with_deviations_held(problem: FitProblem, theta: Floats) -> Floats:
    """Return where a fit ends whose films hardly deviate."""
    held = narrowed(problem.coordinates, HELD_FACTOR, problem.coordinates.nuisance)
    return fit(replace(problem, coordinates=held), theta, near=True, passes=1).theta


def _misaligned(problem: FitProblem, machine: Machine, theta: Floats) -> list[Floats]:
    """Return the start with one coupling off whose misfit is least, of offsets and angles in either plane; none if none is."""
    weight = problem.weight(problem.first_amplitude, STAGE_MISFITS[0])
    starts = [best_excitations(problem, one, weight) for one in _off(problem.coordinates, machine, theta)]
    misfits = [problem.chi_square(one, weight) for one in starts]
    finite = [(misfit, place) for place, misfit in enumerate(misfits) if np.isfinite(misfit)]
    return [starts[min(finite)[1]]] if finite else []


def _off(coordinates: Coordinates, machine: Machine, theta: Floats) -> Iterator[Floats]:
    """Yield θ (n,) with one offset or angle changed, by parts of what is believed of it."""
    from estimator.statics.alignment import alignment_motions  # films are loaded where there are any

    for axis in ("x", "y"):
        names = [f"bearing.{one.id}.elevation_{axis}" for one in machine.bearings]
        if not set(names) <= set(coordinates.names):
            continue
        places = [coordinates.names.index(name) for name in names]
        for motion in alignment_motions(machine).values():
            along = motion / coordinates.unit[places]
            # What is believed of an offset e = rᵀz with motion m, rᵀm = 1: at least 1 over the norm of m in spreads.
            believed = 1.0 / float(np.linalg.norm(along / coordinates.spread[places]))
            for part in PARTS:
                moved = theta.copy()
                moved[places] += part * believed * along
                yield moved
