"""A lock on a file itself, whichever name it is opened by: a hard link, a bind mount, in another container.

It covers a byte far behind those that SQLite locks, and belongs to an open file description (Linux): SQLite's own locks
neither end it nor conflict with it. The reverse does not hold: closing any descriptor of a file ends all of SQLite's locks on
it in the process. A descriptor opened here therefore stays open as long as this process uses the file.
"""

import errno
import fcntl
import os
import struct
import threading
from collections import Counter
from pathlib import Path

KNOWN = hasattr(fcntl, "F_OFD_SETLK")
"""True where this system has open file description locks at all."""
_BYTE = 2**62
_FLOCK = "hhqqi"
"""`struct flock`: kind of lock, origin of `start`, start, length, process."""
_WITHOUT = (errno.EINVAL, errno.ENOSYS, errno.ENOTSUP)
"""Errors of file systems without such locks."""

FileIdentity = tuple[int, int]

_guard = threading.Lock()
_descriptors: dict[FileIdentity, int] = {}
_taken: dict[FileIdentity, Path] = {}
_users: Counter[FileIdentity] = Counter()


def register(path: Path) -> FileIdentity:
    """Register that SQLite has a file open in this process, until `unregister`. Raises OSError."""
    with _guard:
        place = _place(os.stat(path))
        _users[place] += 1
        return place


def unregister(place: FileIdentity) -> None:
    """Register that one user of a file has closed it; close our descriptor behind the last one."""
    with _guard:
        _users[place] -= 1
        if _users[place] <= 0:
            del _users[place]
            if place in _descriptors and place not in _taken:
                os.close(_descriptors.pop(place))


def descriptor(path: Path) -> int:
    """Return a descriptor of a file that is in use; it stays open until the last user leaves. Raises OSError."""
    with _guard:
        return _open_descriptor(path)[1]


def acquire(path: Path) -> FileIdentity | None:
    """Lock an existing file; return the handle to release, None when the system or the file system has no such locks.

    Raises BlockingIOError when the file is locked, OSError.
    """
    if not KNOWN:
        return None
    with _guard:
        place, descriptor = _open_descriptor(path)
        if place in _taken:
            raise BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN), str(path))
        try:
            _lock_call(descriptor, fcntl.F_OFD_SETLK, fcntl.F_WRLCK)
        except OSError as error:
            if error.errno in _WITHOUT:
                return None
            raise
        _taken[place] = path
        return place


def release(place: FileIdentity) -> None:
    """Unlock a file."""
    with _guard:
        _lock_call(_descriptors[place], fcntl.F_OFD_SETLK, fcntl.F_UNLCK)
        del _taken[place]


def holder(path: Path) -> Path | None:
    """Return the name by which this process holds a file's lock; None when it does not."""
    with _guard:
        return _taken.get(_place(os.stat(path)))


def held_by_another(path: Path) -> bool:
    """Return whether another process holds the lock of an existing file. Raises OSError."""
    if not KNOWN:
        return False
    with _guard:
        _, descriptor = _open_descriptor(path)
        try:
            return _lock_call(descriptor, fcntl.F_OFD_GETLK, fcntl.F_WRLCK) != fcntl.F_UNLCK
        except OSError as error:
            if error.errno in _WITHOUT:
                return False
            raise


def _lock_call(descriptor: int, command: int, kind: int) -> int:
    found = fcntl.fcntl(descriptor, command, struct.pack(_FLOCK, kind, os.SEEK_SET, _BYTE, 1, 0))
    return int(struct.unpack_from(_FLOCK, found)[0])


def _open_descriptor(path: Path) -> tuple[FileIdentity, int]:
    place = _place(os.stat(path))
    if place not in _descriptors:
        descriptor = os.open(path, os.O_RDWR if os.access(path, os.W_OK) else os.O_RDONLY)
        place = _place(os.fstat(descriptor))
        _descriptors.setdefault(place, descriptor)
    return place, _descriptors[place]


def _place(found: os.stat_result) -> FileIdentity:
    return found.st_dev, found.st_ino
