"""A source's log in one SQLite file, bounded, that survives the end of its process at any instant.

Batches that are accepted while a transaction is on its way share the next one (group commit), so that a slow disk delays
batches and does not slow down their source. A batch is sent only when it is on the disk: what was never sent may get its
numbers again, what was sent never does.
"""

import itertools
import logging
import sqlite3
import threading
import time
import zlib
from collections import deque
from pathlib import Path

from service.source_log import (
    LARGEST_REPLY_BYTES,
    LOG_BYTES,
    LOG_SAMPLES,
    LogDamaged,
    LogEntry,
    LogError,
    LogFull,
    Logged,
    LogInUse,
    LogOfAnother,
    LogStatus,
    require_next,
)

logger = logging.getLogger(__name__)

APPLICATION_ID = 0x52444C47
"""Marks the file as a source's log: `RDLG`."""
LOG_SCHEMA = 1
MOST_PENDING = 2_000
"""Batches that may wait for the disk; the source then waits, too."""
LARGEST_GROUP = 256
"""Batches in one transaction."""
RETRY_S = 0.5
"""Pause after the disk refused to take a transaction."""
BUSY_S = 1.0
"""How long another process may take to let go of the file: one that was just killed."""
WAL_PAGES = 1_000
"""Pages after which the write-ahead log is folded into the file."""

_TABLES = """
    create table batch (
        first integer primary key, count integer not null, encoding text not null,
        crc32 integer not null, payload blob not null
    );
    create table state (
        one integer primary key check (one = 1), source text not null, epoch integer not null,
        next_sequence integer not null, position text, samples integer not null, payload_bytes integer not null
    )
"""
_DAMAGED = {sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB, sqlite3.SQLITE_FORMAT}
_IN_USE = {sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED}


class DurableLog:
    """The log of one source in a file; made if there is none.

    source: whose log it is, in any words; another's is refused. samples, payload_bytes: the oldest batches go when there are
    more, and are counted. Raises LogError.
    """

    def __init__(self, path: Path, *, source: str, samples: int = LOG_SAMPLES, payload_bytes: int = LOG_BYTES) -> None:
        self._path = path
        self._samples = samples
        self._payload_bytes = payload_bytes
        self._pending: deque[tuple[LogEntry, Logged]] = deque()
        self._changed = threading.Condition()
        self._trouble: LogError | None = None
        self._closing = False
        self._database_lock = threading.Lock()
        try:
            self._database = sqlite3.connect(path, isolation_level=None, check_same_thread=False, timeout=BUSY_S)
        except sqlite3.Error as error:
            raise self._named(error) from error
        try:
            self._open(source)
        except sqlite3.Error as error:
            self._database.close()
            raise self._named(error) from error
        except LogError:
            self._database.close()
            raise
        self._writer = threading.Thread(target=self._write, name="source-log", daemon=True)
        self._writer.start()

    def append(self, entry: LogEntry, *, logged: Logged) -> None:
        """As `SourceLog`. Waits while too much waits for the disk."""
        with self._changed:
            require_next(entry, self.next_sequence)
            self._changed.wait_for(lambda: len(self._pending) < MOST_PENDING or self._trouble or self._closing)
            if self._trouble is not None:
                raise self._trouble
            if self._closing:
                raise LogError(f"the log {self._path} is closed")
            self._pending.append((entry, logged))
            self.next_sequence += entry.count
            self._changed.notify_all()

    def entries_from(self, first: int, limit: int) -> list[LogEntry]:
        """As `SourceLog`; not more than some MB at a time. Raises LogError."""
        found: list[LogEntry] = []
        size = 0
        # One entry begins before `first` at most; the newest such one may hold it.
        query = """select first, count, payload, encoding, crc32 from batch
            where first >= coalesce((select max(first) from batch where first <= ?), ?) order by first"""
        try:
            with self._database_lock:
                for begin, count, payload, encoding, crc32 in self._database.execute(query, (first, first)):
                    if len(found) >= limit or size >= LARGEST_REPLY_BYTES:
                        break
                    if begin + count <= first:
                        continue
                    if zlib.crc32(payload) != crc32:
                        logger.error("%s: the batch from number %d is damaged and is not replayed", self._path, begin)
                        continue
                    found.append(LogEntry(begin, count, payload, encoding))
                    size += len(payload)
        except sqlite3.Error as error:
            raise self._named(error) from error
        return found

    def status(self) -> LogStatus:
        """As `SourceLog`: what is on the disk. Raises LogError."""
        try:
            with self._database_lock:
                (oldest,) = self._database.execute("select min(first) from batch").fetchone()
                next_sequence, samples, payload_bytes = self._database.execute(
                    "select next_sequence, samples, payload_bytes from state"
                ).fetchone()
        except sqlite3.Error as error:
            raise self._named(error) from error
        oldest = next_sequence if oldest is None else oldest
        dropped = next_sequence - samples
        trouble = None if self._trouble is None else str(self._trouble)
        return LogStatus(
            self.epoch, next_sequence, oldest, samples, payload_bytes, dropped, waiting=len(self._pending), trouble=trouble
        )

    def flush(self) -> None:
        """As `SourceLog`."""
        with self._changed:
            self._changed.wait_for(lambda: not self._pending or self._trouble)
            if self._trouble is not None:
                raise self._trouble

    def close(self) -> None:
        """Write what was accepted, if the disk takes it, and let go of the file."""
        with self._changed:
            self._closing = True
            self._changed.notify_all()
        self._writer.join()
        if self._pending:
            logger.error("%s: %d batches could not be written and were not sent", self._path, len(self._pending))
        with self._database_lock:
            self._database.close()

    def _open(self, source: str) -> None:
        execute = self._database.execute
        # One process at a time; the lock goes with its process.
        execute("pragma locking_mode = exclusive")
        execute("pragma journal_mode = wal")
        execute("pragma synchronous = full")
        execute(f"pragma wal_autocheckpoint = {WAL_PAGES}")
        execute("begin immediate")
        (mark,) = execute("pragma application_id").fetchone()
        (tables,) = execute("select count(*) from sqlite_master").fetchone()
        if tables == 0:
            for statement in _TABLES.split(";"):
                execute(statement)
            execute("insert into state values (1, ?, ?, 0, null, 0, 0)", (source, time.time_ns()))
            execute(f"pragma application_id = {APPLICATION_ID}")
            execute(f"pragma user_version = {LOG_SCHEMA}")
        elif mark != APPLICATION_ID:
            raise LogOfAnother(f"{self._path} is a database, but not a source's log; name another file")
        execute("commit")
        (schema,) = execute("pragma user_version").fetchone()
        if schema != LOG_SCHEMA:
            raise LogOfAnother(f"{self._path} has schema {schema}; this version knows {LOG_SCHEMA}")
        (verdict,) = execute("pragma quick_check(1)").fetchone()
        if verdict != "ok":
            raise LogDamaged(self._damage(verdict))
        owner, self.epoch, self.next_sequence, self.position = execute(
            "select source, epoch, next_sequence, position from state"
        ).fetchone()
        if owner != source:
            raise LogOfAnother(f"{self._path} is the log of {owner}, not of {source}; each source has its own")

    def _write(self) -> None:
        """The writer's thread: all that waits goes into one transaction, then out."""
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._pending or self._closing)
                group = list(itertools.islice(self._pending, LARGEST_GROUP))
            if not group:
                return
            try:
                self._commit([entry for entry, _ in group])
            except sqlite3.Error as error:
                with self._changed:
                    self._trouble = self._named(error)
                    logger.error("%s; trying again", self._trouble)
                    self._changed.notify_all()
                    if self._closing or self._changed.wait_for(lambda: self._closing, RETRY_S):
                        return
                continue
            for entry, logged in group:
                try:
                    logged(entry)
                except Exception:
                    # It is in the log; the writer must live on.
                    logger.exception("%s: the batch from number %d was not sent", self._path, entry.first)
            with self._changed:
                for _ in group:
                    self._pending.popleft()
                self._trouble = None
                self._changed.notify_all()

    def _commit(self, entries: list[LogEntry]) -> None:
        with self._database_lock:
            execute = self._database.execute
            try:
                execute("begin immediate")
                for entry in entries:
                    row = (entry.first, entry.count, entry.encoding, zlib.crc32(entry.payload), entry.payload)
                    execute("insert into batch values (?, ?, ?, ?, ?)", row)
                execute(
                    """update state set next_sequence = ?, samples = samples + ?, payload_bytes = payload_bytes + ?,
                    position = coalesce(?, position)""",
                    (
                        entries[-1].first + entries[-1].count,
                        sum(entry.count for entry in entries),
                        sum(len(entry.payload) for entry in entries),
                        next((entry.position for entry in reversed(entries) if entry.position is not None), None),
                    ),
                )
                self._drop_oldest()
                execute("commit")
            except sqlite3.Error:
                if self._database.in_transaction:
                    execute("rollback")
                raise

    def _drop_oldest(self) -> None:
        """Within the transaction: down to the bounds, but never the newest batch."""
        execute = self._database.execute
        samples, payload_bytes = execute("select samples, payload_bytes from state").fetchone()
        if samples <= self._samples and payload_bytes <= self._payload_bytes:
            return
        last = None
        rows = execute(
            "select first, count, length(payload) from batch where first < (select max(first) from batch) order by first"
        )
        for first, count, size in rows:
            if samples <= self._samples and payload_bytes <= self._payload_bytes:
                break
            samples, payload_bytes, last = samples - count, payload_bytes - size, first
        rows.close()
        if last is not None:
            execute("delete from batch where first <= ?", (last,))
            execute("update state set samples = ?, payload_bytes = ?", (samples, payload_bytes))

    def _damage(self, detail: str) -> str:
        return f"the log {self._path} is damaged ({detail}); move it away: a new one begins a new epoch"

    def _named(self, error: sqlite3.Error) -> LogError:
        """The error of SQLite in our terms."""
        code = getattr(error, "sqlite_errorcode", 0) & 0xFF
        if code in _IN_USE:
            return LogInUse(f"the log {self._path} is in use by another process: a source runs once")
        if code in _DAMAGED:
            return LogDamaged(self._damage(str(error)))
        if code == sqlite3.SQLITE_FULL:
            return LogFull(f"the log {self._path} cannot grow: {error}")
        return LogError(f"the log {self._path} cannot be used: {error}")
