"""Refusals: entries on their way to the quarantine, and answers to those who wait, given once the entries are stored."""

import logging
import time
from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import contextmanager

from service.write_path import rejections
from service.write_path.batch import ArrivedBatch, StoreOutcome
from service.write_path.http_queue import NotStoring
from service.write_path.sample_writer import SampleWriter
from storage.database.errors import is_database_wide
from storage.measurements.quarantine import Rejection

logger = logging.getLogger(__name__)


class Refusals:
    """Rejections until they are stored, and refused promises until they are answered. For the ingest thread only."""

    def __init__(self, writer: SampleWriter) -> None:
        self._writer = writer
        self._promises: list[tuple[Future[StoreOutcome], Exception]] = []
        self.rejections: list[Rejection] = []

    def reject(self, rejection: Rejection) -> None:
        """Hold an entry for the quarantine."""
        self.rejections.append(rejection)

    def refuse(self, promise: Future[StoreOutcome], answer: Exception) -> None:
        """Hold an answer until the refused batch is in the quarantine."""
        self._promises.append((promise, answer))

    @contextmanager
    def quarantining_on_error(self, arrived: ArrivedBatch, promise: Future[StoreOutcome] | None = None) -> Iterator[None]:
        """Quarantine a batch when an unexpected error occurs in the block: the error concerns this batch alone."""
        try:
            yield
        except Exception as error:
            if is_database_wide(error):
                raise
            self.quarantine(arrived, error, promise)

    def quarantine(self, arrived: ArrivedBatch, error: Exception, promise: Future[StoreOutcome] | None = None) -> None:
        """Quarantine a batch that cannot be stored, and refuse the promise of whoever waits."""
        rejection, answer = rejections.of_error(arrived, error)
        if isinstance(answer, NotStoring):
            logger.error("%s: a message cannot be stored", arrived.batch.machine, exc_info=error)
        self.reject(rejection)
        if promise is not None:
            self.refuse(promise, answer)

    def stored(self) -> None:
        """Mark all rejections as stored, and answer the senders that wait."""
        self.rejections.clear()
        self._answer()

    def store_one_by_one(self, *, ends: float) -> None:
        """Store rejections in a transaction each, so that a faulty one does not block the others.

        ends: by the monotonic clock [s]; the rest and the answers wait after it, but at least one is stored. Raises errors
        that affect all batches.
        """
        while self.rejections:
            one = self.rejections[0]
            try:
                self._writer.store([], [one])
            except Exception as error:
                if is_database_wide(error):
                    raise
                logger.exception("a message of %s, refused as %s, cannot be put aside", one.machine_id, one.reason)
            del self.rejections[0]
            if time.monotonic() >= ends:
                break
        if not self.rejections:
            self._answer()

    def fail_waiting(self, answer: Exception) -> None:
        """Answer all who wait, before the refused batches are stored."""
        for promise, _ in self._promises:
            promise.set_exception(answer)
        self._promises.clear()

    def _answer(self) -> None:
        for promise, answer in self._promises:
            promise.set_exception(answer)
        self._promises.clear()
