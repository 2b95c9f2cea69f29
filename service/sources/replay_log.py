"""The log of the batches that a source published, from which it replies to replay queries.

`MemoryLog` lives as long as its process. `service/sources/sqlite_replay_log.py` outlives it.
"""

import itertools
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

LOG_SAMPLES = 200_000
"""Samples kept for replay."""
LOG_BYTES = 256 << 20
"""Bytes of payload kept for replay."""
LARGEST_REPLY_COUNT = 2_000
"""Largest number of batches in the reply to one query."""
LARGEST_REPLY_BYTES = 8 << 20
"""Largest number of bytes in the reply to one query; the receiver then asks again."""

Logged = Callable[["LogEntry"], None]
"""Callback that receives each entry once it is in the log, in order."""


class LogError(RuntimeError):
    """The log cannot be used; the message states the cause. A refused entry is neither in the log nor on the wire."""


class LogInUse(LogError):
    """Another process has the log open: a source runs once."""


class LogDamaged(LogError):
    """The file is not a log, or is broken."""


class LogFull(LogError):
    """The disk is full."""


class LogOfAnother(LogError):
    """The log belongs to another source, or was written by a newer version."""


@dataclass(frozen=True)
class LogEntry:
    """A batch as published: number of its first sample, number of samples, payload and the payload's zenoh encoding.

    position: how far the source has read its own input when this batch is sent, in the source's own format; None for no
    position.
    """

    first: int
    count: int
    payload: bytes
    encoding: str
    position: str | None = None


@dataclass(frozen=True)
class LogStatus:
    """Contents of a log, and what it has dropped.

    oldest: number of the first sample that can be replayed. waiting: batches that are accepted and not yet in the log.
    trouble: why it accepts nothing now.
    """

    epoch: int
    next_sequence: int
    oldest: int
    samples: int
    payload_bytes: int
    dropped_samples: int
    waiting: int = 0
    trouble: str | None = None


class SourceLog(Protocol):
    """A log of one source. All methods may be called from several threads."""

    @property
    def epoch(self) -> int:
        """Return the source's epoch; it is new only when the log before was lost."""

    @property
    def next_sequence(self) -> int:
        """Return the number of the sample that follows the last one accepted."""

    @property
    def position(self) -> str | None:
        """Return the position of the newest entry that has one."""

    def append(self, entry: LogEntry, *, logged: Logged) -> None:
        """Accept an entry, which must begin at `next_sequence`. Raises LogError; then it was not accepted."""

    def entries_from(self, first: int, limit: int) -> list[LogEntry]:
        """Return at most `limit` entries that hold sample `first` and later ones, the oldest first."""

    def status(self) -> LogStatus:
        """Return the present state of the log."""

    def flush(self) -> None:
        """Wait until all that was accepted is in the log. Raises LogError."""

    def close(self) -> None:
        """Stop accepting entries."""


def require_next(entry: LogEntry, next_sequence: int) -> None:
    """Raise ValueError for an entry that leaves a gap or overlaps."""
    if entry.first != next_sequence or entry.count < 1:
        raise ValueError(f"{entry.count} samples from number {entry.first} do not follow {next_sequence - 1}")


class MemoryLog:
    """A log of the newest batches in memory, limited in samples and bytes. Each has an epoch of its own."""

    def __init__(self, *, samples: int = LOG_SAMPLES, payload_bytes: int = LOG_BYTES) -> None:
        self.epoch = time.time_ns()
        self.next_sequence = 0
        self.position: str | None = None
        self._samples = samples
        self._payload_bytes = payload_bytes
        self._entries: deque[LogEntry] = deque()
        self._held_samples = 0
        self._held_bytes = 0
        self._lock = threading.Lock()

    def append(self, entry: LogEntry, *, logged: Logged) -> None:
        """Accept an entry, see `SourceLog.append`."""
        with self._lock:
            require_next(entry, self.next_sequence)
            self._entries.append(entry)
            self._held_samples += entry.count
            self._held_bytes += len(entry.payload)
            self.next_sequence += entry.count
            self.position = entry.position or self.position
            while self._too_much() and len(self._entries) > 1:
                oldest = self._entries.popleft()
                self._held_samples -= oldest.count
                self._held_bytes -= len(oldest.payload)
        logged(entry)

    def entries_from(self, first: int, limit: int) -> list[LogEntry]:
        """Return entries, see `SourceLog.entries_from`."""
        with self._lock:
            wanted = (entry for entry in self._entries if entry.first + entry.count > first)
            return list(itertools.islice(wanted, limit))

    def status(self) -> LogStatus:
        """Return the present state, see `SourceLog.status`."""
        with self._lock:
            oldest = self._entries[0].first if self._entries else self.next_sequence
            return LogStatus(self.epoch, self.next_sequence, oldest, self._held_samples, self._held_bytes, oldest)

    def flush(self) -> None:
        """Do nothing: all that was accepted is in the log."""

    def close(self) -> None:
        """Do nothing: memory needs no release."""

    def _too_much(self) -> bool:
        return self._held_samples > self._samples or self._held_bytes > self._payload_bytes
