"""Damage of the store: the errors that indicate it, and its report until a check finds the store whole."""

import json
import logging
import sqlite3
import threading
import time
from pathlib import Path

from sqlalchemy.engine import ExceptionContext
from sqlalchemy.exc import DBAPIError

from storage.clock import now, to_datetime

logger = logging.getLogger(__name__)

LOG_EVERY_S = 60.0
LARGEST_MACHINE_COUNT = 20
"""Number of machines that a report names at most."""
WHOLE_FILE = sqlite3.SQLITE_NOTADB
PAGES = frozenset(
    {
        sqlite3.SQLITE_IOERR_READ,
        sqlite3.SQLITE_IOERR_SHORT_READ,
        sqlite3.SQLITE_IOERR_CORRUPTFS,
        sqlite3.SQLITE_IOERR_DATA,
    }
)
"""SQLite's errors of a disk that does not return what was written; all kinds of SQLITE_CORRUPT count besides."""
SQLSTATES = frozenset({"XX001", "XX002"})
"""PostgreSQL's data_corrupted and index_corrupted."""
MALFORMED_JSON = "malformed JSON"
UNREADABLE = ("Could not decode to UTF-8 column", MALFORMED_JSON)
"""Beginnings of messages about values that are not what was written; SQLite has no code of its own for them."""


def is_damage(error: BaseException | None) -> bool:
    """Return whether an error, the driver's or one around it, says that stored data cannot be read."""
    error = error.orig if isinstance(error, DBAPIError) else error
    code = getattr(error, "sqlite_errorcode", None)
    if code is not None and (code & 0xFF in (sqlite3.SQLITE_CORRUPT, WHOLE_FILE) or code in PAGES):
        return True
    return getattr(error, "sqlstate", None) in SQLSTATES or str(error).startswith(UNREADABLE)


def is_confined(error: BaseException) -> bool:
    """Return whether an error is damage that leaves other rows usable."""
    code = getattr(getattr(error, "orig", None), "sqlite_errorcode", 0)
    return is_damage(error) and code & 0xFF != WHOLE_FILE


def error_text(error: BaseException) -> str:
    """Return the database's message about damage without any stored data, which not every reader of the message may see."""
    return str(getattr(error, "orig", None) or error).partition(" with text ")[0].strip()


class Damage:
    """Record of the damage met since the last clean check. marker: a file that keeps it over a restart; None without one."""

    def __init__(self, marker: Path | None) -> None:
        self._marker = marker
        self._lock = threading.Lock()
        self._since = ""
        self._words = ""
        self._machines: list[str] = []
        self._unlogged = 0
        self._log_at = 0.0
        self.met = 0
        """Number of times damage was met in this process."""
        if marker is not None and marker.exists():
            self._read_marker(marker)

    @property
    def trouble(self) -> str | None:
        """Return the damage as far as it is known and the remedy; None when none is known."""
        with self._lock:
            if not self._since:
                return None
            whose = f", of {', '.join(self._machines)}" if self._machines else ""
            return (
                f"the store is damaged{whose}: {self._words} (first met {self._since}). What concerns others goes on. "
                "Look at the disk, then restore a backup"
            )

    def record_error(self, error: BaseException, machine_id: str | None = None) -> None:
        """Record an error and the machine whose data it concerned."""
        self._add(error_text(error), machine_id)

    def record_findings(self, findings: list[str]) -> None:
        """Record the findings of a check."""
        self._add("; ".join(findings), None)

    def watch(self, context: ExceptionContext) -> None:
        """Record damage that an engine reports; a listener for its errors."""
        if is_damage(context.original_exception):
            self.record_error(context.original_exception, _machine(context))

    def record_machine(self, machine_id: str) -> None:
        """Record a machine whose data could not be read."""
        self._add("", machine_id)

    def clear(self, *, met: int) -> None:
        """Clear the record after a clean check, unless damage was met since the check began. met: the count at its begin."""
        with self._lock:
            if met == self.met:
                self._since = self._words = ""
                self._machines = []
                if self._marker is not None:
                    self._marker.unlink(missing_ok=True)

    def _add(self, words: str, machine_id: str | None) -> None:
        with self._lock:
            self.met += 1
            before = (self._since, self._words, tuple(self._machines))
            self._since = self._since or to_datetime(now()).strftime("%Y-%m-%d %H:%M:%S UTC")
            self._words = words or self._words
            if machine_id and machine_id not in self._machines and len(self._machines) < LARGEST_MACHINE_COUNT:
                self._machines.append(machine_id)
            if before != (self._since, self._words, tuple(self._machines)):
                self._write_marker()
            self._unlogged += 1
            if time.monotonic() >= self._log_at:
                named = ", ".join(self._machines) or "no machine that is known"
                logger.error("the store is damaged, met %d times: %s (%s)", self._unlogged, self._words, named)
                self._log_at, self._unlogged = time.monotonic() + LOG_EVERY_S, 0

    def _write_marker(self) -> None:
        if self._marker is not None:
            try:
                self._marker.write_text(
                    json.dumps({"since": self._since, "words": self._words, "machines": self._machines}) + "\n"
                )
            except OSError as error:
                logger.error("that the store is damaged cannot be noted in %s: %s", self._marker, error)

    def _read_marker(self, marker: Path) -> None:
        try:
            kept = json.loads(marker.read_text())
            self._since, self._words = str(kept["since"]), str(kept["words"])
            self._machines = [str(one) for one in kept["machines"]]
        except (OSError, ValueError, KeyError, TypeError) as error:
            self._since, self._words = "before", f"{marker} says so, and cannot be read: {error}"


def marker_of(path: Path) -> Path:
    """Return the path of the damage marker of an SQLite file."""
    return path.with_name(path.name + ".damaged")


def _machine(context: ExceptionContext) -> str | None:
    """Return the machine that a failed statement concerned, when its parameters name one."""
    for parameters in getattr(context.execution_context, "compiled_parameters", None) or ():
        for name, value in parameters.items():
            one = value[0] if isinstance(value, list | tuple) and len(value) == 1 else value
            if name.startswith("machine_id") and isinstance(one, str):
                return one
    return None
