"""Storing the batches of a failed transaction one by one, so that a faulty batch does not block the others.

Each batch takes a transaction, all of them a second or more: they are stored in short turns, between which the ingest goes on
taking messages.
"""

import time
from collections import Counter, deque
from collections.abc import Callable, Iterable
from typing import Protocol

from sqlalchemy.exc import IntegrityError

from service.write_path.batch import HeldBatch, StoreOutcome
from service.write_path.http_queue import UNFORESEEN, NotStoring
from service.write_path.refusals import Refusals
from service.write_path.sample_writer import SampleWriter
from service.write_path.source_backoff import SourceBackoff
from storage.database.errors import is_database_wide
from storage.encoding.source_key import SourceKey

MAXIMUM_TRIES = 50
"""Largest number of batches of a source that are tried while none could be stored; the rest stays in its log."""
MAXIMUM_DOUBLINGS = 6
"""Largest number of doublings of MAXIMUM_TRIES, one per earlier failure: some batches after many bad ones may be good."""


class Acknowledgement(Protocol):
    """Acknowledges stored batches."""

    def acknowledge(self, one: HeldBatch, outcome: StoreOutcome) -> None:
        """Note that a batch's source works, and tell whoever waits for the batch."""


class SingleWrites:
    """One pass through the batches of a failed transaction. For the ingest thread only.

    Batches that cannot be stored are quarantined; sources of which nothing could be stored are reported to `backoff` at the
    end of the pass. acknowledgement: called with each batch that is stored.
    """

    def __init__(
        self, writer: SampleWriter, refusals: Refusals, backoff: SourceBackoff, acknowledgement: Acknowledgement
    ) -> None:
        self._writer = writer
        self._refusals = refusals
        self._backoff = backoff
        self._acknowledgement = acknowledgement
        self._waiting: deque[HeldBatch] = deque()
        self._left: list[HeldBatch] = []
        self._stored: set[SourceKey] = set()
        self._failed: Counter[SourceKey] = Counter()

    def __len__(self) -> int:
        """Return how many batches are held."""
        return len(self._waiting) + len(self._left)

    def begin(self, held: Iterable[HeldBatch]) -> None:
        """Begin a pass through these batches."""
        self._waiting.extend(held)

    def store_until(self, *, ends: float) -> set[SourceKey]:
        """Store batches until the time is over; return the sources that are paused, once the pass has ended.

        ends: by the monotonic clock [s]; at least one batch is tried. Raises errors that affect all batches; then `abandon`
        returns the rest.
        """
        while self._waiting:
            one = self._waiting[0]
            if one.source not in self._stored and self._failed[one.source] >= self._maximum_tries(one.source):
                self._left.append(one)
            elif self._store(one):
                self._stored.add(one.source)
            else:
                self._failed[one.source] += 1
            self._waiting.popleft()
            if self._waiting and time.monotonic() >= ends:
                return set()
        return self._end()

    def abandon(self) -> list[HeldBatch]:
        """Abandon the pass; return the batches that are neither stored nor quarantined."""
        held = [*self._left, *self._waiting]
        self._reset()
        return held

    def change(self, change: Callable[[list[HeldBatch]], list[HeldBatch]]) -> None:
        """Apply a change to the held batches."""
        self._waiting = deque(change(list(self._waiting)))
        self._left = change(self._left)

    def _store(self, one: HeldBatch) -> bool:
        """Store or quarantine a batch; return whether it was stored.

        An integrity error is retried once: the retry sees what another replica wrote at the same moment.
        """
        try:
            try:
                (outcome,) = self._writer.store([one.arrived], [])
            except IntegrityError:
                (outcome,) = self._writer.store([one.arrived], [])
        except Exception as error:
            if is_database_wide(error):
                raise
            self._refusals.quarantine(one.arrived, error, one.promise)
            return False
        self._acknowledgement.acknowledge(one, outcome)
        return True

    def _end(self) -> set[SourceKey]:
        """Refuse the untried batches, and report the sources of which nothing could be stored."""
        for one in self._left:
            if one.promise is not None:
                self._refusals.refuse(one.promise, NotStoring(UNFORESEEN))
        untried = {one.source for one in self._left}
        failed = self._failed.keys() - self._stored
        self._reset()
        for source in failed:
            self._backoff.failed(source, at_once=source in untried)
        return {source for source in failed if not self._backoff.accepts(source)}

    def _reset(self) -> None:
        self._waiting, self._left = deque(), []
        self._stored, self._failed = set(), Counter()

    def _maximum_tries(self, source: SourceKey) -> int:
        return MAXIMUM_TRIES << min(self._backoff.failures(source), MAXIMUM_DOUBLINGS)
