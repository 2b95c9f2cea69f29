"""Private files: files with data, or with secrets that give access to data, are readable by their owner only."""

import contextlib
import os
import stat
from pathlib import Path

PRIVATE = 0o600
"""Mode of files that hold data."""
PRIVATE_FOLDER = 0o700
"""Mode of folders that hold such files."""
BESIDE = ("", "-wal", "-shm")
"""Suffixes of a database file's name under which SQLite keeps its data."""


def prepare(path: Path) -> None:
    """Create an empty private file for a later writer, unless it exists.

    Otherwise the umask would set its mode, which SQLite copies to its log. A failure to create the file is left for the writer
    to report.
    """
    with contextlib.suppress(OSError):
        # Never open an existing file: closing it would end SQLite's locks on it in the whole process.
        os.close(os.open(path.resolve(), os.O_CREAT | os.O_EXCL | os.O_WRONLY, PRIVATE))


def readable_by_others(path: Path) -> list[Path]:
    """Return the files of a database that users other than owner and group may read or write."""
    return [one for one in (path.with_name(path.name + end) for end in BESIDE) if _open_to_others(one)]


def _open_to_others(file: Path) -> bool:
    try:
        return bool(file.stat().st_mode & (stat.S_IROTH | stat.S_IWOTH))
    except FileNotFoundError:  # the log exists only while somebody uses the database
        return False
