"""Monitoring of disk space, with warnings well before there is none left."""

import logging

from storage.database import disk
from storage.database.disk import DiskUse
from storage.database.engine import Database

logger = logging.getLogger(__name__)

TIGHT, FULL = 0.80, 0.95
"""Used parts of the space above which a warning is given, and an urgent one."""


class DiskWatch:
    """Monitor of the space that the store takes and has. budget: space that it may take [bytes]; None: its whole disk."""

    def __init__(self, database: Database, *, budget: int | None) -> None:
        self._database = database
        self._budget = budget
        self._use: DiskUse | None = None
        self._level = 0
        self.warning = ""
        """Warning of the last check; empty when there is enough space."""

    @property
    def gauges(self) -> dict[str, float]:
        """Return figures for monitoring, by the name of the metric."""
        use = self._use
        if use is None:
            return {}
        known = {
            "rundown_disk_used_ratio": use.part,
            "rundown_disk_free_bytes": use.free,
            "rundown_disk_budget_bytes": use.budget,
        }
        return {"rundown_database_bytes": use.data} | {name: value for name, value in known.items() if value is not None}

    def check(self) -> None:
        """Read how much space is left, and log when that becomes too little. Raises RuntimeError when it cannot be read."""
        found = None  # outdated figures must not be shown as current
        try:
            found = disk.used(self._database, budget=self._budget)
        except OSError as error:
            raise RuntimeError(f"the disk cannot be read: {error}") from error
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
    """Return the warning of too little space; empty when there is enough."""
    if use.part is None or use.part < TIGHT:
        return ""
    urgent = "nearly full: samples will soon not be stored" if use.part >= FULL else "filling"
    left = "" if use.free is None else f", {use.free / 1e9:.1f} GB are free on its disk"
    budget = "" if use.budget is None else f" of {use.budget / 1e9:.1f} GB that it may take"
    return (
        f"the store is {urgent}: {100 * use.part:.0f} % are used; the database has {use.data / 1e9:.1f} GB{budget}{left}. "
        "Shorten raw_days or run_days, or give it more room"
    )
