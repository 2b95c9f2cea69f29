"""The one loop behind the service's background threads: an error ends a turn of the work, never the thread."""

import logging
import threading
from abc import ABC, abstractmethod

from sqlalchemy.exc import DBAPIError

from storage.database.claim import DatabaseUnusable
from storage.database.errors import error_message

UNEXPECTED = "unexpected error; the log has it"
"""Told where an error is not the database's."""


class SupervisedThread(ABC):
    """Do one piece of work again and again, in a thread of its own, until it is stopped.

    A subclass says what one turn does and how long to pause after it. failure: what does not happen while turns fail, such as
    "runs cannot be closed". retry_s: pause after a turn that failed [s]. first_pause_s: pause before the first turn [s].
    """

    def __init__(self, name: str, *, failure: str, retry_s: float, first_pause_s: float = 0.0) -> None:
        self.trouble: str | None = None
        """Why the last turn failed; None after one that did not."""
        self._failure = failure
        self._retry_s = retry_s
        self._first_pause_s = first_pause_s
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    @abstractmethod
    def turn(self) -> float:
        """Do the work once; return how long to pause before the next turn [s]."""

    def finish(self) -> None:  # noqa: B027 - most threads have nothing to finish
        """Do what is left to do once the thread is asked to stop."""

    def failed(self, error: Exception) -> float:
        """Log an error that ended a turn and keep it as `trouble`; return how long to pause before the next turn [s]."""
        log = logging.getLogger(type(self).__module__)
        if isinstance(error, DBAPIError | DatabaseUnusable):
            self.trouble = f"{self._failure}: {error_message(error)}"
            log.error("%s; trying again", self.trouble)
        else:
            self.trouble = f"{self._failure}: {UNEXPECTED}"
            log.error("%s; trying again", self.trouble, exc_info=error)
        return self._retry_s

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def stop(self) -> None:
        """End after the turn under way, and wait for that."""
        self._stop.set()
        if self._thread.ident is not None:
            self._thread.join()

    @property
    def alive(self) -> bool:
        """Whether the thread runs."""
        return self._thread.is_alive()

    def _run(self) -> None:
        pause = self._first_pause_s
        while not self._stop.wait(pause):
            try:
                pause = self.turn()
            except Exception as error:  # noqa: BLE001 - `failed` logs it
                pause = self.failed(error)
            else:
                self.trouble = None
        try:
            self.finish()
        except Exception as error:  # noqa: BLE001 - `failed` logs it
            self.failed(error)
