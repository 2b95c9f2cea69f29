"""Looks after the store though nobody asks: what is only in a log that was deleted is saved within a moment."""

import logging
import threading

from storage.claim import DatabaseUnusable
from storage.database import Database

logger = logging.getLogger(__name__)

LOOK_S = 0.5


class StoreWatch:
    """The thread that looks after the store's files."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="store watch", daemon=True)
        self._said = ""

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def stop(self) -> None:
        """Look no more."""
        self._stop.set()
        if self._thread.ident is not None:
            self._thread.join()

    def _run(self) -> None:
        while not self._stop.wait(LOOK_S):
            try:
                self._database.look_after_files()
            except DatabaseUnusable as error:
                if str(error) != self._said:
                    self._said = str(error)
                    logger.critical(self._said)
