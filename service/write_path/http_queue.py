"""The bounded queue of bodies that came over HTTP or MQTT, to the ingest thread, each with a promise of its outcome."""

import queue
import threading
from concurrent.futures import Future
from dataclasses import dataclass, field
from typing import Protocol

from estimator.errors import LimitReached, Unavailable
from formats.wire import Rejected
from service.write_path.batch import StoreOutcome

UNFORESEEN = "unexpected error; the service's log has it"
"""Answer to whoever waits, after an unexpected error."""
QUEUE_SIZE = 1_000
"""Largest number of waiting batches; further ones are refused as busy."""
RETRY_AFTER_S = 1
"""Time after which a refused batch should be sent again [s]."""


class Busy(LimitReached):
    """Too many batches wait to be stored."""

    retry_after_s = RETRY_AFTER_S


class NotStoring(Unavailable):
    """The database does not accept samples at present; the message states the cause."""

    retry_after_s = RETRY_AFTER_S

    @property
    def detail(self) -> str:
        """Return the cause and the remedy."""
        return f"samples cannot be stored: {self}; send it again"


@dataclass(frozen=True)
class Publication:
    """A body that came through a broker: its sender waits for no answer, and never sends it again corrected.

    topic: as the quarantine shows it. plant: that it names. fault: why it is refused, where it was seen on the way.
    """

    topic: str
    plant: str
    fault: Rejected | None = None


@dataclass(frozen=True)
class Submission:
    """A body as it came, for one machine, with the promise of its outcome.

    The promise ends in a StoreOutcome once everything is durable, in Rejected, or in NotStoring. published: how it came; None
    over HTTP.
    """

    machine: str
    body: bytes
    encoding: str
    promise: Future[StoreOutcome] = field(default_factory=Future)
    published: Publication | None = None


class SubmissionSink(Protocol):
    """Acceptance of bodies: by the queue of this process's ingest, or by forwarding to another's."""

    @property
    def trouble(self) -> str | None:
        """Return why nothing can be stored at present; None when it can."""

    def offer(self, machine: str, body: bytes, encoding: str, published: Publication | None = None) -> Future[StoreOutcome]:
        """Accept a body. Raises Busy or NotStoring."""

    def __len__(self) -> int:
        """Return how many bodies wait here."""


class Submissions:
    """The queue between the API's threads, which offer, and the ingest thread, which takes."""

    def __init__(self, size: int = QUEUE_SIZE) -> None:
        self._queue: queue.Queue[Submission] = queue.Queue(size)
        self._arrival = threading.Event()
        self.trouble: str | None = None
        """Why nothing can be stored at present; None when it can."""

    def offer(self, machine: str, body: bytes, encoding: str, published: Publication | None = None) -> Future[StoreOutcome]:
        """Queue a body. Raises Busy or NotStoring."""
        if self.trouble is not None:
            raise NotStoring(self.trouble)
        one = Submission(machine, body, encoding, published=published)
        try:
            self._queue.put_nowait(one)
        except queue.Full:
            raise Busy(f"{self._queue.maxsize} batches wait to be stored") from None
        self._arrival.set()
        return one.promise

    def wait(self, seconds: float) -> None:
        """Pause until something is offered, at most `seconds`."""
        if self._arrival.wait(seconds):
            self._arrival.clear()

    def take(self) -> Submission | None:
        """Return the oldest submission that somebody still waits for; None when there is none."""
        while True:
            try:
                one = self._queue.get_nowait()
            except queue.Empty:
                return None
            if one.promise.set_running_or_notify_cancel():
                return one

    def __len__(self) -> int:
        return self._queue.qsize()
