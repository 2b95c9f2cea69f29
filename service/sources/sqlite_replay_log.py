"""A source's log in one SQLite file, bounded, that survives the end of its process at any moment.

Batches that are accepted during a transaction share the next one (group commit), so that a slow disk delays batches but does
not slow down their source. A batch is sent only once it is on the disk: only the numbers of batches that were never sent can
be given again.
"""

import itertools
import logging
import threading
from collections import deque
from pathlib import Path

from service.sources.replay_log import LOG_BYTES, LOG_SAMPLES, LogEntry, LogError, Logged, LogStatus, require_next
from service.sources.sqlite_log_file import LogFile

logger = logging.getLogger(__name__)

MAXIMUM_PENDING = 2_000
"""Largest number of batches that wait for the disk; beyond it the source waits, too."""
LARGEST_GROUP = 256
"""Batches in one transaction."""
RETRY_S = 0.5
"""Pause after the disk refused a transaction."""


class SqliteReplayLog:
    """The log of one source in a file, created when there is none.

    source: the log's owner, in any words; another source's log is refused. samples, payload_bytes: limits beyond which the
    oldest batches are dropped, and counted. Raises LogError.
    """

    def __init__(self, path: Path, *, source: str, samples: int = LOG_SAMPLES, payload_bytes: int = LOG_BYTES) -> None:
        self._pending: deque[tuple[LogEntry, Logged]] = deque()
        self._changed = threading.Condition()
        self._trouble: LogError | None = None
        self._closing = False
        self._file = LogFile(path, source=source, samples=samples, payload_bytes=payload_bytes)
        self.epoch = self._file.epoch
        self.next_sequence = self._file.next_sequence
        self.position = self._file.position
        # No `SupervisedThread`: a source waits for its disk, and has no service whose health would tell of it.
        self._writer = threading.Thread(target=self._write, name="source-log", daemon=True)
        self._writer.start()

    def append(self, entry: LogEntry, *, logged: Logged) -> None:
        """Accept an entry, see `SourceLog.append`. Waits while too many batches wait for the disk."""
        with self._changed:
            require_next(entry, self.next_sequence)
            self._changed.wait_for(lambda: len(self._pending) < MAXIMUM_PENDING or self._trouble or self._closing)
            if self._trouble is not None:
                raise self._trouble
            if self._closing:
                raise LogError(f"the log {self._file.path} is closed")
            self._pending.append((entry, logged))
            self.next_sequence += entry.count
            self._changed.notify_all()

    def entries_from(self, first: int, limit: int) -> list[LogEntry]:
        """Return entries, see `SourceLog.entries_from`; some MB at most. Raises LogError."""
        return self._file.entries_from(first, limit)

    def status(self) -> LogStatus:
        """Return the contents of the disk, see `SourceLog.status`. Raises LogError."""
        held = self._file.figures()
        return LogStatus(
            self.epoch,
            held.next_sequence,
            held.oldest,
            held.samples,
            held.payload_bytes,
            dropped_samples=held.next_sequence - held.samples,
            waiting=len(self._pending),
            trouble=None if self._trouble is None else str(self._trouble),
        )

    def flush(self) -> None:
        """Wait until all that was accepted is on the disk, see `SourceLog.flush`."""
        with self._changed:
            self._changed.wait_for(lambda: not self._pending or self._trouble)
            if self._trouble is not None:
                raise self._trouble

    def close(self) -> None:
        """Write what was accepted, if the disk takes it, and close the file."""
        with self._changed:
            self._closing = True
            self._changed.notify_all()
        self._writer.join()
        if self._pending:
            logger.error("%s: %d batches could not be written and were not sent", self._file.path, len(self._pending))
        self._file.close()

    def _write(self) -> None:
        """Write all pending batches in one transaction, then send them, repeatedly: the writer's thread."""
        while group := self._next_group():
            try:
                self._file.add([entry for entry, _ in group])
            except LogError as error:
                if self._is_over_after(error):
                    return
                continue
            self._send(group)
            with self._changed:
                for _ in group:
                    self._pending.popleft()
                self._trouble = None
                self._changed.notify_all()

    def _next_group(self) -> list[tuple[LogEntry, Logged]]:
        """Wait for entries; return those of the next transaction, none when the log is closed and all are written."""
        with self._changed:
            self._changed.wait_for(lambda: self._pending or self._closing)
            return list(itertools.islice(self._pending, LARGEST_GROUP))

    def _is_over_after(self, error: LogError) -> bool:
        """Record why the disk refused a transaction, wait before the next attempt, and return whether the log is being
        closed."""
        with self._changed:
            self._trouble = error
            logger.error("%s; trying again", error)
            self._changed.notify_all()
            return self._closing or bool(self._changed.wait_for(lambda: self._closing, RETRY_S))

    def _send(self, group: list[tuple[LogEntry, Logged]]) -> None:
        for entry, logged in group:
            try:
                logged(entry)
            except Exception:
                # It is in the log; the writer must go on.
                logger.exception("%s: the batch from number %d was not sent", self._file.path, entry.first)
