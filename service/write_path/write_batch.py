"""The write batch: accepted batches wait here until the end of the cycle and are stored in one transaction.

When that fails they are stored one by one (`service/write_path/single_writes.py`).
"""

import logging
import time
from collections.abc import Collection
from concurrent.futures import Future

from service.replication.work_share import lease_of
from service.resilience.bounded_dict import BoundedDict
from service.write_path.batch import LARGEST_GAP, ArrivedBatch, HeldBatch, StoreOutcome
from service.write_path.http_queue import UNFORESEEN, NotStoring
from service.write_path.refusals import Refusals
from service.write_path.sample_writer import SampleWriter
from service.write_path.single_writes import SingleWrites
from service.write_path.source_backoff import SourceBackoff
from storage.database.errors import is_database_wide
from storage.encoding.source_key import SourceKey

logger = logging.getLogger(__name__)

LONGEST_TRANSACTION_S = 0.006
"""Time after which no further batch is added to a transaction; the consequences of those in it come on top: some four times
as much."""
LONGEST_WHEN_BEHIND_S = 0.03
"""The same, at most, while more is held than transactions have time for. What a transaction costs, however little it stores,
is shared by more batches then; on a slow machine it would else take nearly all of the time."""
LONGEST_TURN_S = 0.1
"""Time after which a turn stores no further single batch: messages wait to be taken."""
FEWEST_AT_ONCE, MAXIMUM_AT_ONCE = 20, 1000
"""Limits of the batches that a transaction begins with: twice as many as the last one had time for."""


class WriteBatch:
    """The batches to be stored, and the next number of each source including them. For the ingest thread only."""

    def __init__(self, writer: SampleWriter, backoff: SourceBackoff) -> None:
        self._writer = writer
        self._backoff = backoff
        self._held: list[HeldBatch] = []
        self._at_once = FEWEST_AT_ONCE
        self._within_s = LONGEST_TRANSACTION_S
        self._expected: BoundedDict[SourceKey, int] = BoundedDict()
        self.refusals = Refusals(writer)
        self._single_writes = SingleWrites(writer, self.refusals, backoff, self)
        backoff.call_on_pause(self._forget_progress_of)

    def __len__(self) -> int:
        """Return how many batches are held."""
        return len(self._held) + len(self._single_writes)

    @property
    def is_pending(self) -> bool:
        """Return whether there is anything to store."""
        return len(self) > 0 or len(self.refusals.rejections) > 0

    def next_sequence(self, source: SourceKey) -> int:
        """Return the number of the next sample of a source, including the batches held here."""
        if source not in self._expected:
            self._expected[source] = self._writer.next_sequence(source)
        return self._expected[source]

    def take(self, arrived: ArrivedBatch, promise: Future[StoreOutcome] | None = None) -> None:
        """Hold a batch for storing."""
        source = arrived.source
        if arrived.batch.sequence - self.next_sequence(source) <= LARGEST_GAP:
            self._expected[source] = max(self.next_sequence(source), arrived.end)
        self._held.append(HeldBatch(arrived, promise))

    def store(self) -> None:
        """Store held batches in one short transaction; if that fails, one by one for a limited time.

        The rest stays held. Raises errors that affect all batches, as `SampleWriter.store` does; then nothing is lost.
        """
        if len(self._single_writes):
            self._store_one_by_one()
            return
        try:
            self._store_together()
        except Exception as error:
            if is_database_wide(error):
                raise
            logger.error("%d messages cannot be stored together; they are stored one by one", len(self._held), exc_info=error)
            self._single_writes.begin(self._held)
            self._held = []
            self._store_one_by_one()

    def store_all(self) -> None:
        """Store all held batches. Raises as `store`."""
        while self.is_pending:
            self.store()

    def drop(self, leases: Collection[str]) -> None:
        """Drop batches that another replica has to store; it fetches them from the sources' logs."""

        def owned(held: list[HeldBatch]) -> list[HeldBatch]:
            for one in held:
                if one.promise is not None and lease_of(one.source.machine_id) in leases:
                    one.promise.set_exception(NotStoring("another replica takes this machine's samples now"))
            return [one for one in held if lease_of(one.source.machine_id) not in leases]

        self._held = owned(self._held)
        self._single_writes.change(owned)
        self.forget_progress()

    def forget_progress(self) -> None:
        """Forget the next number of each source: it may have changed in the store, and is read again."""
        self._expected.clear()

    def _forget_progress_of(self, source: SourceKey) -> None:
        self._expected.pop(source, None)

    def fail_waiting(self, answer: Exception) -> None:
        """Tell all who wait that their samples are not known to be durable; the batches stay held."""

        def broken(held: list[HeldBatch]) -> list[HeldBatch]:
            for one in held:
                if one.promise is not None:
                    one.promise.set_exception(answer)
            return [HeldBatch(one.arrived) for one in held]

        self._held = broken(self._held)
        self._single_writes.change(broken)
        self.refusals.fail_waiting(answer)

    def _store_together(self) -> None:
        if self._held or self.refusals.rejections:
            arrived = [one.arrived for one in self._held[: self._at_once]]
            outcomes = self._writer.store(arrived, self.refusals.rejections, within_s=self._within_s)
            for one, outcome in zip(self._held, outcomes, strict=False):
                self.acknowledge(one, outcome)
            del self._held[: len(outcomes)]
            # What a transaction looks up for batches that it has no time for is looked up in vain.
            fitted = len(outcomes) == len(arrived)
            self._at_once = min(2 * self._at_once, MAXIMUM_AT_ONCE) if fitted else max(2 * len(outcomes), FEWEST_AT_ONCE)
            self._within_s = LONGEST_TRANSACTION_S if fitted else min(2 * self._within_s, LONGEST_WHEN_BEHIND_S)
        self.refusals.stored()

    def _store_one_by_one(self) -> None:
        """Store batches and rejections of a failed transaction each in its own, as far as the time of one turn allows.

        Batches of sources that are paused meanwhile are dropped: they stay in their logs.
        """
        ends = time.monotonic() + LONGEST_TURN_S
        try:
            self.refusals.store_one_by_one(ends=ends)
            paused = self._single_writes.store_until(ends=ends)
            if paused:
                self._drop_paused(paused)
            self.refusals.store_one_by_one(ends=ends)
        except Exception:
            self._held[:0] = self._single_writes.abandon()
            raise

    def _drop_paused(self, paused: Collection[SourceKey]) -> None:
        """Drop held batches of paused sources: they stay in their logs."""
        left = [one for one in self._held if one.source in paused]
        self._held = [one for one in self._held if one.source not in paused]
        for one in left:
            if one.promise is not None:
                self.refusals.refuse(one.promise, NotStoring(UNFORESEEN))

    def acknowledge(self, one: HeldBatch, outcome: StoreOutcome) -> None:
        """Note that a batch's source works, and tell whoever waits for the batch."""
        self._backoff.succeeded(one.source)
        if one.promise is not None:
            one.promise.set_result(outcome)
