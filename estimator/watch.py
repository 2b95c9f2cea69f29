"""What is to be said of a machine after its newest run: causes that its newest runs agree on, and those that have gone.

A step shows in the newest runs at once, a creeping change only in the mean of several, in which the run-to-run variation
averages out. So windows of different lengths end at the newest run, and the shortest that shows something decides.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from estimator.data_faults import CHANNEL_KINDS, explained_channels, fits, lost_channels, many_outliers, misfit
from estimator.diagnosis import STRONG, Cause, Diagnosis, Reference, diagnose
from estimator.observation import Observation

LONGEST = 3
"""The longest window has so many times as many runs as must agree."""
GONE = 0.3
"""A cause that was said to be there is gone when its evidence falls below this part of what it took to say so."""


@dataclass(frozen=True)
class Statement:
    """causes: with their runners-up, strongest first. runs: of the window that showed them. standing: (kind, element) of all
    that cannot be said to be gone."""

    causes: tuple[Cause, ...]
    runners_up: tuple[tuple[Cause, ...], ...]
    runs: int
    standing: frozenset[tuple[str, str]]


def window_lengths(on_delay: int) -> tuple[int, ...]:
    """Numbers of runs that are looked at together, shortest first, where so many must agree."""
    return tuple(sorted({on_delay, on_delay + 1, LONGEST * on_delay}))


def statement(
    baseline: Sequence[Observation], reference: Reference, after: Sequence[Observation], *, on_delay: int, off_delay: int
) -> Statement:
    """What the runs after the baseline, oldest first, say. on_delay: so many newest runs must agree before a cause is named.

    off_delay: so many must show a cause no more before it is gone.
    """
    found = Diagnosis((), ())
    runs = 0
    for length in window_lengths(on_delay):
        if length > len(after):
            break
        found, runs = _agreed(baseline, reference, after[-length:], on_delay), length
        if found.causes:
            break
    standing = {(cause.kind, cause.element) for cause in found.causes}
    if after:
        standing |= _standing(baseline, reference, after[-off_delay:])
    if len(after) < off_delay:
        standing |= {(one.kind, one.element) for one in reference.hypotheses}
    return Statement(found.causes, found.runners_up, runs, frozenset(standing))


def _agreed(baseline: Sequence[Observation], reference: Reference, window: Sequence[Observation], on_delay: int) -> Diagnosis:
    """The diagnosis of a window, without causes that not every one of the newest runs agrees on."""
    found = _whole(baseline, reference, window)
    kept = [i for i, cause in enumerate(found.causes) if min(cause.agreement[-on_delay:]) > 0.0]
    return Diagnosis(tuple(found.causes[i] for i in kept), tuple(found.runners_up[i] for i in kept))


def _whole(baseline: Sequence[Observation], reference: Reference, window: Sequence[Observation]) -> Diagnosis:
    """Causes in the machine, in its channels and in the data; nothing of the machine where no fit explains the runs."""
    found = diagnose(reference, window)
    channels = explained_channels(found)
    if not all(fits(one, channels) for one in window):
        kept = [i for i, cause in enumerate(found.causes) if cause.kind in CHANNEL_KINDS]
        found = Diagnosis(tuple(found.causes[i] for i in kept), tuple(found.runners_up[i] for i in kept))
    beside = (*lost_channels(baseline, window), *misfit(window, found), *many_outliers(window))
    return Diagnosis((*found.causes, *beside), (*found.runners_up, *(() for _ in beside)))


def _standing(baseline: Sequence[Observation], reference: Reference, window: Sequence[Observation]) -> set[tuple[str, str]]:
    """What some evidence is left for in the newest runs."""
    found = diagnose(reference, window)
    whole = _whole(baseline, reference, window)
    left = {key for key, evidence in found.evidence.items() if evidence >= GONE * STRONG}
    return left | {(cause.kind, cause.element) for cause in whole.causes}
