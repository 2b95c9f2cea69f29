"""Monitoring the folder of the nightly backups, so that a missing one is reported. The folder may hang, as a network disk
does; a thread of its own, which nobody waits for, reads it."""

import logging
import math
from datetime import UTC, datetime
from pathlib import Path

from service.resilience.supervised_thread import SupervisedThread
from storage.backup.backup_file import newest_in

logger = logging.getLogger(__name__)

LOOK_S = 60.0


class BackupCheck(SupervisedThread):
    """The thread that reads the age of a folder's newest backup. Without a folder it does nothing."""

    def __init__(self, folder: str) -> None:
        super().__init__("backup watch", failure=f"backups in {folder} cannot be checked", retry_s=LOOK_S)
        self._folder = folder
        self._newest: datetime | None = None

    def start(self) -> None:
        """Start the thread, if a folder is configured."""
        if self._folder:
            super().start()

    def stop(self) -> None:
        """Stop without waiting for the current look, which may hang."""
        self._stop.set()

    @property
    def gauges(self) -> dict[str, float]:
        """Return figures for monitoring, by the name of the metric; the age is infinite when no backup was seen."""
        if not self._folder:
            return {}
        age = math.inf if self._newest is None else (datetime.now(UTC) - self._newest).total_seconds()
        return {"rundown_backup_age_seconds": age}

    def run_once(self) -> float:
        """Read the age of the newest backup."""
        try:
            self._newest = newest_in(Path(self._folder))
        except OSError as error:
            logger.warning("backups in %s cannot be checked: %s", self._folder, error)
        return LOOK_S
