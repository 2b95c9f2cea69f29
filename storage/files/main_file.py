"""The main file of an open SQLite store: noticing that another file was written over it in place, as `cp` does.

SQLite writes the main file in checkpoints only, and does not notice what others write into it: it goes on with a mixture of
both. Begin and end of a checkpoint stand in the log's index. The header's change counter only grows. Formats:
https://www.sqlite.org/fileformat2.html#the_database_header, https://www.sqlite.org/walformat.html
"""

import os
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from storage.files import file_lock

LOOKS = 3
"""Number of looks before a file counts as overwritten: a checkpoint may be writing it."""
QUIET_S = 1.0
"""Time after which a file that was overwritten, and does not change, counts as complete [s]."""
_HEADER = 100
_CONSTANT = 20
"""Size of the header, and of its beginning that stays the same while a store is open in WAL mode [B]."""
_CHANGES = slice(24, 28)


@dataclass(frozen=True)
class Checkpoints:
    """Progress of the checkpoints, as the log's index has it. under_way: whether one is, or was broken off."""

    salt: int
    frames: int
    under_way: bool


@dataclass(frozen=True)
class _Seen:
    header: bytes
    size: int

    def may_become(self, other: "_Seen") -> bool:
        """Return whether a checkpoint can have made the other one of this."""
        same = self.header[:_CONSTANT] == other.header[:_CONSTANT] and len(other.header) == _HEADER
        return same and _changes(other.header) >= _changes(self.header)


class MainFile:
    """The main file, kept open."""

    def __init__(self, path: Path) -> None:
        """Open it; SQLite must have it open. Raises OSError."""
        self._place = file_lock.register(path)
        try:
            self.descriptor = file_lock.descriptor(path)
            self._seen = self._read()
        except OSError:
            file_lock.unregister(self._place)
            raise
        self._checkpoints: Checkpoints | None = None
        self._lock = threading.Lock()
        self._stood: tuple[int, int] = (0, 0)
        self._since = 0.0

    def is_ours(self, checkpoints: Callable[[], Checkpoints | None]) -> bool:
        """Return whether nobody else has written another file over it, as far as its header and its size tell."""
        with self._lock:
            return any(self._is_ours(checkpoints) for _ in range(LOOKS))

    def _is_ours(self, checkpoints: Callable[[], Checkpoints | None]) -> bool:
        before = checkpoints()
        found = self._read()
        still = before is not None and before == checkpoints() and not before.under_way
        if found == self._seen or (self._seen.may_become(found) and not (still and before == self._checkpoints)):
            self._seen = found
            self._checkpoints = before if still else None
            return True
        return False

    def is_quiet(self) -> bool:
        """Return whether whoever writes it has finished."""
        found = os.fstat(self.descriptor)
        stands = found.st_mtime_ns, found.st_size
        if stands != self._stood:
            self._stood, self._since = stands, time.monotonic()
        return time.monotonic() - self._since >= QUIET_S

    def close(self) -> None:
        """Close it. SQLite must have closed it before."""
        file_lock.unregister(self._place)

    def _read(self) -> _Seen:
        return _Seen(os.pread(self.descriptor, _HEADER, 0), os.fstat(self.descriptor).st_size)


def _changes(header: bytes) -> int:
    return int.from_bytes(header[_CHANGES], "big")
