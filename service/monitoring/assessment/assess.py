"""Assessment of a machine's newest runs against their baseline: a pure function, computed in a worker process."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.diagnosis.alignment_size import alignment_size
from estimator.diagnosis.bayes_factors import Diagnosis
from estimator.diagnosis.change_progress import ChangeProgress, change_progress
from estimator.diagnosis.data_faults import is_trusted
from estimator.diagnosis.finding_kind import Cause, ChangeSize
from estimator.diagnosis.healthy_variation import typical_amplitude
from estimator.diagnosis.run_windows import faulty_channels
from estimator.diagnosis.severity_measures import change_form, change_size
from estimator.rotor.parameter_names import parameter_units
from estimator.trends.covariates import adjustment
from estimator.trends.trend_tests import DatedPoint
from service.monitoring.assessment.alignment_steps import (
    AlignmentStep,
    alignment_steps,
    is_off_baseline,
    step_begins_amid,
    step_has_gone,
    with_step,
)
from service.monitoring.assessment.baseline_comparison import BaselineComparison, compare
from service.monitoring.assessment.context import (
    WEEK,
    Assessment,
    AssessmentContext,
    BaselineHistory,
    DiagnosedCause,
    MachineDiagnosis,
    RateAssessment,
)
from service.monitoring.assessment.load_changes import load_changes
from service.monitoring.assessment.moved_parameters import adjusted_baseline, moved_parameters
from service.monitoring.assessment.rate_of_change import RateFinding, rate_findings, with_times_to_limits
from service.monitoring.assessment.run_models import left_out, run_model
from service.monitoring.assessment.second_order import Explanation, explained
from service.monitoring.rules.coupling_and_bearing_findings import MISALIGNMENT
from service.monitoring.rules.diagnosis_rules import cause_severity, danger_limit, delays
from service.monitoring.rules.drift_rule import RATE_OF_CHANGE


def assess(context: AssessmentContext) -> Assessment:
    """Diagnose a machine's change, and assess its rate."""
    rates = None if context.history is None else _rates(context, context.history)
    diagnosis = _diagnosis(context)
    return Assessment(diagnosis, rates, frozenset() if diagnosis is None else left_out(context, diagnosis))


def readings(history: BaselineHistory) -> list[DatedPoint]:
    """Return the runs after a baseline adjusted to its mean operating conditions; of runs measured at one time only the
    last."""
    follows = adjustment(
        [point for point, _ in history.baseline], [measured for _, measured in history.baseline], history.conditions
    )
    adjusted = [follows.adjusted(point, measured) for point, measured in history.after]
    return [DatedPoint(time, point) for time, point in dict(zip(history.times, adjusted, strict=True)).items()]


def _diagnosis(context: AssessmentContext) -> MachineDiagnosis | None:
    compared = compare(context)
    if compared is None:
        return None
    limits = context.limits
    diagnosis = compared.watch.found(compared.observations, on_delay=lambda kind, element: delays(limits, kind, element)[0])
    whole = compared.whole() if diagnosis.causes and compared.whole is not None else None
    causes = _with_steps(context, compared, _causes(context, whole or compared, diagnosis))
    gone = _cleared_causes(context, compared, [one.cause for one in causes])
    moved = moved_parameters(context, parameter_units(context.machine)) if causes else ()
    return MachineDiagnosis(tuple(run.id for run in context.baseline), causes, gone, moved)


def _causes(
    context: AssessmentContext, compared: BaselineComparison, diagnosis: Diagnosis, beside: Sequence[Cause] = ()
) -> tuple[DiagnosedCause, ...]:
    """Return the causes of a diagnosis with their size, their form, and the run with which each began and how it went on.

    beside: causes that are known from elsewhere: what they have moved is no part of any size.
    """
    machine = context.machine
    amplitude = {probe.id: typical_amplitude(probe.id, compared.watch.baseline) for probe in machine.probes}
    explanations = _explanations(context, compared, diagnosis, amplitude, beside)
    together = [*(one.cause for one in explanations), *beside]
    causes = []
    for found, named in zip(explanations, diagnosis.causes, strict=True):
        cause = found.cause
        size = _size(context, compared, cause, together, amplitude)
        place = compared.watch.began(cause, compared.observations)
        others = [one for one in diagnosis.causes if one is not named and one.names]
        progress = _progress(context, compared, SizedChange(cause, size, amplitude), others, place)
        began = compared.after[place]
        if cause.kind == MISALIGNMENT.name and compared.variation is None:
            size = replace(size, parts=(*size.parts, *load_changes(context, cause.element)))
        causes.append(
            DiagnosedCause(
                cause,
                found.runners_up,
                size,
                change_form(cause),
                progress,
                began.measured_at,
                began.id,
                second_order=found.second_order,
            )
        )
    return tuple(causes)


def _with_steps(
    context: AssessmentContext, compared: BaselineComparison, causes: tuple[DiagnosedCause, ...]
) -> tuple[DiagnosedCause, ...]:
    """Return the causes with the steps of couplings' alignments: each beside the change that the baseline shows, or alone."""
    known = {(one.cause.kind, one.cause.element): one for one in causes}
    for step in alignment_steps(context, compared, faulty_channels(one.cause for one in causes)):
        if step_begins_amid(step, [one.began_at for key, one in known.items() if key not in step.keys]):
            continue
        beside = [*(one.cause for one in causes), *step.others]
        (found,) = _causes(context, step.comparison, step.diagnosis, beside)
        key, size = (found.cause.kind, found.cause.element), _step_size(context, step, beside)
        if key in known:
            known[key] = replace(known[key], size=with_step(known[key].size, size))
        elif is_off_baseline(found.size, size):
            known[key] = replace(found, size=with_step(found.size, size))
    return tuple(known.values())


def _step_size(context: AssessmentContext, step: AlignmentStep, beside: Sequence[Cause]) -> ChangeSize:
    """Return the size of a step by itself, against the runs before it; what other causes have moved is no part of it."""
    before, newest = step.comparison.before, step.comparison.after[-1]
    if before is None:
        return ChangeSize(None)
    (cause,) = step.diagnosis.causes
    models = [run_model(context.machine, run) for run in before.runs]
    now = run_model(context.machine, newest, beside=beside)
    return alignment_size(cause, models, now, variation=before.variation, causes=[cause, *beside])


def _explanations(
    context: AssessmentContext,
    compared: BaselineComparison,
    diagnosis: Diagnosis,
    amplitude: Mapping[str, float],
    beside: Sequence[Cause],
) -> list[Explanation]:
    """Return each cause as the 2× has it: it raises no alert where there would be none, and sets none aside for what raises
    none."""

    def alerts_by_itself(cause: Cause) -> bool:
        return _reaches_limit(context, cause, _size(context, compared, cause, [*diagnosis.causes, *beside], amplitude))

    explanations = []
    for number, named in enumerate(diagnosis.causes):
        found = explained(context, diagnosis, number)
        if found.cause is not named and not (alerts_by_itself(named) and alerts_by_itself(found.cause)):
            found = Explanation(named, diagnosis.runners_up[number])
        explanations.append(found)
    return explanations


def _reaches_limit(context: AssessmentContext, cause: Cause, size: ChangeSize) -> bool:
    """Return whether a cause that has no open alert would raise one."""
    sigma, element = cause.distance, cause.element
    found = cause_severity(context.limits, kind=cause.kind, element=element, sigma=sigma, size=size, force=None, present=None)
    return found is not None


@dataclass(frozen=True)
class SizedChange:
    """A cause with its size. amplitude: median by channel in the baseline [m]."""

    cause: Cause
    size: ChangeSize
    amplitude: Mapping[str, float]


def _progress(
    context: AssessmentContext, compared: BaselineComparison, change: SizedChange, others: Sequence[Cause], place: int
) -> ChangeProgress:
    """Follow the size of a cause from the run with which it began, towards the danger limit that it has."""
    cause, now = change.cause, change.size.limited
    measured = compared.variation is not None and cause.kind == MISALIGNMENT.name
    length = float(np.linalg.norm(cause.change / compared.watch.reference.unit_of(cause.names))) if measured else 0.0

    def size(of: Cause) -> float | None:
        if not measured:
            return change_size(of, compared.watch.reference, amplitude=change.amplitude).limited
        # An alignment is estimated from all runs together: a run's part of it is its part of the change.
        part = float(np.linalg.norm(of.change / compared.watch.reference.unit_of(of.names))) / max(length, 1e-300)
        return None if now is None else part * now

    channels = faulty_channels([cause, *others])
    runs = [
        (run.measured_at / WEEK, one)
        for run, one in zip(compared.after[place:], compared.observations[place:], strict=True)
        if is_trusted(one, channels)
    ]
    limit = danger_limit(context.limits, cause.kind, cause.element, change.size)
    return change_progress(compared.watch.reference, cause, others, runs, size=size, limit=limit)


def _size(
    context: AssessmentContext,
    compared: BaselineComparison,
    cause: Cause,
    together: Sequence[Cause],
    amplitude: Mapping[str, float],
) -> ChangeSize:
    """Return the size of a cause; that of a misalignment on oil films is the change of alignment that is told elsewhere.

    together: all causes of the machine's change.
    """
    if cause.kind != MISALIGNMENT.name or compared.variation is None:
        return change_size(cause, compared.watch.reference, amplitude=amplitude)
    newest = compared.watch.newest_trusted(cause, compared.observations, together)
    if newest is None:
        return ChangeSize(None)
    models = [run_model(context.machine, run) for run in context.baseline]
    now = run_model(context.machine, compared.after[newest], beside=together)
    return alignment_size(cause, models, now, variation=compared.variation, causes=together)


def _cleared_causes(
    context: AssessmentContext, compared: BaselineComparison, found: Sequence[Cause]
) -> frozenset[tuple[str, str]]:
    """Return the open causes that have gone; one that is still found, but below its limit less the hysteresis, has gone
    too."""
    seen, channels = {(one.kind, one.element) for one in found}, faulty_channels(found)

    def is_gone(kind: str, element: str) -> bool:
        off_delay = delays(context.limits, kind, element)[1]
        if (kind, element) in seen:
            return True
        step_gone = step_has_gone(context, compared, element, channels) if kind == MISALIGNMENT.name else None
        if step_gone is not None:
            return step_gone
        return compared.watch.has_gone(compared.observations, kind, element, off_delay=off_delay)

    return frozenset(one for one in context.open_causes if is_gone(*one))


def _rates(context: AssessmentContext, history: BaselineHistory) -> RateAssessment:
    limits, drifting, adjusted = context.limits, context.open_rates, readings(history)

    def longest_delay(element: str) -> int:
        rule = limits.rule(RATE_OF_CHANGE.name, element)
        return max(rule.on_delay, rule.off_delay)

    def found(runs: Sequence[DatedPoint]) -> dict[str, RateFinding]:
        return {one.element: one for one in rate_findings(limits, runs, drifting)}

    newest = found(adjusted)
    longest = max((longest_delay(element) for element in {*newest, *drifting}), default=1)
    # The findings as of the newest run, then as of each run before it.
    then = [newest, *(found(adjusted[:-back]) for back in range(1, longest))]

    def lasts(element: str) -> bool:
        return all(element in one for one in then[: limits.rule(RATE_OF_CHANGE.name, element).on_delay])

    def is_gone(element: str) -> bool:
        return not any(element in one for one in then[: limits.rule(RATE_OF_CHANGE.name, element).off_delay])

    findings = tuple(one for element, one in newest.items() if element in drifting or lasts(element))
    baseline = adjusted_baseline(context)
    return RateAssessment(with_times_to_limits(findings, limits, baseline, adjusted), frozenset(filter(is_gone, drifting)))
