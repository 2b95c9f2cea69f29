"""A lock on a file itself, by whatever name it goes: a hard link, a bind mount, in another container.

It lies on a byte far behind those that SQLite locks, and belongs to an open file description (Linux): SQLite's own locks
neither end it nor meet it. The other way round they would end: whoever closes any descriptor of a file loses all that SQLite
has locked in it for the whole process. So a descriptor that was opened here stays open as long as this process uses the file.
"""

import errno
import fcntl
import os
import struct
import threading
from collections import Counter
from pathlib import Path

KNOWN = hasattr(fcntl, "F_OFD_SETLK")
"""Whether this system has such locks at all."""
_BYTE = 2**62
_FLOCK = "hhqqi"
"""`struct flock`: kind of lock, from where `start` counts, start, length, process."""
_WITHOUT = (errno.EINVAL, errno.ENOSYS, errno.ENOTSUP)
"""Said by file systems that know no such locks."""

Place = tuple[int, int]

_guard = threading.Lock()
_descriptors: dict[Place, int] = {}
_taken: dict[Place, Path] = {}
_users: Counter[Place] = Counter()


def use(path: Path) -> Place:
    """Say that SQLite has a file open in this process, until `leave`. Raises OSError."""
    with _guard:
        place = _place(os.stat(path))
        _users[place] += 1
        return place


def leave(place: Place) -> None:
    """SQLite has closed it, as far as one user is concerned."""
    with _guard:
        _users[place] -= 1
        if _users[place] <= 0:
            del _users[place]
            if place in _descriptors and place not in _taken:
                os.close(_descriptors.pop(place))


def take(path: Path) -> Place | None:
    """Lock a file that is there. Returns what to release; None where the system or its file system knows no such locks.

    Raises BlockingIOError where somebody has it, OSError.
    """
    if not KNOWN:
        return None
    with _guard:
        place, descriptor = _opened(path)
        if place in _taken:
            raise BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN), str(path))
        try:
            _ask(descriptor, fcntl.F_OFD_SETLK, fcntl.F_WRLCK)
        except OSError as error:
            if error.errno in _WITHOUT:
                return None
            raise
        _taken[place] = path
        return place


def release(place: Place) -> None:
    """Unlock it."""
    with _guard:
        _ask(_descriptors[place], fcntl.F_OFD_SETLK, fcntl.F_UNLCK)
        del _taken[place]


def holder(path: Path) -> Path | None:
    """By which name this process holds a file, if it does."""
    with _guard:
        return _taken.get(_place(os.stat(path)))


def held_by_another(path: Path) -> bool:
    """Whether another process holds a file that is there. Raises OSError."""
    if not KNOWN:
        return False
    with _guard:
        _, descriptor = _opened(path)
        try:
            return _ask(descriptor, fcntl.F_OFD_GETLK, fcntl.F_WRLCK) != fcntl.F_UNLCK
        except OSError as error:
            if error.errno in _WITHOUT:
                return False
            raise


def _ask(descriptor: int, command: int, kind: int) -> int:
    found = fcntl.fcntl(descriptor, command, struct.pack(_FLOCK, kind, os.SEEK_SET, _BYTE, 1, 0))
    return int(struct.unpack_from(_FLOCK, found)[0])


def _opened(path: Path) -> tuple[Place, int]:
    place = _place(os.stat(path))
    if place not in _descriptors:
        descriptor = os.open(path, os.O_RDWR if os.access(path, os.W_OK) else os.O_RDONLY)
        place = _place(os.fstat(descriptor))
        _descriptors.setdefault(place, descriptor)
    return place, _descriptors[place]


def _place(found: os.stat_result) -> Place:
    return found.st_dev, found.st_ino
