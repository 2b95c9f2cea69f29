"""Gap recovery: batches wait for missing ones before them while their source's log is queried. Nothing here blocks, so that a
source that does not reply delays no other.

`GapRecovery` decides which batches are accepted now and which wait. `LogReplays` queries logs for what follows the last known
sample, `GapRecall` for what was counted as lost before, and `QuietLogs` for what never came from a quiet source. Accepted
batches go to a `BatchSink`; a source that fails for a reason of its own is reported to `SourceBackoff`.
"""

import bisect
import time
from dataclasses import dataclass

import zenoh

from formats.wire import Key
from service.recovery.gap_recall import GapRecall
from service.recovery.known_logs import KnownLogs
from service.recovery.live_sources import LiveSources
from service.recovery.log_queries import LogQueries
from service.recovery.log_replay import LogReplays, Replay, is_behind_gap
from service.recovery.protocols import BatchSink, GapRecords, ReplyReader
from service.recovery.quiet_logs import QuietLogs
from service.replication.work_share import Share
from service.write_path.batch import ArrivedBatch
from service.write_path.source_backoff import SourceBackoff
from storage.encoding.source_key import SourceKey

PATIENCE_S = 3.0
"""Time for which batches behind a gap wait for the source's log, which may still be reconnecting."""
PAUSE_S = 0.3
"""Pause before a log is queried again meanwhile."""
LARGEST_WAITING = 10_000
"""Largest number of batches that wait behind one gap; further ones are left in the log."""


@dataclass
class Waiting:
    """Batches of a source that wait for those before them, in order."""

    key: Key
    deadline: float
    arrived: list[ArrivedBatch]
    next_try: float = 0.0

    def add(self, arrived: ArrivedBatch) -> None:
        """Add a batch, or leave it in the log when too many wait."""
        if len(self.arrived) < LARGEST_WAITING:
            bisect.insort(self.arrived, arrived, key=lambda one: one.batch.sequence)


class GapRecovery:
    """Decision which batches can be stored now, which wait, and which are lost. For the ingest thread only."""

    def __init__(
        self,
        session: zenoh.Session,
        *,
        sink: BatchSink,
        records: GapRecords,
        reader: ReplyReader,
        share: Share,
        backoff: SourceBackoff,
    ) -> None:
        self._sink = sink
        self._share = share
        self._backoff = backoff
        queries = LogQueries(session)
        self._logs = KnownLogs()
        self.live = LiveSources(queries)
        self._replays = LogReplays(queries, sink=sink, reader=reader, backoff=backoff, logs=self._logs)
        self._recall = GapRecall(
            queries, sink=sink, records=records, reader=reader, backoff=backoff, live=self.live, logs=self._logs
        )
        self._quiet = QuietLogs(
            queries,
            reader=reader,
            backoff=backoff,
            live=self.live,
            logs=self._logs,
            replays=self._replays,
            recall=self._recall,
        )
        self._is_stopped = False
        self.waiting: dict[SourceKey, Waiting] = {}
        backoff.call_on_pause(self.drop_source)

    @property
    def is_querying(self) -> bool:
        """Return whether replies of logs are expected."""
        return bool(len(self._replays) or len(self._recall) or len(self._quiet))

    def note_liveliness(self, token: zenoh.Sample) -> None:
        """Note that a source came or went, and have the log of a new one queried."""
        came = self.live.note_liveliness(token)
        if came is not None and self._share.is_owner(came.machine):
            self._quiet.add(came)

    def review(self) -> None:
        """Forget the state of the sources and have all logs queried: what is stored here has changed."""
        self._take_unlogged()
        self._cancel_queries()
        self._replays.forget()
        self._recall.forget()
        self._logs.forget_silences()
        self.live.forget_sources()
        for key in self.live:
            if self._share.is_owner(key.machine):
                self._quiet.add(key)

    def cease(self) -> None:
        """Stop querying, because the service ends; the next one will query the logs.

        Batches of a source whose log has never replied are accepted as they are.
        """
        self._is_stopped = True
        self._take_unlogged()
        self._cancel_queries()

    def drop_source(self, source: SourceKey) -> None:
        """Drop a source's waiting batches and queries: nothing of it is accepted for a while, and its log keeps it."""
        self.waiting.pop(source, None)
        self._replays.drop_source(source)
        self._recall.drop_source(source)

    def place(self, key: Key, arrived: ArrivedBatch) -> None:
        """Accept a published batch, hold it until missing batches before it have come, or leave it in its source's log."""
        source = arrived.source
        self._recall.note_live(key, source)
        self.live.note_activity(source)
        waiting = self.waiting.get(source)
        if not self._backoff.accepts(source):
            return
        if not is_behind_gap(arrived, self._sink):
            self._sink.take(arrived)
        elif self._is_stopped:
            if not self._logs.has_answered(source):
                self._sink.take(arrived)
        elif waiting is not None:
            waiting.add(arrived)
        elif self._logs.is_silent(source):
            self._sink.take(arrived)
        else:
            self.waiting[source] = Waiting(key, time.monotonic() + PATIENCE_S, [arrived])  # its log is asked next

    def check_tails(self, *, quiet_s: float) -> None:
        """Query each live source that was quiet for `quiet_s` for samples after the last received one."""
        self.live.query_live_sources()
        for key in self.live:
            if not self._share.is_owner(key.machine):
                continue
            sources = self.live.sources(key)
            if not sources:
                self._quiet.add(key)
            for source in sources:
                if self._logs.end_silence(source):
                    self._recall.postpone(source)
                self._recall.request_postponed(key, source)
                # While samples come, their numbers show every gap; only a quiet source can hide one.
                if self.live.is_quiet(source, quiet_s=quiet_s):
                    self._quiet.add(key, source)

    def collect(self, most: int) -> int:
        """Process replies of logs, at most `most` batches, and query again where something is missing.

        Returns the number of batches.
        """
        if self._is_stopped:
            return 0
        self.live.collect_live_sources()
        self._quiet.collect()
        for source in list(self.waiting):
            with self._backoff.pausing_on_error(source):
                self._release_if_complete(source)
        count = self._recall.collect()
        for source in self._replays.under_way():
            with self._backoff.pausing_on_error(source):
                taken, ended = self._replays.collect(source, most=most - count)
                count += taken
                if ended is not None:
                    self._continue_after(source, ended)
            if count >= most:
                return count
        for source, waiting in list(self.waiting.items()):
            if waiting.next_try <= time.monotonic():
                with self._backoff.pausing_on_error(source):
                    self._replays.query(waiting.key, source)
        return count

    def _take_unlogged(self) -> None:
        """Accept the waiting batches of sources whose logs have never replied: nobody else has them."""
        for source, waiting in list(self.waiting.items()):
            if not self._logs.has_answered(source) and self._share.is_owner(source.machine_id):
                with self._backoff.pausing_on_error(source):
                    for arrived in waiting.arrived:
                        self._sink.take(arrived)
            self.waiting.pop(source, None)

    def _cancel_queries(self) -> None:
        self.waiting.clear()
        self._replays.clear()
        self._recall.clear()
        self._quiet.clear()

    def _continue_after(self, source: SourceKey, ended: Replay) -> None:
        """Query further, let batches wait on, or give up the missing ones, after the last reply of a log."""
        self._release_if_complete(source)
        waiting = self.waiting.get(source)
        if ended.progress:
            self._replays.query(ended.key, source)
        elif waiting is not None and waiting.deadline <= time.monotonic():
            self._logs.note_silence(source)
            self._release(source)
        elif waiting is not None:
            waiting.next_try = time.monotonic() + PAUSE_S

    def _release_if_complete(self, source: SourceKey) -> None:
        waiting = self.waiting.get(source)
        if waiting is not None and not is_behind_gap(waiting.arrived[0], self._sink):
            self._release(source)

    def _release(self, source: SourceKey) -> None:
        """Place the waiting batches again: behind a further gap they wait again."""
        waiting = self.waiting[source]
        # Asks the database, if it must, before what waits is let go of.
        self._sink.next_sequence(source)
        self._recall.note_live(waiting.key, source)
        del self.waiting[source]
        for arrived in waiting.arrived:
            self.place(waiting.key, arrived)
