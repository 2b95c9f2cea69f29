"""One cycle of the ingest: messages are taken and stored, what is missing is fetched, what is due is checked.

`Intake` takes messages, `Admission` makes batches of them, `GapRecovery` fetches what is missing before them, `WriteBatch`
stores them. `SourceBackoff` knows of which sources nothing can be stored for now.
"""

import logging

import zenoh

from service.ingest.admission import Admission
from service.ingest.clock_doubt import OwnClock
from service.ingest.inbox import Inbox
from service.ingest.intake import Intake
from service.ingest.periodic_checks import IngestChecks
from service.ingest.received_queryable import ReceivedQueryable
from service.journal.http_queue import NotStoring, Submissions
from service.journal.journal import Journal
from service.journal.source_backoff import SourceBackoff
from service.journal.write_batch import WriteBatch
from service.recovery.gap_recovery import GapRecovery
from service.replication.work_share import Share
from service.wire import ALL_LIVE, ALL_SAMPLES
from storage.database.errors import LeaseLost

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


class IngestCycle:
    """The parts of the ingest, and the order in which they have their turn. For the ingest thread only, but for figures."""

    def __init__(
        self, session: zenoh.Session, journal: Journal, submissions: Submissions, share: Share, *, silence_s: float
    ) -> None:
        self._session = session
        self._journal = journal
        self._submissions = submissions
        self._share = share
        self._changes = share.changes
        self.own_clock = OwnClock(journal.newest_receipt)
        self.backoff = SourceBackoff()
        self.write_batch = WriteBatch(journal, self.backoff)
        admission = Admission(journal, self.write_batch.refusals, self.own_clock)
        self.recovery = GapRecovery(
            session, sink=self.write_batch, records=journal, reader=admission, share=share, backoff=self.backoff
        )
        self.inbox = Inbox()
        self._intake = Intake(
            self.inbox,
            submissions,
            journal,
            admission=admission,
            recovery=self.recovery,
            write_batch=self.write_batch,
            backoff=self.backoff,
            share=share,
        )
        self._received = ReceivedQueryable(session, journal, share)
        self.checks = IngestChecks(journal, self.recovery, self.own_clock, silence_s=silence_s)

    def open(self) -> None:
        """Subscribe."""
        self.inbox.open(self._session, ALL_SAMPLES)
        self._tokens = self._session.liveliness().declare_subscriber(
            ALL_LIVE, zenoh.handlers.FifoChannel(TOKENS), history=True
        )
        self._received.open()

    def close(self) -> None:
        """Let nothing come any more."""
        self.inbox.close()
        self._tokens.undeclare()
        self._received.close()

    def run(self, *, stopping: bool) -> int:
        """Take and store what has come; do the checks that are due. Returns how many messages were taken.

        stopping: take nothing that comes from now on, for the service ends: it waits in the sources' logs.
        """
        left = self.write_batch.is_pending
        self.write_batch.store()  # what was left before; where the database refuses it, nothing more is taken
        self._follow_share()
        while (token := self._tokens.try_recv()) is not None:
            self.recovery.follow(token)
        self._received.answer_waiting()
        if stopping:
            self.inbox.close()
            self.recovery.cease()
        self._journal.pacing.begin(hurried=len(self.inbox) >= BACKLOG or self.recovery.is_asking)
        count = self._intake.take()
        count += self.recovery.collect(min(self._intake.room, LARGEST_COLLECTION))
        if not left:
            self.write_batch.store()
        self.checks.look_at_clock()
        if not stopping:
            self.checks.check_if_due()
        return count

    @property
    def has_more(self) -> bool:
        """Whether there is more to store or to take at once."""
        return self.write_batch.is_pending or self._intake.is_behind

    def wait_for_more(self, count: int) -> None:
        """Pause after a cycle with so many messages, until something is submitted, unless there is more to do at once."""
        asking = self.recovery.is_asking
        if not self.has_more and (count == 0 or (count < BACKLOG and not asking)):
            self._submissions.wait(RECOVERY_CYCLE_S if asking else CYCLE_S)

    def refuse_all(self, trouble: str) -> None:
        """Tell all who wait that what they sent is not known to be durable, and why."""
        self.write_batch.forget_progress()
        self.write_batch.fail_waiting(NotStoring(trouble))
        while (submission := self._submissions.take()) is not None:
            submission.promise.set_exception(NotStoring(trouble))

    def drop_taken_over(self, error: LeaseLost) -> None:
        """Drop what is another replica's to store."""
        logger.warning("machines were taken over by another replica: %s", error)
        self.write_batch.drop(error.names)
        self._journal.forget()

    def _follow_share(self) -> None:
        """Begin anew with what is known of the sources, where the share of this process has changed."""
        if self._changes == self._share.changes:
            return
        self.write_batch.store_all()
        self.write_batch.forget_progress()
        self._journal.forget()
        self.own_clock.forget()
        changes = self._share.changes
        self.recovery.review()
        self._changes = changes  # reviewed again where the database went away within
