"""What comes over HTTP on its way to the ingest thread: a bounded queue, each entry with a promise of what became of it."""

import queue
import threading
from concurrent.futures import Future
from dataclasses import dataclass, field
from typing import Protocol

from estimator.errors import LimitReached, Unavailable
from service.journal.batch import StoreOutcome

UNFORESEEN = "unexpected error; the service's log has it"
"""What is answered to who waits."""
QUEUE_SIZE = 1_000
"""Batches that wait; whoever comes then is asked to come again."""
RETRY_AFTER_S = 1
"""When to send a batch again that was not taken [s]."""


class Busy(LimitReached):
    """Too many batches wait to be stored."""

    retry_after_s = RETRY_AFTER_S


class NotStoring(Unavailable):
    """The database does not take samples at present; the message says why."""

    retry_after_s = RETRY_AFTER_S

    @property
    def detail(self) -> str:
        """Say why, and what to do."""
        return f"samples cannot be stored: {self}; send it again"


@dataclass(frozen=True)
class Submission:
    """A body as it came, for one machine, and the promise of its outcome.

    The promise ends in an Outcome once everything is durable, in Rejected, or in NotStoring.
    """

    machine: str
    body: bytes
    encoding: str
    promise: Future[StoreOutcome] = field(default_factory=Future)


class SubmissionSink(Protocol):
    """Takes bodies: the queue of this process's ingest, or whatever hands them on to another's."""

    @property
    def trouble(self) -> str | None:
        """Why nothing can be stored at present."""

    def offer(self, machine: str, body: bytes, encoding: str) -> Future[StoreOutcome]:
        """Take a body. Raises Busy or NotStoring."""

    def __len__(self) -> int:
        """Return how many wait here."""


class Submissions:
    """Between the API's threads, which offer, and the ingest thread, which takes."""

    def __init__(self, size: int = QUEUE_SIZE) -> None:
        self._queue: queue.Queue[Submission] = queue.Queue(size)
        self._arrival = threading.Event()
        self.trouble: str | None = None
        """Why nothing can be stored at present."""

    def offer(self, machine: str, body: bytes, encoding: str) -> Future[StoreOutcome]:
        """Queue a body. Raises Busy or NotStoring."""
        if self.trouble is not None:
            raise NotStoring(self.trouble)
        one = Submission(machine, body, encoding)
        try:
            self._queue.put_nowait(one)
        except queue.Full:
            raise Busy(f"{self._queue.maxsize} batches wait to be stored") from None
        self._arrival.set()
        return one.promise

    def wait(self, seconds: float) -> None:
        """Pause until something is offered, at most so long."""
        if self._arrival.wait(seconds):
            self._arrival.clear()

    def take(self) -> Submission | None:
        """Return the submission that has waited longest and that somebody still waits for."""
        while True:
            try:
                one = self._queue.get_nowait()
            except queue.Empty:
                return None
            if one.promise.set_running_or_notify_cancel():
                return one

    def __len__(self) -> int:
        return self._queue.qsize()
