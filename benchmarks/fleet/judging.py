"""Findings of a rule about a machine, week after week, compared with what happened to it."""

from collections.abc import Sequence
from dataclasses import dataclass

from benchmarks.fleet.histories import WEEKS_A_YEAR, History
from estimator.diagnosis.healthy_variation import typical_amplitude
from estimator.diagnosis.observation import Observation, observation_of
from estimator.diagnosis.run_windows import RunWindows
from estimator.diagnosis.severity_measures import change_size
from estimator.fit.identification import Identification
from service.alerts.lifecycle import Severity
from service.monitoring.context_loading import LOOKED_BACK
from service.monitoring.rules.diagnosis_rules import cause_severity, delays
from service.monitoring.rules.finding_catalogue import finding_rule
from service.monitoring.rules.limits import Limits

Named = tuple[str, str]
"""A kind of cause and the element it is at, as in ("misalignment", "coupling.C1")."""
Standing = tuple[frozenset[Named], ...]
"""The alerts that stand after each week, of the baseline's weeks too, in which there are none."""


@dataclass(frozen=True)
class Opened:
    """An alert that was opened in a week."""

    week: int
    named: Named


def opened(standing: Standing) -> list[Opened]:
    """Return every opening, in order of time; one that closed and opened again counts twice."""
    before: frozenset[Named] = frozenset()
    found = []
    for week, now in enumerate(standing):
        found += [Opened(week, named) for named in sorted(now - before)]
        before = now
    return found


@dataclass(frozen=True)
class JudgedHistory:
    """Result of a rule on one machine's history.

    years: watched after the baseline. false_misalignments: openings at a healthy coupling. wrong: all openings that name
    something that had not happened. Per change, named: the finding of the first alert after it, None for none; right: whether
    the right alert came at all; runs: how many runs that took, the first one with the change included; part: part of the
    change's full size that had been reached by then.
    """

    years: float
    false_misalignments: int
    wrong: tuple[Opened, ...]
    named: tuple[Named | None, ...]
    right: tuple[bool, ...]
    runs: tuple[int | None, ...]
    part: tuple[float | None, ...]


def judged(history: History, standing: Standing) -> JudgedHistory:
    """Return the openings of a history compared with its changes."""
    found = opened(standing)
    true = [one for one in found if _is_true(history, one)]
    wrong = tuple(one for one in found if not _is_true(history, one))
    first: list[Named | None] = []
    when: list[int | None] = []
    for change in history.changes:
        after = [one.named for one in found if one.week >= change.onset]
        own = [one.week for one in true if one.named == (change.kind, change.element)]
        first.append(after[0] if after else None)
        when.append(own[0] if own else None)
    return JudgedHistory(
        years=(len(history.states) - history.baseline) / WEEKS_A_YEAR,
        false_misalignments=sum(one.named[0] == "misalignment" for one in wrong),
        wrong=wrong,
        named=tuple(first),
        right=tuple(week is not None for week in when),
        runs=tuple(None if week is None else week - c.onset + 1 for week, c in zip(when, history.changes, strict=True)),
        part=tuple(None if week is None else c.progress(week) for week, c in zip(when, history.changes, strict=True)),
    )


def _is_true(history: History, one: Opened) -> bool:
    return any(one.named == (c.kind, c.element) and one.week >= c.onset for c in history.changes)


def service_rule(history: History, weeks: Sequence[Identification]) -> Standing:
    """Return the alerts that the service has open with its default limits: its monitoring without a database."""
    machine, limits = history.machine, Limits()
    channels = tuple(probe.id for probe in machine.probes)
    observations = [observation_of(one, channels) for one in weeks]
    baseline = [week for week, one in enumerate(observations) if one.accepted][: history.baseline]
    watch = RunWindows.from_baseline(machine, [observations[week] for week in baseline])
    amplitude = {channel: typical_amplitude(channel, watch.baseline) for channel in channels}
    standing: dict[tuple[str, str], Severity] = {}
    found: list[frozenset[Named]] = []
    for week in range(len(weeks)):
        after = [observations[one] for one in range(week + 1) if one not in baseline][-LOOKED_BACK:]
        if week >= baseline[-1] and after:
            standing = _updated(watch, after, standing, limits, amplitude)
        found.append(frozenset((finding_rule(kind).rule.name, element) for kind, element in standing))
    return tuple(found)


def _updated(
    watch: RunWindows,
    after: Sequence[Observation],
    before: dict[tuple[str, str], Severity],
    limits: Limits,
    amplitude: dict[str, float],
) -> dict[tuple[str, str], Severity]:
    """Return the severities of the alerts that are open after the newest run, by kind and element."""
    diagnosis = watch.found(after, on_delay=lambda kind, element: delays(limits, kind, element)[0])
    seen = {(cause.kind, cause.element) for cause in diagnosis.causes}
    now: dict[tuple[str, str], Severity] = {}
    for cause in diagnosis.causes:
        key = cause.kind, cause.element
        size = change_size(cause, watch.reference, amplitude=amplitude)
        severity = cause_severity(
            limits,
            kind=cause.kind,
            element=cause.element,
            sigma=cause.distance,
            size=size,
            force=None,
            present=before.get(key),
        )
        if severity is not None:
            now[key] = severity
    for key, severity in before.items():
        gone = watch.has_gone(after, *key, off_delay=delays(limits, *key)[1])
        if key not in now and key not in seen and not gone:
            now[key] = severity
    return now
