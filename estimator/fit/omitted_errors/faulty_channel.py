"""Fits that only the errors of one or two measuring chains explain: refused ones, done again with their gains and run-outs.

A probe whose run-out has changed, or whose gain is far off, moves what a fit without that error finds: films deviate and
phasors are left out until little of it shows in the channel itself. So a refused fit is done again with the errors of the
channel that explains most of what it leaves over, from the machine's last identification and from the fit's own end; then
with those of a second one, where none explains it alone or another is clearly off besides. Where that is accepted, what the
data say of the machine and of its channels is taken from there (Gaussian approximation of the likelihood at its maximum;
Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 3.4). The fit itself stays refused: its document
takes the channels as exact.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.fit.omitted_errors.explained_fit import ExplainedFit, own_covariance
from estimator.fit.omitted_errors.open_gains import CLEAR_FALL, cost
from estimator.fit.omitted_errors.suspected_errors import SuspectedErrors, clearest_other
from estimator.fit.optimisation.maximum_likelihood import HOPELESS_MISFIT, STAGE_MISFITS, fit
from estimator.fit.optimisation.nuisance_parameters import deviates_too_far
from estimator.fit.problem.channel_errors import with_channel_errors
from estimator.fit.problem.fit_problem import FitProblem, FitResult, best_excitations
from estimator.fit.problem.linear_phasors import PhasorMemory
from estimator.fit.validation.channel_sensitivity import channel_effects
from estimator.fit.validation.goodness_of_fit import judge, remark
from estimator.machine.parameter_description import COMPONENTS
from estimator.rotor.elimination import SingularCondensation

ATTEMPTS, ATTEMPTS_OF_TWO = 2, 4
"""Number of fits with the errors of one and of two channels, of those that explain most: either probe of a bearing does."""
FEWEST_FREEDOM = 20
"""Fewest degrees of freedom beside which errors explain a run [-]: fewer numbers are explained by anything."""
SPREAD = {"gain": 0.5, "run_out": 1e-4}
"""Standard deviations of each part of a gain and of a run-out that are free [-, m]: hardly anything is believed of them."""


def fit_with_channel_errors(
    problem: FitProblem, refused: FitResult, beginning: Floats | None, suspects: SuspectedErrors
) -> ExplainedFit | None:
    """Fit a refused problem again with the gain and the run-out of one channel (module's docstring).

    Source: Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 3.4.

    Args:
        problem: The problem.
        refused: Its fit.
        beginning: Coordinates θ (n,) of the machine's last identification [-]; None where there is none.
        suspects: Channels that may explain it.

    Returns:
        What the fit with the errors that explain most says, with those of a second channel where another is clearly off
        besides; None where none is accepted, or coefficients are calibrated.
    """
    starts = _starts(refused, beginning)
    best = _best(problem, [(channel,) for channel in suspects.channels[:ATTEMPTS]], starts)
    if best is None:
        return None
    explained = _explained(problem, best)
    second = clearest_other(explained.effects, problem.train.channels, beside=best.channels, least=CLEAR_FALL)
    if second is not None:
        both = _best(problem, [*suspects.pairs[:ATTEMPTS_OF_TWO], (*best.channels, second)], [*starts, _own(problem, best)])
        if (
            both is not None
            and _each_is_clear(both)
            and best.cost - both.cost >= CLEAR_FALL * remark(best.problem, best.found).inflation
        ):
            best, explained = both, _explained(problem, both)
    return explained if _says_much(explained, best) else None


def fit_with_errors_of_two(
    problem: FitProblem, refused: FitResult, beginning: Floats, suspects: SuspectedErrors
) -> ExplainedFit | None:
    """Fit a refused problem again with the gains and the run-outs of two channels, where none explains it alone.

    Source: Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 3.4.

    Args:
        problem: The problem.
        refused: Its fit.
        beginning: Coordinates θ (n,) of the machine's last identification [-].
        suspects: Channels that may explain it.

    Returns:
        What the fit with the errors that explain most says; None where none is accepted, or coefficients are calibrated.
    """
    best = _best(problem, suspects.pairs[:ATTEMPTS_OF_TWO], _starts(refused, beginning))
    if best is None:
        return None
    explained = _explained(problem, best)
    return explained if _says_much(explained, best) and _each_is_clear(best) else None


def _starts(refused: FitResult, beginning: Floats | None) -> list[Floats]:
    return [refused.theta] if beginning is None else [beginning, refused.theta]


def _says_much(explained: ExplainedFit, best: "_WithErrors") -> bool:
    """Return whether the errors explain much: a fit that is accepted with small ones has only begun elsewhere."""
    return explained.refused_chi_square - best.found.chi_square >= CLEAR_FALL


def _each_is_clear(both: "_WithErrors") -> bool:
    """Return whether the errors of each channel are clear by themselves beside the other's (Wald's test)."""
    coordinates, inflation = both.problem.coordinates, remark(both.problem, both.found).inflation
    covariance = inflation * np.linalg.inv(both.found.information + coordinates.prior.precision)
    for channel in both.channels:
        first = (coordinates.channels.gain[channel], coordinates.channels.run_out[channel])
        places = [place + part for place in first for part in range(len(COMPONENTS))]
        errors = both.found.theta[places]
        if errors @ np.linalg.solve(covariance[np.ix_(places, places)], errors) < CLEAR_FALL:
            return False
    return True


class _WithErrors(Struct, frozen=True, eq=False):
    """An accepted fit with the errors of some channels behind its own coordinates."""

    channels: tuple[int, ...]
    problem: FitProblem
    found: FitResult

    @property
    def cost(self) -> float:
        """Return what it leaves over, with what the prior adds [-]: a wrong channel explains data by odd films."""
        return cost(self.problem, self.found)


def _best(problem: FitProblem, attempts: Sequence[tuple[int, ...]], starts: list[Floats]) -> _WithErrors | None:
    """Return the accepted fit that costs least of those with the errors of some channels; None where coefficients are
    calibrated, too."""
    if problem.coordinates.calibrated is not None:
        return None
    found = [one for channels in attempts if (one := next(_accepted(problem, channels, starts), None)) is not None]
    return min(found, key=lambda one: one.cost, default=None)


def _own(problem: FitProblem, one: _WithErrors) -> Floats:
    return one.found.theta[: problem.coordinates.size]


def _accepted(problem: FitProblem, channels: tuple[int, ...], starts: list[Floats]) -> Iterator[_WithErrors]:
    """Yield the fits with some channels' errors that are accepted."""
    errors = [(quantity, channel) for channel in channels for quantity in SPREAD]
    coordinates = with_channel_errors(problem.coordinates, problem.train.channels, errors, spread=SPREAD)
    whole = replace(problem, coordinates=coordinates, outlier=np.zeros_like(problem.outlier), _memory=PhasorMemory())
    hopeless = np.inf if whole.noise.estimated else HOPELESS_MISFIT
    for start in starts:
        theta = np.concatenate([start, np.zeros(coordinates.size - start.size)])
        try:
            if not np.isfinite(whole.model(theta)).all():  # where a film is too thin
                continue
            for channel in channels:
                theta = _with_errors_found(whole, theta, channel)
            theta = best_excitations(whole, theta, whole.weight(whole.first_amplitude, STAGE_MISFITS[0]))
            found = fit(whole, theta, near=True, give_up_from=hopeless)
        except SingularCondensation:
            continue
        # One given up has neither its last weights nor its outliers: its χ² says nothing.
        if not np.isfinite(found.misfit) or deviates_too_far(whole, found):
            continue
        verdict = judge(whole, found)
        if verdict.accepted and verdict.degrees_of_freedom >= FEWEST_FREEDOM:
            yield _WithErrors(channels, whole, found)


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


def _explained(problem: FitProblem, one: _WithErrors) -> ExplainedFit:
    """Return what a fit with errors of channels says, these counted among the errors that the refused fit left out."""
    own, whole, found = problem.coordinates, one.problem, one.found
    coordinates = whole.coordinates
    point = coordinates.point(found.theta)
    errors = dict(zip(coordinates.names[own.size :], point[own.size :].tolist(), strict=True))
    there = replace(found, theta=_own(problem, one))
    inflation = remark(whole, found).inflation
    effects = channel_effects(problem, there, inflation=inflation, at=errors)
    at = effects.errors
    names = [problem.train.channels[channel] for channel in one.channels]
    told = f"another gain and run-out of probe {names[0]}" if len(names) == 1 else _together(names)
    return ExplainedFit(
        point=point[: own.size],
        covariance=own_covariance(own, found, inflation=inflation),
        effects=effects,
        refused_chi_square=found.chi_square + inflation * float(at @ effects.information @ at),
        degrees_of_freedom=judge(whole, found).degrees_of_freedom,
        outlier=found.outlier,
        words=f"with {told} it would be accepted",
    )


def _together(names: Sequence[str]) -> str:
    return f"other gains and run-outs of the probes {' and '.join(names)}"
