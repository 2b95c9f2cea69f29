"""What a rule says week after week about a machine, and how that compares with what befell it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.fleet.histories import WEEKS_A_YEAR, History
from estimator.baseline import Point
from estimator.identification import Identification
from estimator.misalignment import determines, misalignment_evidence, watched
from estimator.parameters import is_direct

IN_A_ROW = 2
"""Identifications in a row that must agree, as in the service."""

Named = tuple[str, str]
"""A kind of cause and the element it is at, as in ("misalignment", "coupling.C1")."""
Standing = tuple[frozenset[Named], ...]
"""The alerts that stand after each week, of the baseline's weeks too, in which there are none."""
Rule = Callable[[History, Sequence[Identification]], Standing]


@dataclass(frozen=True)
class Opened:
    """An alert that was opened in a week."""

    week: int
    named: Named


def opened(standing: Standing) -> list[Opened]:
    """Every opening, in order of time; one that closed and opened again counts twice."""
    before: frozenset[Named] = frozenset()
    found = []
    for week, now in enumerate(standing):
        found += [Opened(week, named) for named in sorted(now - before)]
        before = now
    return found


@dataclass(frozen=True)
class Outcome:
    """What a rule made of one machine's history.

    years: watched behind the baseline. false_misalignments: openings at a coupling that was well. wrong: all openings that
    name something that had not happened. Per change, named: what the first alert after it said, None for none; right: whether
    the right alert came at all; runs: how many runs that took, the first one with the change counted; part: of the change's
    full size that had been reached by then.
    """

    years: float
    false_misalignments: int
    wrong: tuple[Opened, ...]
    named: tuple[Named | None, ...]
    right: tuple[bool, ...]
    runs: tuple[int | None, ...]
    part: tuple[float | None, ...]


def judged(history: History, standing: Standing) -> Outcome:
    """The openings of a history beside its changes."""
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
    return Outcome(
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


def earlier_rule(history: History, weeks: Sequence[Identification]) -> Standing:
    """Misalignment where coupling and neighbouring bearings stiffened together, in two identifications in a row."""
    machine = history.machine
    standing: set[str] = set()
    found: list[frozenset[Named]] = []
    points = [_logarithms(one) if one.accepted else None for one in weeks]
    for week, point in enumerate(points):
        for coupling in machine.couplings:
            names = watched(machine, coupling)
            known = [one for one in points[: week + 1] if one is not None and determines(one, names)]
            if point is None or not determines(point, names) or len(known) < history.baseline + IN_A_ROW:
                continue
            signs = [
                misalignment_evidence(machine, coupling, known[: history.baseline], one).found for one in known[-IN_A_ROW:]
            ]
            if all(signs):
                standing.add(f"coupling.{coupling.id}")
            elif not any(signs):
                standing.discard(f"coupling.{coupling.id}")
        found.append(frozenset(("misalignment", element) for element in standing))
    return tuple(found)


def _logarithms(one: Identification) -> Point:
    known = {e.name: e.value for e in one.estimates if e.value is not None and e.quantity != "unbalance" and is_direct(e.name)}
    names = [name for name in one.coordinates if name in known]
    index = [one.coordinates.index(name) for name in names]
    return Point(tuple(names), np.log(np.array([known[name] for name in names])), one.covariance[np.ix_(index, index)])
