"""Assessment of a machine's newest runs against their baseline: a pure function, computed in a worker process."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from estimator.diagnosis.bayes_factors import Diagnosis
from estimator.diagnosis.healthy_variation import typical_amplitude
from estimator.diagnosis.observation import Observation, fit_observation
from estimator.diagnosis.run_windows import RunWindows
from estimator.diagnosis.severity_measures import change_form, change_size
from estimator.machine.document import Machine
from estimator.rotor.parameter_names import change_unit, parameter_units
from estimator.trends.covariates import Adjustment, adjustment
from estimator.trends.trend_tests import Reading
from service.alerts.lifecycle import Severity
from service.monitoring.assessment import (
    AssessedRun,
    Assessment,
    AssessmentContext,
    BaselineHistory,
    DiagnosedCause,
    MachineDiagnosis,
    RateAssessment,
)
from service.monitoring.diagnosis_rules import delays
from service.monitoring.finding_rules import RATE_OF_CHANGE
from service.monitoring.limits import Limits
from service.monitoring.rate_of_change import RateFinding, rate_findings


def assess(context: AssessmentContext) -> Assessment:
    """Diagnose a machine's change, and assess its rate."""
    rates = None if context.history is None else _rates(context.limits, context.history, context.open_rates)
    return Assessment(_diagnosis(context), rates)


def readings(history: BaselineHistory) -> list[Reading]:
    """Return the runs after a baseline adjusted to its mean operating conditions; of runs measured at one time only the
    last."""
    follows = adjustment(
        [point for point, _ in history.baseline], [measured for _, measured in history.baseline], history.conditions
    )
    adjusted = [follows.adjusted(point, measured) for point, measured in history.after]
    return [Reading(time, point) for time, point in dict(zip(history.times, adjusted, strict=True)).items()]


@dataclass(frozen=True)
class BaselineComparison:
    """A machine's newest runs compared with its baseline, oldest first."""

    watch: RunWindows
    after: tuple[AssessedRun, ...]
    observations: tuple[Observation, ...]


def compare(context: AssessmentContext) -> BaselineComparison | None:
    """Compare the newest runs with their baseline, under its mean operating conditions; return None when they are not
    comparable."""
    channels = tuple(probe.id for probe in context.machine.probes)
    baseline = [(run, fit_observation(run.fit, channels)) for run in context.baseline]
    if not baseline:
        return None
    names = baseline[0][1].names
    after = [(run, said) for run in context.after if (said := fit_observation(run.fit, channels)).names == names]
    newest = context.after[-1].id if context.after else None
    if not after or after[-1][0].id != newest or any(said.names != names for _, said in baseline):
        return None
    follows = adjustment(
        [said.point for _, said in baseline], [run.conditions for run, _ in baseline], context.machine.conditions
    )
    watch = RunWindows.over(context.machine, [_adjusted(said, run, follows) for run, said in baseline])
    return BaselineComparison(
        watch, tuple(run for run, _ in after), tuple(_adjusted(said, run, follows) for run, said in after)
    )


def _adjusted(said: Observation, run: AssessedRun, follows: Adjustment) -> Observation:
    """Return the observation of a run under the baseline's mean operating conditions."""
    if not follows.conditions:
        return said
    return said.at(follows.adjusted(said.point, run.conditions))


def _diagnosis(context: AssessmentContext) -> MachineDiagnosis | None:
    compared = compare(context)
    if compared is None:
        return None
    limits = context.limits
    diagnosis = compared.watch.found(compared.observations, on_delay=lambda kind, element: delays(limits, kind, element)[0])
    causes = _causes(context.machine, compared, diagnosis)
    return MachineDiagnosis(tuple(run.id for run in context.baseline), causes, _cleared_causes(context, compared, diagnosis))


def _causes(machine: Machine, compared: BaselineComparison, diagnosis: Diagnosis) -> tuple[DiagnosedCause, ...]:
    """Return the causes of a diagnosis with their size, their form and the run with which each began."""
    amplitude = {probe.id: typical_amplitude(probe.id, compared.watch.baseline) for probe in machine.probes}
    units = parameter_units(machine)
    causes = []
    for cause, runners_up in zip(diagnosis.causes, diagnosis.runners_up, strict=True):
        size = change_size(cause, compared.watch.reference, amplitude=amplitude)
        began = compared.after[compared.watch.began(cause, compared.observations)]
        of_names = {name: change_unit(name, units) for name in cause.names}
        causes.append(DiagnosedCause(cause, runners_up, size, change_form(cause), of_names, began.measured_at, began.id))
    return tuple(causes)


def _cleared_causes(
    context: AssessmentContext, compared: BaselineComparison, diagnosis: Diagnosis
) -> frozenset[tuple[str, str]]:
    """Return the open causes that have gone; one that is still found, but below its limit less the hysteresis, has gone
    too."""
    seen = {(cause.kind, cause.element) for cause in diagnosis.causes}

    def is_gone(kind: str, element: str) -> bool:
        off_delay = delays(context.limits, kind, element)[1]
        return (kind, element) in seen or compared.watch.gone(compared.observations, kind, element, off_delay=off_delay)

    return frozenset(one for one in context.open_causes if is_gone(*one))


def _rates(limits: Limits, history: BaselineHistory, drifting: Mapping[str, Severity]) -> RateAssessment:
    adjusted = readings(history)

    def longest_delay(element: str) -> int:
        rule = limits.rule(RATE_OF_CHANGE.name, element)
        return max(rule.on_delay, rule.off_delay)

    def found(runs: Sequence[Reading]) -> dict[str, RateFinding]:
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
    return RateAssessment(findings, frozenset(filter(is_gone, drifting)))
