"""Looks at the folder of the nightly backups, so that one that is missing is told. What it is on may hang, as a disk on the
network does: so it has a thread of its own, for which nobody waits.
"""

import logging
import math
from datetime import UTC, datetime
from pathlib import Path

from service.resilience.supervised_thread import SupervisedThread
from storage.backup.backup_file import newest_in

logger = logging.getLogger(__name__)

LOOK_S = 60.0


class BackupWatch(SupervisedThread):
    """How old the newest backup of a folder is. No folder: nothing is looked at."""

    def __init__(self, folder: str) -> None:
        super().__init__("backup watch", failure=f"backups in {folder} cannot be looked at", retry_s=LOOK_S)
        self._folder = folder
        self._newest: datetime | None = None

    def start(self) -> None:
        """Begin, where a folder is named."""
        if self._folder:
            super().start()

    def stop(self) -> None:
        """Look no more. Waits for no look under way, which may hang."""
        self._stop.set()

    @property
    def gauges(self) -> dict[str, float]:
        """Figures for a monitoring system, by the name of the metric: without end where none was seen."""
        if not self._folder:
            return {}
        age = math.inf if self._newest is None else (datetime.now(UTC) - self._newest).total_seconds()
        return {"rundown_backup_age_seconds": age}

    def turn(self) -> float:
        """Look once."""
        try:
            self._newest = newest_in(Path(self._folder))
        except OSError as error:
            logger.warning("backups in %s cannot be looked at: %s", self._folder, error)
        return LOOK_S
