"""The SQLite file of a source's log: written in transactions, bounded, checked when it is opened."""

import logging
import sqlite3
import threading
import time
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from service.sources.replay_log import LARGEST_REPLY_BYTES, LogDamaged, LogEntry, LogError, LogFull, LogInUse, LogOfAnother

logger = logging.getLogger(__name__)

APPLICATION_ID = 0x52444C47
"""SQLite application id that marks the file as a source's log: `RDLG`."""
LOG_SCHEMA = 1
BUSY_S = 1.0
"""Time that another process, such as one that was just killed, may take to release the file."""
WAL_PAGES = 1_000
"""Pages after which the write-ahead log is checkpointed into the file."""

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


class LogFigures(NamedTuple):
    """Contents of the file: number of the first sample, of the one behind the last, count of samples and payload bytes."""

    oldest: int
    next_sequence: int
    samples: int
    payload_bytes: int


class LogFile:
    """The log of one source in a file, created when there is none. May be used from several threads.

    source: the log's owner, in any words; another source's log is refused. samples, payload_bytes: limits beyond which the
    oldest batches are dropped. Raises LogError.
    """

    epoch: int
    next_sequence: int
    """Number of the next sample when the file was opened."""
    position: str | None
    """Position when the file was opened."""

    def __init__(self, path: Path, *, source: str, samples: int, payload_bytes: int) -> None:
        self.path = path
        self._samples = samples
        self._payload_bytes = payload_bytes
        self._lock = threading.Lock()
        with self._naming_errors():
            self._database = sqlite3.connect(path, isolation_level=None, check_same_thread=False, timeout=BUSY_S)
        try:
            with self._naming_errors():
                self._open(source)
        except LogError:
            self._database.close()
            raise

    def entries_from(self, first: int, limit: int) -> list[LogEntry]:
        """Return entries that hold sample `first` and later ones, at most `limit` and some MB. Raises LogError."""
        found: list[LogEntry] = []
        size = 0
        # Of the entries that begin before `first`, only the newest may hold it.
        query = """select first, count, payload, encoding, crc32 from batch
            where first >= coalesce((select max(first) from batch where first <= ?), ?) order by first"""
        with self._lock, self._naming_errors():
            for begin, count, payload, encoding, crc32 in self._database.execute(query, (first, first)):
                if len(found) >= limit or size >= LARGEST_REPLY_BYTES:
                    break
                if begin + count <= first:
                    continue
                if zlib.crc32(payload) != crc32:
                    logger.error("%s: the batch from number %d is damaged and is not replayed", self.path, begin)
                    continue
                found.append(LogEntry(begin, count, payload, encoding))
                size += len(payload)
        return found

    def figures(self) -> LogFigures:
        """Return the contents of the file. Raises LogError."""
        with self._lock, self._naming_errors():
            (oldest,) = self._database.execute("select min(first) from batch").fetchone()
            next_sequence, samples, payload_bytes = self._database.execute(
                "select next_sequence, samples, payload_bytes from state"
            ).fetchone()
        return LogFigures(next_sequence if oldest is None else oldest, next_sequence, samples, payload_bytes)

    def add(self, entries: list[LogEntry]) -> None:
        """Write entries in one transaction, and drop the oldest beyond the limits. Raises LogError."""
        with self._lock, self._naming_errors():
            try:
                self._insert(entries)
            except sqlite3.Error:
                if self._database.in_transaction:
                    self._database.execute("rollback")
                raise

    def close(self) -> None:
        """Close the file."""
        with self._lock:
            self._database.close()

    @contextmanager
    def _naming_errors(self) -> Iterator[None]:
        """Raise LogError for errors of SQLite in the block."""
        try:
            yield
        except sqlite3.Error as error:
            raise self._named(error) from error

    def _open(self, source: str) -> None:
        """Lock the file for this process, create missing tables, and check that it is this source's log and undamaged."""
        execute = self._database.execute
        # One process at a time; the lock ends with its process.
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
            raise LogOfAnother(f"{self.path} is a database, but not a source's log; name another file")
        execute("commit")
        (schema,) = execute("pragma user_version").fetchone()
        if schema != LOG_SCHEMA:
            raise LogOfAnother(f"{self.path} has schema {schema}; this version knows {LOG_SCHEMA}")
        (verdict,) = execute("pragma quick_check(1)").fetchone()
        if verdict != "ok":
            raise LogDamaged(self._damage(verdict))
        owner, self.epoch, self.next_sequence, self.position = execute(
            "select source, epoch, next_sequence, position from state"
        ).fetchone()
        if owner != source:
            raise LogOfAnother(f"{self.path} is the log of {owner}, not of {source}; each source has its own")

    def _insert(self, entries: list[LogEntry]) -> None:
        execute = self._database.execute
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

    def _drop_oldest(self) -> None:
        """Drop the oldest batches down to the limits, within the transaction, but never the newest batch."""
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
        return f"the log {self.path} is damaged ({detail}); move it away: a new one begins a new epoch"

    def _named(self, error: sqlite3.Error) -> LogError:
        """Return the LogError for an error of SQLite."""
        code = getattr(error, "sqlite_errorcode", 0) & 0xFF
        if code in _IN_USE:
            return LogInUse(f"the log {self.path} is in use by another process: a source runs once")
        if code in _DAMAGED:
            return LogDamaged(self._damage(str(error)))
        if code == sqlite3.SQLITE_FULL:
            return LogFull(f"the log {self.path} cannot grow: {error}")
        return LogError(f"the log {self.path} cannot be used: {error}")
