"""Room on the disk: looked at now and then, and warned of well before there is none left."""

import logging

from storage.database import disk
from storage.database.disk import DiskUse
from storage.database.engine import Database

logger = logging.getLogger(__name__)

TIGHT, FULL = 0.80, 0.95
"""Parts of the room from which on it is warned of, and urgently."""


class DiskWatch:
    """Say how much room the store takes and has. budget: that it may take [bytes]; None for all of its disk."""

    def __init__(self, database: Database, *, budget: int | None) -> None:
        self._database = database
        self._budget = budget
        self._use: DiskUse | None = None
        self._level = 0
        self.warning = ""
        """As of the last look; empty where there is enough room."""

    @property
    def gauges(self) -> dict[str, float]:
        """Figures for a monitoring system, by the name of the metric."""
        use = self._use
        if use is None:
            return {}
        known = {
            "rundown_disk_used_ratio": use.part,
            "rundown_disk_free_bytes": use.free,
            "rundown_disk_budget_bytes": use.budget,
        }
        return {"rundown_database_bytes": use.data} | {name: value for name, value in known.items() if value is not None}

    def look(self) -> None:
        """See how much room is left, and log when that has become too little. Raises RuntimeError where it cannot be seen."""
        found = None  # old figures would look like good ones
        try:
            found = disk.used(self._database, budget=self._budget)
        except OSError as error:
            raise RuntimeError(f"the disk cannot be looked at: {error}") from error
        finally:
            self._use = found
        self.warning = warning(found)
        used = found.part or 0.0
        before, self._level = self._level, sum(used >= part for part in (TIGHT, FULL))
        if self._level > before:
            logger.warning(self.warning)
        elif self._level < before:
            logger.info("there is more room on the disk again: %.0f %% are used", 100 * used)


def warning(use: DiskUse) -> str:
    """Return the warning of too little room; empty where there is enough."""
    if use.part is None or use.part < TIGHT:
        return ""
    urgent = "nearly full: samples will soon not be stored" if use.part >= FULL else "filling"
    left = "" if use.free is None else f", {use.free / 1e9:.1f} GB are free on its disk"
    budget = "" if use.budget is None else f" of {use.budget / 1e9:.1f} GB that it may take"
    return (
        f"the store is {urgent}: {100 * use.part:.0f} % are used; the database has {use.data / 1e9:.1f} GB{budget}{left}. "
        "Shorten raw_days or run_days, or give it more room"
    )
