"""Judging: what a machine's newest runs say against their baseline. Computed in a worker, never where the store is."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from estimator.change_size import change_form, change_size
from estimator.covariates import Adjustment, adjustment
from estimator.diagnosis import Diagnosis
from estimator.healthy_variation import typical_amplitude
from estimator.observation import Observation, observation
from estimator.parameter_names import change_unit, parameter_units
from estimator.trend_tests import Reading
from estimator.watch import Watch
from service.alert_life import Severity
from service.diagnosis_rules import delays
from service.finding_rules import RATE_OF_CHANGE
from service.judgement import Found, FoundCause, History, JudgedRun, Judgement, Question, Rates
from service.limits import Limits
from service.rate_of_change import RateFinding, rate_findings


def judged(question: Question) -> Judgement:
    """Diagnose a machine, and look how fast it changes."""
    rates = None if question.rates is None else _rates(question.limits, question.rates, question.drifting)
    return Judgement(_diagnosis(question), rates)


def readings(history: History) -> list[Reading]:
    """The runs behind the baseline as under its mean conditions. Of several measured at one time the last counts."""
    follows = adjustment(
        [point for point, _ in history.baseline], [measured for _, measured in history.baseline], history.conditions
    )
    adjusted = [follows.adjusted(point, measured) for point, measured in history.after]
    return [Reading(time, point) for time, point in dict(zip(history.times, adjusted, strict=True)).items()]


@dataclass(frozen=True)
class Comparison:
    """A machine's newest runs against its baseline, oldest first."""

    watch: Watch
    after: tuple[JudgedRun, ...]
    observations: tuple[Observation, ...]


def comparison(question: Question) -> Comparison | None:
    """The newest runs beside their baseline, as under its mean operating conditions; None where they cannot be compared."""
    channels = tuple(probe.id for probe in question.machine.probes)
    baseline = [(run, observation(run.fit, channels)) for run in question.baseline]
    if not baseline:
        return None
    names = baseline[0][1].names
    after = [(run, said) for run in question.after if (said := observation(run.fit, channels)).names == names]
    newest = question.after[-1].id if question.after else None
    if not after or after[-1][0].id != newest or any(said.names != names for _, said in baseline):
        return None
    follows = adjustment(
        [said.point for _, said in baseline], [run.conditions for run, _ in baseline], question.machine.conditions
    )
    watch = Watch.over(question.machine, [_adjusted(said, run, follows) for run, said in baseline])
    return Comparison(watch, tuple(run for run, _ in after), tuple(_adjusted(said, run, follows) for run, said in after))


def _adjusted(said: Observation, run: JudgedRun, follows: Adjustment) -> Observation:
    """What a run says of the machine under the baseline's mean operating conditions."""
    if not follows.conditions:
        return said
    return said.at(follows.adjusted(said.point, run.conditions))


def _diagnosis(question: Question) -> Found | None:
    found = comparison(question)
    if found is None:
        return None
    limits = question.limits
    diagnosis = found.watch.found(found.observations, on_delay=lambda kind, element: delays(limits, kind, element)[0])
    amplitude = {probe.id: typical_amplitude(probe.id, found.watch.baseline) for probe in question.machine.probes}
    units = parameter_units(question.machine)
    causes = []
    for cause, runners_up in zip(diagnosis.causes, diagnosis.runners_up, strict=True):
        size = change_size(cause, found.watch.reference, amplitude=amplitude)
        began = found.after[found.watch.began(cause, found.observations)]
        of_names = {name: change_unit(name, units) for name in cause.names}
        causes.append(FoundCause(cause, runners_up, size, change_form(cause), of_names, began.measured_at, began.id))
    return Found(tuple(run.id for run in question.baseline), tuple(causes), _gone(question, found, diagnosis))


def _gone(question: Question, found: Comparison, diagnosis: Diagnosis) -> frozenset[tuple[str, str]]:
    """What is still seen, but below its limit with the hysteresis taken off, has returned as well."""
    seen = {(cause.kind, cause.element) for cause in diagnosis.causes}

    def is_gone(kind: str, element: str) -> bool:
        off_delay = delays(question.limits, kind, element)[1]
        return (kind, element) in seen or found.watch.gone(found.observations, kind, element, off_delay=off_delay)

    return frozenset(one for one in question.speaking if is_gone(*one))


def _rates(limits: Limits, history: History, drifting: Mapping[str, Severity]) -> Rates:
    told = readings(history)

    def longest_delay(element: str) -> int:
        rule = limits.rule(RATE_OF_CHANGE.name, element)
        return max(rule.on_delay, rule.off_delay)

    def found(runs: Sequence[Reading]) -> dict[str, RateFinding]:
        return {one.element: one for one in rate_findings(limits, runs, drifting)}

    newest = found(told)
    longest = max((longest_delay(element) for element in {*newest, *drifting}), default=1)
    # The newest run first, then as each run before it had it.
    then = [newest, *(found(told[:-back]) for back in range(1, longest))]

    def lasts(element: str) -> bool:
        return all(element in one for one in then[: limits.rule(RATE_OF_CHANGE.name, element).on_delay])

    def is_gone(element: str) -> bool:
        return not any(element in one for one in then[: limits.rule(RATE_OF_CHANGE.name, element).off_delay])

    findings = tuple(one for element, one in newest.items() if element in drifting or lasts(element))
    return Rates(findings, frozenset(filter(is_gone, drifting)))
