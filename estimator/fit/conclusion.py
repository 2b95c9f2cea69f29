"""Conclusions from a fit: whether it may be believed, its estimates with intervals, or why there are none."""

from collections.abc import Callable, Collection

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.fit.estimates import determined, estimates
from estimator.fit.identification import Identification
from estimator.fit.omitted_errors.gains_beside_films import EstimatesWithErrors, estimates_with_errors
from estimator.fit.omitted_errors.large_gain_errors import along_secant
from estimator.fit.omitted_errors.open_gains import CLEAR_FALL, clear_gains
from estimator.fit.optimisation.multistart import BestFit
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.channel_sensitivity import channel_effects
from estimator.fit.validation.goodness_of_fit import Verdict, judge
from estimator.fit.validation.identifiability import Reasons
from estimator.fit.validation.interval_widths import IntervalWidths, interval_widths, plain_widths
from estimator.fit.validation.physical_limits import LimitsFunction, without_growing_modes
from estimator.fit.validation.profile_likelihood import flat_coordinates

LARGEST_CONDITION = 1e5
"""Condition number above which intervals are checked against the likelihood's profile [-]; full run-downs have some
thousands."""


def conclude(
    problem: FitProblem,
    best: BestFit,
    of_gaps: tuple[str, ...],
    reasons: Reasons | None,
    limits: LimitsFunction | None,
    open_errors: Collection[str] = (),
) -> Identification:
    """Judge a fit: its verdict, estimates with intervals, or the reasons why there are none.

    Intervals are those of the Gaussian approximation at the maximum (Rasmussen and Williams, Gaussian Processes for Machine
    Learning, 2006, sec. 3.4), as wide as the form over speed and the residuals ask for. On oil films estimates allow for gains
    that are clearly off.

    Args:
        problem: The problem.
        best: The best fit of its starts.
        of_gaps: What is said of the gaps, in words.
        reasons: Function that says in words why a parameter is not estimable.
        limits: Function that looks for what no machine can have; None to accept it.
        open_errors: Errors of channels and couplings that a diagnosis has named.

    Returns:
        The identification.
    """
    coordinates, found, verdict = problem.coordinates, best.fit, judge(problem, best.fit)
    widths, doubtful = plain_widths(problem, found), frozenset[int]()
    if verdict.accepted:
        widths = interval_widths(problem, found)
        found, verdict = _possible(problem, found, widths.form.applied(verdict), limits)
        if verdict.accepted and widths.condition > LARGEST_CONDITION and not coordinates.models:
            decided = sorted(_determined(coordinates, widths.covariance))
            doubtful = flat_coordinates(problem, found, widths.covariance, decided)
    told = _beside_errors(problem, found, widths, open_errors, limits, accepted=verdict.accepted)
    found, widths = replace(found, theta=told.theta), told.widths
    why = None if reasons is None else reasons(problem, found, widths.covariance)
    if why is not None and verdict.accepted:
        why = _with_form_alone(why, _left_to_form(coordinates, widths))
    errors = widths.form.reported_errors(widths.covariance)
    said = verdict.words + widths.form.remark + widths.form.resting + widths.words + told.words
    return Identification(
        estimates=estimates(problem.train, coordinates, found.theta, errors, why, doubtful),
        coordinates=coordinates.names,
        covariance=widths.covariance * np.outer(coordinates.unit, coordinates.unit),
        point=coordinates.point(found.theta),
        chi_square=found.chi_square,
        degrees_of_freedom=verdict.degrees_of_freedom,
        accepted=verdict.accepted,
        verdict="; ".join((said, *best.remarks, *of_gaps)),
        condition_number=widths.condition,
        starts=best.starts,
        iterations=best.iterations,
        samples=int(problem.measurement.speed.size),
        speed_minimum=float(problem.measurement.speed.min()),
        speed_maximum=float(problem.measurement.speed.max()),
        noise=found.noise,
        outliers=outliers_by_channel(problem, found.outlier),
        channel_effects=told.effects,
        doubted_forces=tuple(replace(one, answer=one.answer * coordinates.unit) for one in widths.form.forces),
    )


def outliers_by_channel(problem: FitProblem, outlier: NDArray[np.bool_]) -> dict[str, int]:
    """Count the phasors left out by channel.

    Args:
        problem: The problem of a fit.
        outlier: True for phasors left out (S, m).

    Returns:
        Their number by the channel's name, where there is any.
    """
    counts = np.count_nonzero(outlier, axis=0)
    return {channel: int(count) for channel, count in zip(problem.train.channels, counts, strict=True) if count}


def _beside_errors(
    problem: FitProblem,
    found: FitResult,
    widths: IntervalWidths,
    open_errors: Collection[str],
    limits: LimitsFunction | None,
    *,
    accepted: bool,
) -> EstimatesWithErrors:
    """Return what is told of a fit: its own estimates, or on oil films those with errors of channels and couplings."""
    effects = channel_effects(problem, found, inflation=widths.inflation)
    clear = clear_gains(problem, found, effects, least=CLEAR_FALL / widths.inflation)
    # Of constant coefficients the secant tells more of a small drift: with the estimates at the gain, a coupling is told too.
    if not accepted or not problem.coordinates.nuisance.any():
        effects = along_secant(problem, found, effects, clear, inflation=widths.inflation)
        return EstimatesWithErrors(found.theta, widths, effects, "")
    told = estimates_with_errors(problem, found, widths, effects, clear, open_errors)
    if told is None or _grows(problem, replace(found, theta=told.theta), limits):
        return EstimatesWithErrors(found.theta, widths, effects, "")
    return told


def _grows(problem: FitProblem, found: FitResult, limits: LimitsFunction | None) -> bool:
    return limits is not None and limits(problem).growing_mode(found.theta) is not None


def _left_to_form(coordinates: Coordinates, widths: IntervalWidths) -> frozenset[str]:
    """Return the coordinates that only an assumed form determines: those that its possible deviations leave open.

    Deviations that the data show are told otherwise.
    """
    if widths.form.words or widths.form.remark:
        return frozenset()
    alone = _determined(coordinates, widths.without_forms) - _determined(coordinates, widths.form.covariance)
    return frozenset(coordinates.names[place] for place in alone)


def _determined(coordinates: Coordinates, covariance: Floats) -> frozenset[int]:
    return frozenset(determined(coordinates, np.sqrt(np.diag(covariance))))


def _with_form_alone(why: Callable[[str], str], names: frozenset[str]) -> Callable[[str], str]:
    """Return the function that says why a coordinate is left open, with those that the form over speed alone determines."""

    def reason(name: str) -> str:
        if name in names:
            return "only the form over speed that the document assumes determines it, and no data show whether that is true"
        return why(name)

    return reason


def _possible(
    problem: FitProblem, found: FitResult, verdict: Verdict, limits: LimitsFunction | None
) -> tuple[FitResult, Verdict]:
    """Return an accepted fit without growing modes, or the verdict that it has one."""
    if limits is None or not verdict.accepted:
        return found, verdict
    moved, growing = without_growing_modes(limits(problem), problem, found)
    if growing is None:
        return moved, verdict
    return found, verdict.refused(growing.words)
