"""The loop shared by the service's background threads: an error ends one pass of the work, never the thread."""

import logging
import threading
from abc import ABC, abstractmethod

from sqlalchemy.exc import DBAPIError

from storage.database.claim import DatabaseUnusable
from storage.database.errors import error_message

UNEXPECTED = "unexpected error; the log has it"
"""Reported when an error is not the database's."""


def report_failure(log: logging.Logger, failure: str, error: Exception) -> str:
    """Log an error that ended a pass of repeated work; return what to report until a pass succeeds."""
    if isinstance(error, DBAPIError | DatabaseUnusable):
        trouble = f"{failure}: {error_message(error)}"
        log.error("%s; trying again", trouble)
        return trouble
    log.error("%s: unexpected error; trying again", failure, exc_info=error)
    return f"{failure}: {UNEXPECTED}"


class SupervisedThread(ABC):
    """A thread that repeats one piece of work until it is stopped.

    A subclass defines one pass and the pause after it. failure: what does not happen while passes fail, such as "runs cannot
    be closed". retry_s: pause after a failed pass [s]. first_pause_s: pause before the first pass [s].
    """

    def __init__(self, name: str, *, failure: str, retry_s: float, first_pause_s: float = 0.0) -> None:
        self.trouble: str | None = None
        """Why the last pass failed; None when it succeeded."""
        self._failure = failure
        self._retry_s = retry_s
        self._first_pause_s = first_pause_s
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    @abstractmethod
    def run_once(self) -> float:
        """Do the work once; return the pause before the next pass [s]."""

    def finish(self) -> None:  # noqa: B027 - most threads have nothing to finish
        """Complete remaining work once the thread is asked to stop."""

    def failed(self, error: Exception) -> float:
        """Log an error that ended a pass and keep it as `trouble`; return the pause before the next pass [s]."""
        self.trouble = report_failure(logging.getLogger(type(self).__module__), self._failure, error)
        return self._retry_s

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def stop(self) -> None:
        """Stop after the current pass, and wait for it."""
        self._stop.set()
        if self._thread.ident is not None:
            self._thread.join()

    @property
    def alive(self) -> bool:
        """Return whether the thread is running."""
        return self._thread.is_alive()

    def _run(self) -> None:
        pause = self._first_pause_s
        while not self._stop.wait(pause):
            try:
                pause = self.run_once()
            except Exception as error:  # noqa: BLE001 - `failed` logs it
                pause = self.failed(error)
            else:
                self.trouble = None
        try:
            self.finish()
        except Exception as error:  # noqa: BLE001 - `failed` logs it
            self.failed(error)
