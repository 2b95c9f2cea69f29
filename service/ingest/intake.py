"""Intake: messages from the inbox and from the HTTP queue are admitted, and passed to gap recovery or to the write batch."""

import time

from formats.wire import Key, Rejected
from service.ingest.admission import Admission
from service.ingest.inbox import Inbox, PublishedMessage
from service.recovery.gap_recovery import GapRecovery
from service.replication.work_share import Share
from service.write_path.http_queue import UNFORESEEN, NotStoring, Submission, Submissions
from service.write_path.sample_writer import SampleWriter
from service.write_path.source_backoff import SourceBackoff
from service.write_path.write_batch import WriteBatch
from storage.database.errors import error_outline, is_database_wide

LARGEST_CYCLE = 1_000
"""Largest number of messages held at once."""
TAKING_S = 0.03
"""Time after which no further message is taken before the held ones are stored."""


class Intake:
    """Intake of messages within the limits of number and time. For the ingest thread only."""

    def __init__(
        self,
        inbox: Inbox,
        submissions: Submissions,
        writer: SampleWriter,
        *,
        admission: Admission,
        recovery: GapRecovery,
        write_batch: WriteBatch,
        backoff: SourceBackoff,
        share: Share,
    ) -> None:
        self._inbox = inbox
        self._submissions = submissions
        self._pacing = writer.pacing
        self._admission = admission
        self._recovery = recovery
        self._write_batch = write_batch
        self._backoff = backoff
        self._share = share
        self.is_behind = False
        """Whether messages were left because the time was over."""

    @property
    def room(self) -> int:
        """Return how many messages may still be held."""
        return max(0, LARGEST_CYCLE - len(self._write_batch))

    def take(self) -> int:
        """Take published messages and those that came over HTTP; return their number.

        Raises errors that affect all batches.
        """
        self.is_behind = False
        return self._take_published() + self._take_submitted()

    def _take_published(self) -> int:
        count, ends = 0, time.monotonic() + TAKING_S
        while self.room and time.monotonic() < ends and (message := self._inbox.take()) is not None:
            count += 1
            try:
                self._publication(message)
            except Exception as error:
                if is_database_wide(error):
                    self._inbox.put_back(message)
                raise
            self._pacing.pause()
        self.is_behind |= time.monotonic() >= ends
        return count

    def _take_submitted(self) -> int:
        count, ends = 0, time.monotonic() + TAKING_S
        while self.room and time.monotonic() < ends and (submission := self._submissions.take()) is not None:
            count += 1
            try:
                self._submission(submission)
            except Exception as error:
                submission.promise.set_exception(NotStoring(error_outline(error) if is_database_wide(error) else UNFORESEEN))
                raise
        self.is_behind |= time.monotonic() >= ends
        return count

    def _publication(self, message: PublishedMessage) -> None:
        """Decode a published message and place it."""
        try:
            key = Key.parse(message.key)
        except Rejected as rejected:
            if self._share.is_owner(message.key):
                self._admission.refuse(message, None, rejected)
            return
        if self._share.is_owner(key.machine) and (arrived := self._admission.published(key, message)) is not None:
            with self._write_batch.refusals.quarantining_on_error(arrived):
                self._recovery.place(key, arrived)

    def _submission(self, submission: Submission) -> None:
        """Take a batch that came over HTTP. Its source keeps no log, so that missing samples are not requested."""
        refusals = self._write_batch.refusals
        try:
            arrived = self._admission.submitted(submission)
        except (Rejected, NotStoring) as refusal:
            refusals.refuse(submission.promise, refusal)
            return
        if not self._backoff.accepts(arrived.source):
            where = f"source '{arrived.batch.source}' of machine '{submission.machine}'"
            submission.promise.set_exception(NotStoring(f"unexpected errors with {where}; it is tried again later"))
            return
        with refusals.quarantining_on_error(arrived, submission.promise):
            self._write_batch.take(arrived, submission.promise)
