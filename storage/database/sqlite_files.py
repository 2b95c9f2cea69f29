"""The files of an open SQLite store: checking that they are those that were opened, and saving data that only they hold.

SQLite goes on writing to a log that was deleted, and reports nothing. Whoever opens the store meanwhile, or after a kill,
misses all that is in that log. A checkpoint through an open connection still moves all of it into the main file. Two cases are
exceptions. If the log was cut off (`write_ahead_log`), only its remaining part may be moved. If another file was written over
the main file (`main_file`), nothing may be moved unless the log has every page.
"""

import logging
import sqlite3
import stat
import threading
from pathlib import Path

from sqlalchemy.exc import OperationalError

from storage.database.claim import DatabaseUnusable, logs_of
from storage.files.main_file import MainFile
from storage.files.write_ahead_log import WriteAheadLog

logger = logging.getLogger(__name__)

SAVING_MS = 1_000
"""Time for which a checkpoint waits for readers."""


class SqliteFiles:
    """The main file, its log and the log's index, as they were opened. A missing file counts as missing until `close`."""

    def __init__(self, path: Path) -> None:
        """Open a connection that keeps the files open. Raises sqlite3.Error, OSError."""
        self._path = path
        self._keeper = sqlite3.connect(path, isolation_level=None, check_same_thread=False, timeout=SAVING_MS / 1000)
        try:
            self._keeper.execute("SELECT 1 FROM sqlite_master LIMIT 1").fetchone()  # opens the log
            self._keeper.execute("PRAGMA synchronous = FULL")
        except sqlite3.Error:
            self._keeper.close()
            raise
        log, index = logs_of(path)
        try:
            # Of a file that this process has open by another name already, SQLite keeps the index beside that name.
            self._log = WriteAheadLog(log, index) if index.exists() else None
            self._main = MainFile(path)
        except OSError:
            self._keeper.close()
            raise
        self._opened = {one: _place(one) for one in (path, log, index)}
        self._lock = threading.Lock()
        self._lost_file: Path | None = None
        self._barred: PermissionError | None = None
        self._cut_off: Path | None = None
        self._overwritten = self._complete = False
        self._lost_frames: int | None = None
        self._rest = path.with_name(f"{path.name}-wal.cut")
        self._closed = False
        self.saved = False
        """Whether a file is missing and the main file, or what is left of the log, holds all that can be saved."""
        self.mended = 0
        """Number of times damage in the log was got rid of without a loss."""

    def check(self, *, further: int = 0) -> bool:
        """Return whether all files still exist and hold what is ours; costs some 40 µs.

        further: number of the log's frames whose checksums are looked at besides, some 10 µs each.
        """
        if self._lost_file is None:
            # After `close` only the main file remains.
            looked_at = [self._path] if self._closed else list(self._opened)
            try:
                self._lost_file = next((one for one in looked_at if _place(one) != self._opened[one]), None)
                self._barred = None
            except PermissionError as error:  # nothing is lost by that: the files are open, and it may be given back
                self._barred = error
        return self._lost_file is None and self._barred is None and self.content_is_ours(further=further)

    def content_is_ours(self, *, further: int = 0) -> bool:
        """Return whether nobody has cut off the log or written over it or the main file, as far as they are looked at."""
        if self._closed or self._log is None:
            return self._cut_off is None and not self._overwritten
        if not self._overwritten:
            self._overwritten = not self._main.is_ours(self._log.checkpoints)
        if self._cut_off is None and not self._log.is_whole(further=further):
            self._cut_off = logs_of(self._path)[0]
        return self._cut_off is None and not self._overwritten

    def require_content(self) -> None:
        """Raise OperationalError when the log was cut off or a file overwritten: a commit would be written behind the hole."""
        if not self.content_is_ours():
            self.require()

    def require(self) -> None:
        """Raise OperationalError when a file is missing, overwritten or cut off.

        Nothing may be written then, and no connection opened, since it would create a second log.
        """
        if (trouble := self.trouble) is not None:
            raise OperationalError(None, None, self.unusable(trouble))

    def unusable(self, trouble: str) -> DatabaseUnusable:
        """Return the error that reports a trouble: with the folder to whoever may see it, to callers without."""
        return DatabaseUnusable(trouble, outline=trouble.replace(f"{self._path.parent}/", ""))

    @property
    def trouble(self) -> str | None:
        """Return which file is missing, overwritten or cut off and the remedy; None when none is."""
        if self.check():
            return None
        if self._overwritten:
            return self._words_of_overwritten()
        if self._cut_off is not None:
            lost = "being looked for" if self._lost_frames is None else f"{self._lost_frames} pages"
            return (
                f"{self._cut_off} was cut off or overwritten while the service had it open; what is lost of what was stored "
                f"last, keys and settings included: {lost}; {self._rest} keeps what is left of the log. Nothing more is "
                "stored: restart the service, which asks the sources' logs for lost samples again"
            )
        if self._lost_file is None and self._barred is not None:
            return (
                f"the service has lost the permission to look at {self._barred.filename}: give its user the folder back, and "
                "it goes on by itself; all that was acknowledged is saved"
            )
        gone = f"{self._lost_file} was deleted or replaced while the service had it open"
        if self._lost_file == self._path:
            return f"the database file {gone}: restart the service"
        if self.saved:
            return f"{gone}. All that was acknowledged is saved in {self._path}; nothing more is stored: restart the service"
        return (
            f"{gone}, and what was stored last is not saved yet. Stop the service cleanly: that saves all. "
            f"Do not kill it, and do not open {self._path} with anything meanwhile"
        )

    def _words_of_overwritten(self) -> str:
        found = f"another file was written over the database file {self._path} while the service had it open"
        if not self.saved:
            return f"{found}. Nothing more is stored. Do not kill the service; copy nothing there while it runs"
        if self._complete:
            return (
                f"{found}. All that was acknowledged was in its log, and is written back; nothing more is stored: "
                "restart the service"
            )
        return (
            f"{found}: what was stored since that one was made is lost; {self._rest} keeps its log. Nothing more is stored: "
            "stop the service, restore the newest backup with `rundown restore`, and start it, which asks the sources' logs "
            "for lost samples"
        )

    def save(self) -> bool:
        """Move all committed data into the main file; return whether they are there.

        Of a log that was cut off, only what is left counts. The caller must have the writers' turn.
        """
        with self._lock:
            if not self.saved and not self._closed:
                if not self.content_is_ours() and self._overwritten:
                    return self._leave_overwritten()
                mends = False
                if self._cut_off is not None and self._lost_frames is None and self._log is not None:
                    mends = self._log.is_superfluous_where_damaged()
                    if not mends:
                        self._lost_frames = self._log.go_back(self._rest)
                try:
                    _, logged, done = self._keeper.execute("PRAGMA wal_checkpoint(TRUNCATE)").fetchone()
                except sqlite3.Error:
                    return False  # for instance the disk is full: tried again later
                if mends and logged == done:
                    self._cut_off, self.mended = None, self.mended + 1
                else:
                    saved = logged == done and not mends
                    self.saved = saved and (self._lost_file or self._cut_off) is not None
                    return saved
            return self.saved

    def _leave_overwritten(self) -> bool:
        """Write all back if the log has all, or put the log aside, once whoever overwrites the main file has finished."""
        if self._log is not None and self._main.is_quiet():
            try:
                self._complete = self._log.write_back(self._main.descriptor, self._rest)
            except OSError as error:
                logger.error("%s was overwritten, and its log cannot be put aside: %s", self._path, error)
                return False
            self.saved = True
        return self.saved

    def close(self) -> None:
        """Stop checking the files and close the connection; SQLite makes a checkpoint when it is the last one.

        All other connections of this process must be closed before.
        """
        with self._lock:
            if not self._closed:
                self._closed = True
                self._keeper.close()
                self._main.close()
                if self._log is not None:
                    self._log.close()


def _place(file: Path) -> tuple[int, int] | None:
    try:
        found = file.stat()
    except PermissionError:
        raise
    except OSError:
        return None
    return (found.st_dev, found.st_ino) if stat.S_ISREG(found.st_mode) else None
