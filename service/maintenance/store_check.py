"""Monitoring of the store: data that are only in a deleted log are saved within a moment, and known damage is checked for
until a check is clean."""

import logging
import sqlite3
import time

from sqlalchemy.exc import DBAPIError

from service.resilience.supervised_thread import SupervisedThread
from storage.database.claim import DatabaseUnusable
from storage.database.engine import Database
from storage.database.errors import error_message
from storage.operation import api_keys

logger = logging.getLogger(__name__)

LOOK_S = 0.5
KEYS_EVERY_S = 10.0
"""Interval of looks for API keys that wait for a confirmation."""
CHECK_EVERY_S = 600.0
"""Interval of checks of a damaged store."""
CHECK_S = 300.0
"""Longest duration of a check."""

WAITING = "{} API keys wait since a restore: `rundown key list` shows them, `rundown key confirm` lets them be good again"


class StoreCheck(SupervisedThread):
    """The thread that monitors the store's files."""

    def __init__(self, database: Database) -> None:
        super().__init__("store watch", failure="the store cannot be checked", retry_s=LOOK_S, first_pause_s=LOOK_S)
        self._database = database
        self._last_message = ""
        self._check_at = self._keys_at = 0.0
        self._waiting = 0

    @property
    def warnings(self) -> list[str]:
        """Return the warning of keys that wait."""
        return [WAITING.format(self._waiting)] if self._waiting else []

    def run_once(self) -> float:
        """Check the store once."""
        self._check_files()
        return LOOK_S

    def _check_files(self) -> None:
        try:
            self._database.save_lost_files()
        except DatabaseUnusable as error:
            if str(error) != self._last_message:
                self._last_message = str(error)
                logger.critical(self._last_message)
        else:
            self._check()
            self._count_keys()

    def _count_keys(self) -> None:
        if time.monotonic() < self._keys_at:
            return
        self._keys_at = time.monotonic() + KEYS_EVERY_S
        try:
            with self._database.reading() as session:
                self._waiting = api_keys.count_unconfirmed(session)
        except DBAPIError as error:
            logger.warning("API keys cannot be read: %s", error_message(error))

    def _check(self) -> None:
        """Check all pages when damage is known."""
        damage = self._database.damage
        if damage.trouble is None or time.monotonic() < self._check_at:
            return
        try:
            self._database.check_integrity(within_s=CHECK_S, stopped=self._stop.is_set)
        except (DBAPIError, sqlite3.Error) as error:
            logger.warning("the store cannot be checked for damage: %s", error_message(error))
        self._check_at = time.monotonic() + CHECK_EVERY_S
        if damage.trouble is None:
            logger.warning("the store was checked and is undamaged")
