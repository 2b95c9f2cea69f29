"""Conclusions from a fit: whether it may be believed, its estimates with intervals, or why there are none."""

from collections.abc import Callable

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.fit.estimates import determined, estimates
from estimator.fit.identification import Identification
from estimator.fit.large_gain_errors import channel_effects_at_large_gain
from estimator.fit.optimisation.multistart import BestFit
from estimator.fit.optimisation.nuisance_parameters import excessive_deviations
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.form_discrepancy import FormVerdict, judge_form, needs_form
from estimator.fit.validation.goodness_of_fit import Verdict, VerdictRemark, judge, remark
from estimator.fit.validation.identifiability import Reasons
from estimator.fit.validation.omitted_forces import judge_exact_forces
from estimator.fit.validation.omitted_warming import viscosity_trend, warming_words
from estimator.fit.validation.physical_limits import LimitsFunction, without_growing_modes
from estimator.fit.validation.prior_conflict import judge_priors
from estimator.fit.validation.profile_likelihood import flat_coordinates
from estimator.fit.validation.sharp_film_deviations import judge_sharp_deviations
from estimator.fit.validation.table_cross_terms import judge_table_cross_terms
from estimator.fit.validation.table_factors import judge_table_factors
from estimator.symmetric_eigen import condition_number

LARGEST_CONDITION = 1e5
"""Condition number above which intervals are checked against the likelihood's profile [-]; full run-downs have some
thousands."""


def conclude(
    problem: FitProblem, best: BestFit, of_gaps: tuple[str, ...], reasons: Reasons | None, limits: LimitsFunction | None
) -> Identification:
    """Judge a fit: its verdict, estimates with intervals, or the reasons why there are none.

    Intervals are those of the Gaussian approximation at the maximum (Rasmussen and Williams, Gaussian Processes for Machine
    Learning, 2006, sec. 3.4), as wide as the form over speed and the residuals ask for.

    Args:
        problem: The problem.
        best: The best fit of its starts.
        of_gaps: What is said of the gaps, in words.
        reasons: Function that says in words why a parameter is not estimable.
        limits: Function that looks for what no machine can have; None to accept it.

    Returns:
        The identification.
    """
    coordinates, found = problem.coordinates, best.fit
    covariance, condition = _covariance(problem, found)
    verdict = judge(problem, found)
    beside, of_form = VerdictRemark(), FormVerdict(covariance)
    doubtful, form_alone = frozenset[int](), frozenset[int]()
    if verdict.accepted:
        beside = remark(problem, found)
        of_tables = judge_table_factors(problem, found, covariance)
        of_form = _form_verdict(problem, found, covariance, condition, beside.inflation, of_tables)
        found, verdict = _possible(problem, found, of_form.applied(verdict), limits)
        form_alone = _left_to_form(coordinates, of_tables.covariance, of_form)
        covariance = of_form.covariance if beside.left_open is None else of_form.covariance + beside.left_open
        if verdict.accepted and condition > LARGEST_CONDITION and not coordinates.models:
            doubtful = flat_coordinates(problem, found, covariance, sorted(_determined(coordinates, covariance)))
    speed = problem.measurement.speed
    why = None if reasons is None else reasons(problem, found, covariance)
    if why is not None and form_alone:
        why = _with_form_alone(why, frozenset(coordinates.names[place] for place in form_alone))
    return Identification(
        estimates=estimates(problem.train, coordinates, found.theta, of_form.reported_errors(covariance), why, doubtful),
        coordinates=coordinates.names,
        covariance=covariance * np.outer(coordinates.unit, coordinates.unit),
        point=coordinates.point(found.theta),
        chi_square=found.chi_square,
        degrees_of_freedom=verdict.degrees_of_freedom,
        accepted=verdict.accepted,
        verdict="; ".join((verdict.words + of_form.remark + of_form.resting + beside.words, *best.remarks, *of_gaps)),
        condition_number=condition,
        starts=best.starts,
        iterations=best.iterations,
        samples=int(speed.size),
        speed_minimum=float(speed.min()),
        speed_maximum=float(speed.max()),
        noise=found.noise,
        outliers=outliers_by_channel(problem, found.outlier),
        channel_effects=channel_effects_at_large_gain(
            problem, found, inflation=beside.inflation, widening=_widening if verdict.accepted else None
        ),
        doubted_forces=tuple(replace(one, answer=one.answer * coordinates.unit) for one in of_form.forces),
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


def _form_verdict(
    problem: FitProblem, found: FitResult, covariance: Floats, condition: float, inflation: float, of_tables: FormVerdict
) -> FormVerdict:
    """Return the verdict on how coefficients follow the speed: by assumed forms, and by films with their deviations.

    Its covariance is as wide as neighbouring residuals that are alike and all deviations ask for, refused or not.
    """
    trend = viscosity_trend(problem, found, covariance, inflation=inflation)
    excess = excessive_deviations(problem, found, covariance) or warming_words(trend)
    whole, words, remarks = inflation * covariance, excess, ""
    of_forces = judge_exact_forces(problem, found, covariance, inflation=inflation)
    if excess:  # what films cannot explain is no force's: scores say nothing then
        return FormVerdict(whole, words, remarks, resting=of_forces.resting)
    far = bool(of_tables.remark)
    of_cross_terms = judge_table_cross_terms(problem, found, covariance, far=far, inflation=inflation)
    of_sharpness = judge_sharp_deviations(problem, found, covariance, inflation=inflation)
    of_priors = judge_priors(problem, found, covariance)
    judged = [of_forces, of_sharpness, of_tables, of_cross_terms, of_priors]
    if needs_form(problem):
        of_form = judge_form(problem, found, covariance, condition)
        judged.append(replace(of_form, covariance=covariance + inflation * (of_form.covariance - covariance)))
    for one in judged:
        # Each is what one deviation alone leaves open.
        whole, words, remarks = whole + (one.covariance - covariance), words or one.words, remarks + one.remark
    return FormVerdict(whole, words, remarks, of_forces.forces, of_forces.resting, of_priors.standing_in)


def _widening(problem: FitProblem, found: FitResult) -> tuple[float, Floats]:
    """Return the factor by which the covariance of a fit is widened [-], and what is added besides (n, n) [-]."""
    covariance, condition = _covariance(problem, found)
    beside = remark(problem, found)
    of_tables = judge_table_factors(problem, found, covariance)
    of_form = _form_verdict(problem, found, covariance, condition, beside.inflation, of_tables)
    left_open = 0.0 if beside.left_open is None else beside.left_open
    return beside.inflation, of_form.covariance - beside.inflation * covariance + left_open


def _covariance(problem: FitProblem, found: FitResult) -> tuple[Floats, float]:
    """Return the covariance (n, n) of the fit coordinates [-], and the condition number of the information."""
    information = found.information + problem.coordinates.prior.precision
    covariance, size = np.linalg.inv(information), np.sqrt(np.diag(information))
    return (covariance + covariance.T) / 2, condition_number(information / np.outer(size, size))


def _left_to_form(coordinates: Coordinates, without: Floats, of_form: FormVerdict) -> frozenset[int]:
    """Return the coordinates that only an assumed form determines: those that its possible deviations leave open.

    Deviations that the data show are told otherwise.
    """
    if of_form.words or of_form.remark:
        return frozenset()
    return _determined(coordinates, without) - _determined(coordinates, of_form.covariance)


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
