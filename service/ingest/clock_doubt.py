"""Doubting this machine's own clock, by its newest receipt of samples and by the times that its sources report.

With a clock that is behind, live samples seem to lie in the future. They are then not rejected, which would use up their
numbers, but left with their senders until the clock is right. `docs/operators.md` has the rule as a table.
"""

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass

from formats.wire import SampleBatch
from service.resilience.bounded_dict import BoundedDict
from storage.clock import FUTURE_TOLERANCE, now, to_datetime

logger = logging.getLogger(__name__)

SECOND = 1_000_000_000
HEARD_LATELY = 3600 * SECOND
"""Time for which a source's time counts after its last batch [ns]: its clock has gone on as the monotonic one has."""
STEADY, JITTER = 60 * SECOND, 30 * SECOND
"""A source agrees once its newest times have kept pace with the monotonic clock for this long [ns], within JITTER: times from
a log that is catching up overtake the clock."""
PLAUSIBLE = 100 * 365 * 86_400 * SECOND
"""No clock is further behind than this [ns], not even one that begins in 1970 at each start."""
COST = 20_000
"""Time between two evaluations of the sources' times, for each source [ns]: an evaluation takes a twentieth of it."""


def is_doubted(*, behind: bool, ahead: int, agreeing: int) -> bool:
    """Return whether the own clock is to be doubted.

    behind: whether the clock is behind the newest receipt of samples. ahead, agreeing: number of sources whose newest samples
    lie ahead of the clock, and of sources whose newest samples agree with it.
    """
    if behind:
        return ahead >= agreeing
    return ahead >= 2 and ahead > agreeing


@dataclass
class _Source:
    """The time reported by a source, as differences to the monotonic clock [ns].

    first, last: first and last time of its newest batch; heard: when that came. pace: `last` when it began to be steady, which
    was at `since`.
    """

    first: int
    last: int
    heard: int
    pace: int
    since: int

    def is_ahead(self, clock: int, monotonic: int) -> bool:
        return self.first + monotonic > clock + FUTURE_TOLERANCE

    def agrees(self, clock: int, monotonic: int) -> bool:
        return self.heard - self.since >= STEADY and abs(self.last + monotonic - clock) <= FUTURE_TOLERANCE


class OwnClock:
    """Assessment of this machine's clock. For the ingest thread only, except `doubt`.

    newest_receipt: looks up when the newest stored samples came [ns]; 0 before any.
    """

    def __init__(self, newest_receipt: Callable[[], int]) -> None:
        self._look_up = newest_receipt
        self._newest_receipt: int | None = None
        self._sources: BoundedDict[tuple[str, str], _Source] = BoundedDict()
        self._assessed_at = 0
        self.doubt: str | None = None
        """Why the clock is doubted, and the remedy; None while it is not."""

    def withholds(self, batch: SampleBatch) -> bool:
        """Return whether a batch must wait until the clock is right. Raises the database's errors."""
        clock, monotonic = now(), time.monotonic_ns()
        first, last = min(batch.time_ns), max(batch.time_ns)
        if not clock - PLAUSIBLE <= first <= last <= clock + PLAUSIBLE:
            return False
        self._update_source((batch.machine, batch.source), first - monotonic, last - monotonic, monotonic)
        if last <= clock + FUTURE_TOLERANCE:
            self._newest_receipt = max(self._known_receipt(), clock)
            return False
        self._assess_if_due(clock, monotonic)
        return self.doubt is not None

    def assess(self) -> bool:
        """Assess the clock again; return whether a doubt has ended."""
        clock, before = now(), self.doubt
        if before is None and self._known_receipt() <= clock + FUTURE_TOLERANCE:
            return False
        self._assess_if_due(clock, time.monotonic_ns())
        return before is not None and self.doubt is None

    def forget(self) -> None:
        """Forget the newest receipt of samples; it is looked up again, since other replicas may have stored some."""
        self._newest_receipt = None

    def _known_receipt(self) -> int:
        if self._newest_receipt is None:
            self._newest_receipt = self._look_up()
        return self._newest_receipt

    def _update_source(self, name: tuple[str, str], first: int, last: int, monotonic: int) -> None:
        before = self._sources.pop(name, None)
        if before is not None and abs(last - before.pace) <= JITTER:
            self._sources[name] = _Source(first, last, monotonic, before.pace, before.since)
        else:
            self._sources[name] = _Source(first, last, monotonic, last, monotonic)

    def _assess_if_due(self, clock: int, monotonic: int) -> None:
        if monotonic - self._assessed_at >= COST * len(self._sources):
            self._assessed_at = monotonic
            self._assess(clock, monotonic)

    def _assess(self, clock: int, monotonic: int) -> None:
        receipt = self._known_receipt()
        heard = [(name, one) for name, one in self._sources.items() if monotonic - one.heard <= HEARD_LATELY]
        # A machine counts once, however many sources it has.
        first = {machine: one.first + monotonic for (machine, _), one in heard if one.is_ahead(clock, monotonic)}
        ahead, agreeing = list(first.values()), len({machine for (machine, _), one in heard if one.agrees(clock, monotonic)})
        behind = receipt > clock + FUTURE_TOLERANCE
        before, doubt = self.doubt, None
        if is_doubted(behind=behind, ahead=len(ahead), agreeing=agreeing):
            doubt = _words(clock, receipt if behind else None, ahead)
        elif behind:
            self._newest_receipt = clock  # the earlier receipts were wrong: the clock was ahead then
        self.doubt = doubt  # assigned once: the API reads it at any moment
        if doubt is not None and before is None:
            logger.error(doubt)
        elif doubt is None and before is not None:
            logger.warning("this machine's clock is not doubted any more")


def _words(clock: int, receipt: int | None, ahead: list[int]) -> str:
    why = []
    if receipt is not None:
        why.append(f"the newest samples came at {_time(receipt)} by it, which is {_span(receipt - clock)} later")
    if ahead:
        middle = sorted(ahead)[len(ahead) // 2]
        who = "a source says" if len(ahead) == 1 else f"{len(ahead)} sources say"
        why.append(f"{who} that it is {_time(middle)}, which is {_span(middle - clock)} later")
    until = "Set it (NTP): samples that are ahead of it are not taken until then"
    return f"this machine's clock ({_time(clock)}) is behind: {'; '.join(why)}. {until}"


def _time(nanoseconds: int) -> str:
    return f"{to_datetime(nanoseconds):%Y-%m-%d %H:%M:%S} UTC"


def _span(nanoseconds: int) -> str:
    seconds = nanoseconds / SECOND
    for unit, size in (("days", 86_400), ("hours", 3600)):
        if seconds >= 2 * size:
            return f"{seconds / size:.1f} {unit}"
    return f"{seconds / 60:.0f} minutes"
