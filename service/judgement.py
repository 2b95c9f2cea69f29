"""What a worker is asked of a machine's newest runs, and what it answers: see `service.judging`."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from estimator.machine import Condition, Machine
from estimator.observation import Fit
from estimator.point import Point
from service.alert_life import Severity
from service.limits import Limits

if TYPE_CHECKING:
    from estimator.finding_kind import Cause, ChangeSize
    from service.rate_of_change import RateFinding

Conditions = Mapping[str, float | None]
"""Mean of each operating condition over a run by name; None where it was not measured."""


@dataclass(frozen=True)
class JudgedRun:
    """One identification of a run. fit: what it says; measured_at: [ns]."""

    id: int
    measured_at: int
    conditions: Conditions
    fit: Fit


@dataclass(frozen=True)
class History:
    """Runs behind a baseline, oldest first. times: [weeks since 1970]. conditions: of the machine, that parameters may follow.

    baseline, after: per run what was determined, and the conditions under which.
    """

    conditions: Sequence[Condition]
    baseline: Sequence[tuple[Point, Conditions]]
    times: Sequence[float]
    after: Sequence[tuple[Point, Conditions]]


@dataclass(frozen=True)
class Question:
    """What is to be judged. limits: in force; basis: the baseline and the limits in force, by number.

    speaking: kind and element of the machine's open alerts of a diagnosis. rates: None where nothing is to be said of rates;
    drifting: severity of the open alerts of that rule by element. baseline, after: oldest first; no baseline: nothing is
    diagnosed.
    """

    machine: Machine
    limits: Limits
    basis: tuple[int | None, int | None]
    baseline: tuple[JudgedRun, ...]
    after: tuple[JudgedRun, ...]
    speaking: tuple[tuple[str, str], ...]
    rates: History | None
    drifting: Mapping[str, Severity]


@dataclass(frozen=True)
class FoundCause:
    """A cause, what else would explain it, its size and form, and the units of its changes by name.

    began_at, began: time [ns] and identification of the run with which it most probably began.
    """

    cause: "Cause"
    runners_up: tuple["Cause", ...]
    size: "ChangeSize"
    form: str | None
    units: Mapping[str, str | None]
    began_at: int
    began: int


@dataclass(frozen=True)
class Found:
    """A diagnosis. baseline: ids that it rests on. gone: which of the question's alerts speak of nothing any more."""

    baseline: tuple[int, ...]
    causes: tuple[FoundCause, ...]
    gone: frozenset[tuple[str, str]]


@dataclass(frozen=True)
class Rates:
    """What drifts too fast, and the elements whose alerts speak of nothing any more."""

    findings: tuple["RateFinding", ...]
    gone: frozenset[str]


@dataclass(frozen=True)
class Judgement:
    """The answer. None: nothing can be said."""

    diagnosis: Found | None
    rates: Rates | None
