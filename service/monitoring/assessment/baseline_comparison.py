"""A machine's newest runs compared with its baseline, as observations under the same conditions."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

from estimator.diagnosis.data_faults import is_uninformative
from estimator.diagnosis.film_reference import film_observation, is_of_films
from estimator.diagnosis.observation import Observation, fit_observation
from estimator.diagnosis.run_windows import RunWindows
from estimator.machine.alignment_rules import HealthyVariation
from estimator.machine.film_speeds import follows_films
from estimator.trends.covariates import Adjustment, adjustment
from service.monitoring.assessment.context import AssessedRun, AssessmentContext
from service.monitoring.assessment.run_models import baseline_variation
from service.monitoring.rules.diagnosis_rules import UNLIMITED_DELAY, delays


@dataclass(frozen=True)
class RunsBefore:
    """The runs before a step. variation: variation of a healthy train between them and the newest run."""

    runs: tuple[AssessedRun, ...]
    variation: HealthyVariation


@dataclass(frozen=True)
class BaselineComparison:
    """A machine's newest runs compared with its baseline, or with the runs before a step, oldest first.

    variation: variation of a healthy train on oil films. whole: comparison of such a train with all its runs, not the
    newest alone. before: the runs before a step, where it is these that are compared with.
    """

    watch: RunWindows
    after: tuple[AssessedRun, ...]
    observations: tuple[Observation, ...]
    variation: HealthyVariation | None = None
    whole: "Callable[[], BaselineComparison | None] | None" = None
    before: RunsBefore | None = None


def compare(context: AssessmentContext) -> BaselineComparison | None:
    """Compare the newest runs with their baseline, under its mean operating conditions; return None when they are not
    comparable."""
    if follows_films(context.machine):
        return _compare_films(context)
    channels = tuple(probe.id for probe in context.machine.probes)
    baseline = [(run, fit_observation(run.fit, channels)) for run in context.baseline]
    if not baseline:
        return None
    names = baseline[0][1].names
    after = [(run, said) for run in context.after if (said := fit_observation(run.fit, channels)).names == names]
    if not _comparable(context, [run for run, _ in after], [said for _, said in baseline]):
        return None
    follows = adjustment(
        [said.point for _, said in baseline], [run.conditions for run, _ in baseline], context.machine.conditions
    )
    watch = RunWindows.from_baseline(context.machine, [_adjusted(said, run, follows) for run, said in baseline])
    return BaselineComparison(
        watch, tuple(run for run, _ in after), tuple(_adjusted(said, run, follows) for run, said in after)
    )


def _compare_films(context: AssessmentContext) -> BaselineComparison | None:
    """Compare a train on oil films: viscosities count from each run's own temperature, so that nothing is adjusted."""
    machine = context.machine
    if not context.baseline or not all(is_of_films(run.fit, machine) for run in context.baseline):
        return None
    baseline = [film_observation(run.fit, machine, run.conditions) for run in context.baseline]
    newest = context.after[-1] if context.after else None
    if newest is None or not is_of_films(newest.fit, machine) or any(one.names != baseline[0].names for one in baseline):
        return None
    variation = baseline_variation(machine, context.baseline)
    watch = RunWindows.from_baseline(machine, baseline, variation=variation)
    limits = context.limits
    enough = max(watch.longest(lambda *of: delays(limits, *of)[0]), *(delays(limits, *of)[1] for of in context.open_causes), 0)

    @cache
    def observed(number: int) -> Observation:
        return film_observation(context.after[number].fit, machine, context.after[number].conditions)

    def with_newest(count: float) -> BaselineComparison | None:
        after: list[tuple[AssessedRun, Observation]] = []
        heard = 0  # observing takes time, and most machines are healthy: windows of newest runs are enough for them
        for number in reversed(range(len(context.after))):
            run = context.after[number]
            if heard < count and is_of_films(run.fit, machine) and observed(number).names == baseline[0].names:
                after.insert(0, (run, observed(number)))
                heard += not is_uninformative(observed(number))
        if not _comparable(context, [run for run, _ in after], baseline):
            return None
        if any(not is_uninformative(said) for _, said in after[-UNLIMITED_DELAY:]):
            # Where all newest runs are uninformative, they are kept and reported as what no fit explains.
            after = [pair for pair in after if not is_uninformative(pair[1])]
        runs, said = tuple(run for run, _ in after), tuple(one for _, one in after)
        return BaselineComparison(watch, runs, said, variation, whole=lambda: with_newest(math.inf))

    return with_newest(enough)


def _comparable(context: AssessmentContext, after: Sequence[AssessedRun], baseline: Sequence[Observation]) -> bool:
    """Return whether the newest run is among those that can be compared, and the baseline is of the same quantities."""
    newest = context.after[-1].id if context.after else None
    same = all(said.names == baseline[0].names for said in baseline)
    return same and bool(after) and after[-1].id == newest


def _adjusted(said: Observation, run: AssessedRun, follows: Adjustment) -> Observation:
    """Return the observation of a run under the baseline's mean operating conditions."""
    if not follows.conditions:
        return said
    return said.at(follows.adjusted(said.point, run.conditions))
