"""Watch over a machine after its newest run: causes that its newest runs agree on, and those that have gone.

A step shows in the newest runs at once, a creeping change only in the mean of several, in which the run-to-run variation
averages out. So windows of different lengths end at the newest run, and the shortest that shows something decides. A longer
one adds to it only where what was found lasts through all of its runs: what stands for months must not hide what creeps.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from estimator.alignment.healthy_films import stated_variation
from estimator.diagnosis.baseline_reference import Reference, reference
from estimator.diagnosis.bayes_factors import STRONG, Diagnosis, agreement, diagnose
from estimator.diagnosis.data_faults import DataFault, fits, is_trusted
from estimator.diagnosis.film_reference import film_reference
from estimator.diagnosis.finding_kind import Cause, FindingKind
from estimator.diagnosis.finding_kinds import FINDING_KINDS, finding_kind
from estimator.diagnosis.observation import Observation, with_common_errors
from estimator.machine.alignment_rules import HealthyVariation
from estimator.machine.document import Machine
from estimator.machine.film_speeds import follows_films
from estimator.machine.parameter_description import describe, is_direct

LONGEST = 3
"""Length of the longest window over the number of runs that must agree."""
OTHER_RUNS, OTHER_PART = 1.0, 0.2
"""Least that a window's runs without the one that speaks most must say together for a cause [-], and as a part of what that
one says [-], where that is less than strong by itself: one odd run is no change."""
GONE = 0.3
"""Part of the evidence it took to report a cause, below which the cause is gone [-]."""
Delay = Callable[[str, str], int]
"""Function of kind and element that returns how many runs must agree on such a cause."""


@dataclass(frozen=True)
class RunWindows:
    """A machine under watch.

    Attributes:
        baseline: The baseline's observations.
        reference: The reference that they make together.
    """

    baseline: tuple[Observation, ...]
    reference: Reference
    _explained: dict[tuple[Observation, ...], Diagnosis] = field(default_factory=dict, repr=False)

    @classmethod
    def from_baseline(
        cls, machine: Machine, baseline: Sequence[Observation], *, variation: HealthyVariation | None = None
    ) -> "RunWindows":
        """Build the watch from the observations of a healthy machine.

        Args:
            machine: The machine.
            baseline: Its observations; of a train on oil films as `film_observation` returns them.
            variation: How such a train varies while it is healthy; None for what its document says.

        Returns:
            The watch.

        Raises:
            ValueError: The baseline does not make a reference, see `reference`.
        """
        alike = with_common_errors(baseline)
        if not follows_films(machine):
            return cls(alike, reference(machine, alike))
        return cls(alike, film_reference(machine, alike, variation or stated_variation(machine)))

    def found(self, after: Sequence[Observation], *, on_delay: Delay) -> Diagnosis:
        """Find the causes that the newest of the runs after the baseline agree on.

        Args:
            after: Observations of the runs after the baseline, oldest first.
            on_delay: Function that returns how many runs must agree on a cause.

        Returns:
            The diagnosis.
        """
        after = [one.with_errors_of(self.reference.names) for one in after]
        causes: dict[tuple[str, str], tuple[Cause, tuple[Cause, ...]]] = {}
        for length in self._window_lengths(on_delay):
            if length > len(after):
                break
            found = self._diagnosis(after[-length:])
            agreed = {}
            for cause, runners_up in agreed_causes(found, on_delay):
                if not self._is_left_open(cause):
                    agreed[cause.kind, cause.element] = cause, runners_up
            if not all(key in agreed and min(agreed[key][0].agreement) > 0.0 for key in causes):
                break
            causes = agreed | causes
        order = sorted(causes.values(), key=lambda pair: -pair[0].evidence)
        return Diagnosis(tuple(cause for cause, _ in order), tuple(others for _, others in order))

    def longest(self, on_delay: Delay) -> int:
        """Return the length of the longest window of newest runs that is looked at.

        Args:
            on_delay: Function that returns how many runs must agree on a cause.

        Returns:
            Number of runs.
        """
        return max(self._window_lengths(on_delay), default=0)

    def has_gone(self, after: Sequence[Observation], kind: str, element: str, *, off_delay: int) -> bool:
        """Check whether the newest runs show a cause no more.

        Args:
            after: Observations of the runs after the baseline, oldest first.
            kind: Kind of the cause.
            element: Element of the cause.
            off_delay: Number of newest runs that must not show it.

        Returns:
            Whether it has gone.
        """
        if len(after) < off_delay:
            return False
        window = [one.with_errors_of(self.reference.names) for one in after[-off_delay:]]
        if any(self._shows_fault(one, kind, element) for one in window):
            return False
        whole = self._diagnosis(window)
        if any((cause.kind, cause.element) == (kind, element) for cause in whole.causes):
            return False
        channels = faulty_channels(whole.causes)
        place = finding_kind(kind).place
        if not all(fits(one, channels) for one in window) and not finding_kind(kind).beside_fit:
            return place == "data" and all(one.accepted for one in window)
        return self._explanation(window).evidence.get((kind, element), 0.0) < GONE * STRONG

    def began(self, cause: Cause, after: Sequence[Observation]) -> int:
        """Find the run with which a cause most probably began: from there on the runs together speak for it most.

        Args:
            cause: The cause.
            after: Observations of the runs after the baseline, oldest first.

        Returns:
            Index of the run.
        """
        if not cause.names:
            return len(after) - len(cause.agreement)
        spoken = [agreement(self.reference, cause, one.with_errors_of(self.reference.names)) for one in after]
        sums = np.cumsum(spoken[::-1])[::-1]
        return int(np.argmax(sums))

    def newest_trusted(self, cause: Cause, after: Sequence[Observation], causes: Iterable[Cause]) -> int | None:
        """Return the newest run since a cause began whose fit holds, with the errors of channels that causes are allowed for.

        Args:
            cause: The cause.
            after: Observations of the runs after the baseline, oldest first.
            causes: All causes that a diagnosis names.

        Returns:
            Index of the run; None where there is none.
        """
        channels, since = faulty_channels(causes), self.began(cause, after)
        return next((place for place in reversed(range(since, len(after))) if is_trusted(after[place], channels)), None)

    def _is_left_open(self, cause: Cause) -> bool:
        """Check whether a cause is told beyond fits only, and is less than single runs leave open of all its stiffnesses.

        What runs say together of such a change rests on derivatives that do not hold over each one's own errors.
        """
        if not finding_kind(cause.kind).beyond_fits:
            return False
        stiffness = {
            name: float(change)
            for name, change in zip(cause.names, cause.change, strict=True)
            if is_direct(name) and (term := describe(name).term) is not None and term.order == 0
        }
        left_open = self.reference.left_open
        return bool(stiffness) and all(abs(size) < left_open.get(name, 0.0) for name, size in stiffness.items())

    def _shows_fault(self, one: Observation, kind: str, element: str) -> bool:
        """Check whether the data of a single run have this fault: one that comes and goes has not gone."""
        declared = finding_kind(kind)
        declared.require_element(element)
        faults = () if declared.data_fault is None else declared.data_fault(self.baseline, [one])
        return any(fault.element == element for fault in faults)

    def _window_lengths(self, on_delay: Delay) -> list[int]:
        delays = {on_delay(one.kind, one.element) for one in self.reference.hypotheses}
        return sorted(length for delay in delays for length in (delay, delay + 1, LONGEST * delay))

    def _explanation(self, window: Sequence[Observation]) -> Diagnosis:
        """Diagnose a window once: several questions are asked about the same runs."""
        runs = tuple(window)
        if runs not in self._explained:
            self._explained[runs] = diagnose(self.reference, runs)
        return self._explained[runs]

    def _diagnosis(self, window: Sequence[Observation]) -> Diagnosis:
        """Find causes in the machine, in its channels and in the data; none of the machine where no fit explains the runs."""
        found = self._explanation(window)
        channels = faulty_channels(found.causes)
        if not all(fits(one, channels) for one in window):
            kept = [i for i, cause in enumerate(found.causes) if finding_kind(cause.kind).beside_fit]
            found = Diagnosis(tuple(found.causes[i] for i in kept), tuple(found.runners_up[i] for i in kept))
        beside = tuple(self._data_causes(window, faulty_channels(found.causes)))
        return Diagnosis((*found.causes, *beside), (*found.runners_up, *(() for _ in beside)))

    def _data_causes(self, window: Sequence[Observation], channels: frozenset[str]) -> Iterator[Cause]:
        """Yield the faults of a window's data, where these channels are known to be faulty."""
        for kind in FINDING_KINDS:
            for fault in () if kind.data_fault is None else kind.data_fault(self.baseline, window):
                yield _data_cause(kind, fault)
            for fault in () if kind.fit_fault is None else kind.fit_fault(window, channels):
                yield _data_cause(kind, fault)


def agreed_causes(found: Diagnosis, on_delay: Delay) -> Iterator[tuple[Cause, tuple[Cause, ...]]]:
    """Yield the causes that a window's newest runs agree on.

    Where runs do not agree on a cause, as before and after a step, weaker ones explain what a mean of unlike runs leaves over.

    Args:
        found: Diagnosis of the window, the strongest cause first.
        on_delay: Function that returns how many runs must agree on a cause.

    Yields:
        The causes with their runners-up; faults of the data, which each run shows by itself, whatever stands beside them.
    """
    alike = True
    for cause, runners_up in zip(found.causes, found.runners_up, strict=True):
        if runs_agree(cause, needed=on_delay(cause.kind, cause.element)):
            if alike or not cause.names:
                yield cause, runners_up
        elif cause.names:
            alike = False


def runs_agree(cause: Cause, *, needed: int) -> bool:
    """Check whether the newest runs of a window agree on a cause, and it does not rest on one odd run alone.

    Args:
        cause: The cause, with what each run of the window says for it.
        needed: How many of the newest runs must each speak for it.

    Returns:
        Whether they do. Faults of the data are seen in each run by itself, so that one may say most.
    """
    if len(cause.agreement) < needed or min(cause.agreement[-needed:]) <= 0.0:
        return False
    if not cause.names or needed == 1:
        return True
    most = max(cause.agreement)
    return math.fsum(cause.agreement) - most >= min(STRONG, max(OTHER_RUNS, OTHER_PART * most))


def faulty_channels(causes: Iterable[Cause]) -> frozenset[str]:
    """Return the channels and couplings whose errors, which fits leave out, some causes are.

    Args:
        causes: The causes.

    Returns:
        Ids of the channels, and names of the couplings.
    """
    names = (name for cause in causes if finding_kind(cause.kind).beside_fit for name in cause.names)
    return frozenset(of for name in names if (of := describe(name).error_of) is not None)


def _data_cause(kind: FindingKind, fault: DataFault) -> Cause:
    """Return a fault of the data as a cause without quantities."""
    kind.require_element(fault.element)
    evidence = math.fsum(fault.agreement)
    nothing = np.zeros(0)
    return Cause(
        kind=kind.kind,
        element=fault.element,
        evidence=evidence,
        names=(),
        change=nothing,
        covariance=np.zeros((0, 0)),
        distance=math.sqrt(2.0 * evidence),
        agreement=fault.agreement,
    )
