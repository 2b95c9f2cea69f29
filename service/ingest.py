"""Ingest: the thread that takes what zenoh and HTTP deliver and stores it, and goes on whatever happens.

`Intake` takes messages, `Admission` makes batches of them, `GapRecovery` fetches what is missing before them, `WriteBatch`
stores them. `SourceBackoff` knows of which sources nothing can be stored for now.
"""

import logging
import time

import zenoh

from service.admission import Admission
from service.clock_doubt import OwnClock
from service.healing import GapRecovery
from service.inbox import Inbox
from service.ingest_checks import IngestChecks
from service.intake import Intake
from service.journal import Journal
from service.received_queryable import ReceivedQueryable
from service.sharing import Share, Whole
from service.source_backoff import SourceBackoff
from service.storing import WriteBatch
from service.submissions import NotStoring, Submissions
from service.supervised_thread import UNEXPECTED, SupervisedThread
from service.wire import ALL_LIVE, ALL_SAMPLES
from storage.errors import concerns_all, words
from storage.leases import NotHeld
from storage.longest import Longest

logger = logging.getLogger(__name__)

TOKENS = 50_000
"""Comings and goings of sources that wait."""
LARGEST_COLLECTION = 200
"""Of the messages that logs answer, taken at once."""
CYCLE_S = 0.1
"""What comes within this time is stored together, as far as it is not much, …"""
BACKLOG = 200
"""… unless so many messages have come: then there is no pause."""
RECOVERY_CYCLE_S = 0.05
"""Pause between looks for what logs answer."""
STALLED_S = 5.0
"""A cycle that lasts longer waits for the database, and the service is not ready."""
RETRY_S = 1.0
"""Pause after the database refused to store."""
LAST_TRIES = 2
"""To store what is held, of a service that ends."""


class Ingest(SupervisedThread):
    """The thread. Callbacks only enqueue; everything else happens here."""

    def __init__(
        self,
        session: zenoh.Session,
        journal: Journal,
        *,
        silence_s: float,
        submissions: Submissions | None = None,
        share: Share | None = None,
    ) -> None:
        super().__init__("ingest", failure="samples cannot be stored", retry_s=RETRY_S)
        self._session = session
        self._journal = journal
        self._submissions = Submissions() if submissions is None else submissions
        self._share = share or Whole()
        self._changes = self._share.changes
        self._own_clock = OwnClock(journal.newest_receipt)
        self._backoff = SourceBackoff()
        self._write_batch = WriteBatch(journal, self._backoff)
        admission = Admission(journal, self._write_batch.refusals, self._own_clock)
        self._recovery = GapRecovery(
            session, sink=self._write_batch, records=journal, reader=admission, share=self._share, backoff=self._backoff
        )
        self._inbox = Inbox()
        self._intake = Intake(
            self._inbox,
            self._submissions,
            journal,
            admission=admission,
            recovery=self._recovery,
            write_batch=self._write_batch,
            backoff=self._backoff,
            share=self._share,
        )
        self._received = ReceivedQueryable(session, journal, self._share)
        self._checks = IngestChecks(journal, self._recovery, self._own_clock, silence_s=silence_s)
        self._longest_cycle = Longest()
        self._errors = 0  # that nobody foresaw, in a row
        self._began = time.monotonic()  # the cycle

    def start(self) -> None:
        """Subscribe and begin."""
        self._inbox.open(self._session, ALL_SAMPLES)
        self._tokens = self._session.liveliness().declare_subscriber(
            ALL_LIVE, zenoh.handlers.FifoChannel(TOKENS), history=True
        )
        self._received.open()
        super().start()

    def stop(self) -> None:
        """Take no more, store what is queued, end the thread."""
        super().stop()
        self._inbox.close()
        self._tokens.undeclare()
        self._received.close()

    @property
    def trouble(self) -> str | None:
        """Why the last cycle could not be stored, or that the present one does not end."""
        lasts = time.monotonic() - self._began
        if self._trouble is None and lasts > STALLED_S and self.alive:
            return f"storing has not ended for {lasts:.0f} s"
        return self._trouble or self._checks.trouble

    @trouble.setter
    def trouble(self, words: str | None) -> None:
        self._trouble = words

    @property
    def alive(self) -> bool:
        """Whether the threads run."""
        return super().alive and self._inbox.alive

    @property
    def gauges(self) -> dict[str, float]:
        """Figures for a monitoring system, by the name of the metric."""
        return {
            "rundown_ingest_queue_messages": len(self._inbox),
            "rundown_ingest_queue_bytes": self._inbox.size,
            "rundown_ingest_longest_cycle_seconds": self._longest_cycle.seconds,
            "rundown_clock_doubted": int(self._own_clock.doubt is not None),
        }

    @property
    def warnings(self) -> list[str]:
        """What does not hinder all of it and should be seen to."""
        return [] if self._own_clock.doubt is None else [self._own_clock.doubt]

    def turn(self) -> float:
        """Do a cycle, then wait until more has come or is to be looked for."""
        self._wait_for_more(self._cycle(stopping=False))
        return 0.0

    def finish(self) -> None:
        """Store what is queued, and end when there is no more, or when it cannot be stored."""
        tries = LAST_TRIES
        while True:
            try:
                count = self._cycle(stopping=True)
            except Exception as error:  # noqa: BLE001 - `failed` logs it
                pause = self.failed(error)
                if self._is_told(error):
                    tries -= 1
                    if tries == 0:
                        self._give_up(error)
                        return
                    time.sleep(pause)
                continue
            if count == 0 and not self._has_more:
                return
            self._wait_for_more(count)

    def failed(self, error: Exception) -> float:
        """Go on after an error: one message must never end the ingest of all others."""
        if isinstance(error, NotHeld):
            self._drop_taken_over(error)
            return CYCLE_S
        if concerns_all(error):
            logger.error("samples cannot be stored, trying again: %s", words(error))
            self._tell(words(error))
            return RETRY_S
        logger.error("unexpected error in ingest, going on", exc_info=error)
        self._errors += 1
        if not self._is_told(error):
            return 0.0
        self._tell(UNEXPECTED)
        return RETRY_S

    def _is_told(self, error: Exception) -> bool:
        """Return whether an error hinders storing: the first unforeseen one in a row does not."""
        return not isinstance(error, NotHeld) and (concerns_all(error) or self._errors > 1)

    def _give_up(self, error: Exception) -> None:
        """Say how much is given up of what could not be stored while stopping."""
        count = len(self._inbox) + len(self._write_batch)
        logger.error("at the end %d messages are not stored; only sources' logs have them still: %s", count, words(error))

    def _tell(self, trouble: str) -> None:
        """Say why nothing is stored; to all who wait, that what they sent is not known to be durable."""
        self.trouble = self._submissions.trouble = trouble
        self._write_batch.forget_progress()
        self._write_batch.break_promises(NotStoring(trouble))
        while (submission := self._submissions.take()) is not None:
            submission.promise.set_exception(NotStoring(trouble))

    def _drop_taken_over(self, error: NotHeld) -> None:
        """Drop what is another replica's to store."""
        logger.warning("machines were taken over by another replica: %s", error)
        self._write_batch.drop(error.names)
        self._journal.forget()

    def _cycle(self, *, stopping: bool) -> int:
        """Take and store what has come; do the checks that are due. Returns how many messages there were."""
        self._began = time.monotonic()
        with self._longest_cycle.measured():
            count = self._take_and_store()
            self._checks.look_at_clock()
            if not stopping:
                self._checks.check_if_due()
        self.trouble = self._submissions.trouble = None
        self._errors = 0
        return count

    def _take_and_store(self) -> int:
        """Take what is queued, as much as there is room and time for, and store as much as a short transaction takes.

        Returns how many messages were taken.
        """
        left = self._write_batch.is_pending
        self._write_batch.store()  # what was left before; where the database refuses it, nothing more is taken
        self._follow_share()
        while (token := self._tokens.try_recv()) is not None:
            self._recovery.follow(token)
        self._received.answer_waiting()
        if self._stop.is_set():
            self._inbox.close()  # what comes from now on waits in the sources' logs
            self._recovery.cease()
        self._journal.pacing.begin(hurried=len(self._inbox) >= BACKLOG or self._recovery.is_asking)
        count = self._intake.take()
        count += self._recovery.collect(min(self._intake.room, LARGEST_COLLECTION))
        if not left:
            self._write_batch.store()
        return count

    def _follow_share(self) -> None:
        """Begin anew with what is known of the sources, where the share of this process has changed."""
        if self._changes == self._share.changes:
            return
        self._write_batch.store_all()
        self._write_batch.forget_progress()
        self._journal.forget()
        self._own_clock.forget()
        changes = self._share.changes
        self._recovery.review()
        self._changes = changes  # reviewed again where the database went away within

    @property
    def _has_more(self) -> bool:
        """Whether there is more to store or to take at once."""
        return self._write_batch.is_pending or self._intake.is_behind

    def _wait_for_more(self, count: int) -> None:
        """Pause after a cycle with so many messages, until something is submitted, unless there is more to do at once."""
        asking = self._recovery.is_asking
        if not self._has_more and (count == 0 or (count < BACKLOG and not asking)):
            self._submissions.wait(RECOVERY_CYCLE_S if asking else CYCLE_S)
