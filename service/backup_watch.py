"""Looks at the folder of the nightly backups, so that one that is missing is told. What it is on may hang, as a disk on the
network does: so it has a thread of its own, for which nobody waits.
"""

import logging
import math
import threading
from datetime import UTC, datetime
from pathlib import Path

from storage.backup_file import newest_in

logger = logging.getLogger(__name__)

LOOK_S = 60.0


class BackupWatch:
    """How old the newest backup of a folder is. No folder: nothing is looked at."""

    def __init__(self, folder: str) -> None:
        self._folder = folder
        self._newest: datetime | None = None
        self._stop = threading.Event()

    def start(self) -> None:
        """Begin."""
        if self._folder:
            threading.Thread(target=self._run, name="backup watch", daemon=True).start()

    def stop(self) -> None:
        """Look no more."""
        self._stop.set()

    @property
    def gauges(self) -> dict[str, float]:
        """Figures for a monitoring system, by the name of the metric: without end where none was seen."""
        if not self._folder:
            return {}
        age = math.inf if self._newest is None else (datetime.now(UTC) - self._newest).total_seconds()
        return {"rundown_backup_age_seconds": age}

    def _run(self) -> None:
        pause = 0.0
        while not self._stop.wait(pause):
            pause = LOOK_S
            try:
                self._newest = newest_in(Path(self._folder))
            except OSError as error:
                logger.warning("backups in %s cannot be looked at: %s", self._folder, error)
