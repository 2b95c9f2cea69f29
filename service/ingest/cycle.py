"""One cycle of the ingest: store messages, recover missing ones, run the checks that are due.

`Intake` takes messages, `Admission` makes batches of them, `GapRecovery` fetches missing ones from the sources' logs,
`WriteBatch` stores them. `SourceBackoff` knows the sources of which nothing can be stored at present.
"""

import logging
import math
import time

import zenoh

from formats.wire import ALL_LIVE, ALL_SAMPLES
from service.ingest.admission import Admission
from service.ingest.clock_doubt import OwnClock
from service.ingest.inbox import Inbox
from service.ingest.intake import Intake
from service.ingest.periodic_checks import IngestChecks
from service.ingest.received_queryable import ReceivedQueryable
from service.recovery.gap_recovery import GapRecovery
from service.replication.work_share import Share
from service.write_path.http_queue import NotStoring, Submissions
from service.write_path.sample_writer import SampleWriter
from service.write_path.source_backoff import SourceBackoff
from service.write_path.write_batch import WriteBatch
from storage.database.errors import LeaseLost

logger = logging.getLogger(__name__)

TOKENS = 50_000
"""Largest number of queued liveliness events of sources."""
LARGEST_COLLECTION = 200
"""Largest number of replies from logs taken at once."""
CYCLE_S = 0.1
"""Pause between cycles [s]: messages that arrive meanwhile are stored together."""
BACKLOG = 200
"""Number of messages in a cycle from which on the next one begins without a pause."""
RECOVERY_CYCLE_S = 0.05
"""Pause between looks for replies from logs."""


class IngestCycle:
    """The parts of the ingest and the order of their turns. For the ingest thread only, except its figures."""

    def __init__(
        self, session: zenoh.Session, writer: SampleWriter, submissions: Submissions, share: Share, *, silence_s: float
    ) -> None:
        self._session = session
        self._writer = writer
        self._submissions = submissions
        self._share = share
        self._changes = share.changes
        self.own_clock = OwnClock(writer.newest_receipt)
        self.backoff = SourceBackoff()
        self.write_batch = WriteBatch(writer, self.backoff)
        admission = Admission(writer, self.write_batch.refusals, self.own_clock)
        self.recovery = GapRecovery(
            session, sink=self.write_batch, records=writer, reader=admission, share=share, backoff=self.backoff
        )
        self.inbox = Inbox()
        self._intake = Intake(
            self.inbox,
            submissions,
            writer,
            admission=admission,
            recovery=self.recovery,
            write_batch=self.write_batch,
            backoff=self.backoff,
            share=share,
        )
        self._received = ReceivedQueryable(session, writer, share)
        self._took = -math.inf
        self.checks = IngestChecks(writer, self.recovery, self.own_clock, silence_s=silence_s)

    def open(self) -> None:
        """Declare the subscriptions."""
        self.inbox.open(self._session, ALL_SAMPLES)
        self._tokens = self._session.liveliness().declare_subscriber(
            ALL_LIVE, zenoh.handlers.FifoChannel(TOKENS), history=True
        )
        self._received.open()

    def close(self) -> None:
        """Undeclare the subscriptions."""
        self.inbox.close()
        self._tokens.undeclare()
        self._received.close()

    def run(self, *, stopping: bool) -> int:
        """Store the messages that have come and do the checks that are due; return how many messages were taken.

        stopping: take nothing that comes from now on, because the service ends: it waits in the sources' logs.
        """
        left = self.write_batch.is_pending
        self.write_batch.store()  # what was left before; where the database refuses it, nothing more is taken
        self._follow_share()
        while (token := self._tokens.try_recv()) is not None:
            self.recovery.note_liveliness(token)
        self._received.answer_waiting()
        if stopping:
            self.inbox.close()
            self.recovery.cease()
        without_pauses = stopping or len(self.inbox) >= BACKLOG or self.recovery.is_querying
        self._writer.pacing.begin(without_pauses=without_pauses)
        # Beside what was left, the few messages that have come since would each cost a transaction: they wait for the others.
        waits = left and not without_pauses and not stopping and time.monotonic() < self._took + CYCLE_S
        count = 0 if waits else self._take()
        if not left:
            self.write_batch.store()
        self.checks.check_clock()
        if not stopping:
            self.checks.check_if_due()
        return count

    def _take(self) -> int:
        """Take the messages that have come; return their number."""
        self._took = time.monotonic()
        return self._intake.take() + self.recovery.collect(min(self._intake.room, LARGEST_COLLECTION))

    @property
    def has_more(self) -> bool:
        """Return whether there is more to store or to take at once."""
        return self.write_batch.is_pending or self._intake.is_behind

    def wait_for_more(self, count: int) -> None:
        """Pause after a cycle of `count` messages until something is submitted, unless there is more to do at once."""
        querying = self.recovery.is_querying
        if not self.has_more and (count == 0 or (count < BACKLOG and not querying)):
            self._submissions.wait(RECOVERY_CYCLE_S if querying else CYCLE_S)

    def refuse_all(self, trouble: str) -> None:
        """Tell all who wait that their samples are not known to be durable, and why."""
        self.write_batch.forget_progress()
        self.write_batch.fail_waiting(NotStoring(trouble))
        while (submission := self._submissions.take()) is not None:
            submission.promise.set_exception(NotStoring(trouble))

    def drop_taken_over(self, error: LeaseLost) -> None:
        """Drop batches that another replica has to store now."""
        logger.warning("machines were taken over by another replica: %s", error)
        self.write_batch.drop(error.names)
        self._writer.forget()

    def _follow_share(self) -> None:
        """Forget the state of the sources when the share of this process has changed."""
        if self._changes == self._share.changes:
            return
        self.write_batch.store_all()
        self.write_batch.forget_progress()
        self._writer.forget()
        self.own_clock.forget()
        changes = self._share.changes
        self.recovery.review()
        self._changes = changes  # reviewed again where the database went away within
