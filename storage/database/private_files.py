"""Files that hold all data, or what opens it, of which only their owner may read any."""

import contextlib
import os
import stat
from pathlib import Path

PRIVATE = 0o600
"""Mode of files that hold data."""
PRIVATE_FOLDER = 0o700
"""Mode of folders that hold such files."""
BESIDE = ("", "-wal", "-shm")
"""What SQLite puts behind the name of a database file for those that hold its data."""


def prepare(path: Path) -> None:
    """Create a file that is not there yet, empty and private, for who writes it next: else it had what the umask leaves, and
    SQLite gives its log the mode of the file. One that is there is left as it is, and what cannot be created is theirs to say.
    """
    with contextlib.suppress(OSError):
        # Never one that is there: closing it would take SQLite's locks on it from the whole process.
        os.close(os.open(path.resolve(), os.O_CREAT | os.O_EXCL | os.O_WRONLY, PRIVATE))


def readable_by_others(path: Path) -> list[Path]:
    """Which of a database's files more than their owner and their group may read or write, by their modes."""
    return [one for one in (path.with_name(path.name + end) for end in BESIDE) if _open_to_others(one)]


def _open_to_others(file: Path) -> bool:
    try:
        return bool(file.stat().st_mode & (stat.S_IROTH | stat.S_IWOTH))
    except FileNotFoundError:  # the log is there only while somebody uses the database
        return False
