"""Fits that only the errors of one measuring chain explain: refused ones, done again with its gain and run-out.

A probe whose run-out has changed, or whose gain is far off, moves what a fit without that error finds: films deviate and
phasors are left out until little of it shows in the channel itself. So a refused fit is done again with the errors of the
channel that explains most of what it leaves over, from the machine's last identification and from the fit's own end. Where
that is accepted, what the data say of the machine and of its channels is taken from there (Gaussian approximation of the
likelihood at its maximum; Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 3.4). The fit itself
stays refused: its document takes the channel as exact.
"""

from collections.abc import Iterator, Sequence
from operator import itemgetter

import numpy as np
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.fit.explained_fit import ExplainedFit, own_covariance
from estimator.fit.open_gains import CLEAR_FALL
from estimator.fit.optimisation.maximum_likelihood import HOPELESS_MISFIT, STAGE_MISFITS, fit
from estimator.fit.optimisation.nuisance_parameters import deviates_too_far
from estimator.fit.problem.channel_errors import with_channel_errors
from estimator.fit.problem.fit_problem import FitProblem, FitResult, best_excitations
from estimator.fit.problem.linear_phasors import PhasorMemory
from estimator.fit.validation.channel_sensitivity import channel_effects
from estimator.fit.validation.goodness_of_fit import judge, remark
from estimator.rotor.elimination import SingularCondensation

SUSPECTS = 2
"""Number of channels whose errors are tried, those that explain most [-]: both probes of a bearing often do."""
FEWEST_FREEDOM = 20
"""Fewest degrees of freedom beside which errors explain a run [-]: fewer numbers are explained by anything."""
SPREAD = {"gain": 0.5, "run_out": 1e-4}
"""Standard deviations of each part of a gain and of a run-out that are free [-, m]: hardly anything is believed of them."""


def fit_with_channel_errors(
    problem: FitProblem, refused: FitResult, beginning: Floats | None, suspects: Sequence[int]
) -> ExplainedFit | None:
    """Fit a refused problem again with the gain and the run-out of one channel (module's docstring).

    Source: Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 3.4.

    Args:
        problem: The problem.
        refused: Its fit.
        beginning: Coordinates θ (n,) of the machine's last identification [-]; None where there is none.
        suspects: Places of the channels that may explain it, that which explains most first.

    Returns:
        What the fit with the errors that explain most says; None where none is accepted, or coefficients are calibrated.
    """
    if problem.coordinates.calibrated is not None:
        return None
    starts = [refused.theta] if beginning is None else [beginning, refused.theta]
    found = []
    for channel in suspects[:SUSPECTS]:
        accepted = next(_accepted(problem, channel, starts), None)
        if accepted is not None:
            found.append((accepted[1].misfit, channel, *accepted))
    if not found:
        return None
    _, channel, whole, best = min(found, key=itemgetter(0))
    explained = _explained(problem, whole, best, problem.train.channels[channel])
    # One that is accepted with errors that say little has only begun elsewhere.
    return explained if explained.refused_chi_square - best.chi_square >= CLEAR_FALL else None


def _accepted(problem: FitProblem, channel: int, starts: list[Floats]) -> Iterator[tuple[FitProblem, FitResult]]:
    """Yield the fits with a channel's errors that are accepted, with their problem."""
    errors = [(quantity, channel) for quantity in SPREAD]
    coordinates = with_channel_errors(problem.coordinates, problem.train.channels, errors, spread=SPREAD)
    whole = replace(problem, coordinates=coordinates, outlier=np.zeros_like(problem.outlier), _memory=PhasorMemory())
    hopeless = np.inf if whole.noise.estimated else HOPELESS_MISFIT
    for start in starts:
        theta = np.concatenate([start, np.zeros(coordinates.size - start.size)])
        try:
            if not np.isfinite(whole.model(theta)).all():  # where a film is too thin
                continue
            theta = best_excitations(
                whole, _with_errors_found(whole, theta, channel), whole.weight(whole.first_amplitude, STAGE_MISFITS[0])
            )
            found = fit(whole, theta, near=True, give_up_from=hopeless)
        except SingularCondensation:
            continue
        # One given up has neither its last weights nor its outliers: its χ² says nothing.
        if not np.isfinite(found.misfit) or deviates_too_far(whole, found):
            continue
        verdict = judge(whole, found)
        if verdict.accepted and verdict.degrees_of_freedom >= FEWEST_FREEDOM:
            yield whole, found


def _with_errors_found(problem: FitProblem, theta: Floats, channel: int) -> Floats:
    """Return θ (n,) with the errors of a channel that explain its phasors best while everything else stays: a linear problem.

    Else the phasors of a channel whose errors are large would be left out at once.
    """
    channels, usable = problem.coordinates.channels, problem.measurement.usable[:, channel]
    places = [first + part for first in (channels.gain[channel], channels.run_out[channel]) for part in range(2)]
    free = theta.copy()
    free[places] = 0.0
    residual = problem.measurement.phasor - problem.model(free)
    slopes = []
    for place in places:
        one = free.copy()
        one[place] = 1.0
        slopes.append((problem.model(one) - problem.model(free))[usable, channel].view(float))
    free[places] = np.linalg.lstsq(np.stack(slopes, axis=1), residual[usable, channel].copy().view(float))[0]
    return free


def _explained(problem: FitProblem, whole: FitProblem, found: FitResult, name: str) -> ExplainedFit:
    """Return what a fit with errors of a channel says, these counted among the errors that the refused fit left out."""
    own, coordinates = problem.coordinates, whole.coordinates
    point = coordinates.point(found.theta)
    errors = dict(zip(coordinates.names[own.size :], point[own.size :].tolist(), strict=True))
    there = replace(found, theta=found.theta[: own.size])
    inflation = remark(whole, found).inflation
    effects = channel_effects(problem, there, inflation=inflation, at=errors)
    at = np.zeros(len(effects.names)) if effects.at is None else effects.at
    return ExplainedFit(
        point=point[: own.size],
        covariance=own_covariance(own, found, inflation=inflation),
        effects=effects,
        refused_chi_square=found.chi_square + inflation * float(at @ effects.information @ at),
        degrees_of_freedom=judge(whole, found).degrees_of_freedom,
        outlier=found.outlier,
        words=f"with another gain and run-out of probe {name} it would be accepted",
    )
