"""Records the newest entry of the audit trail outside of the database, in the log and in memory, and checks that it stays.

A writer of the database could cut off the trail's end, head included, and the rest would verify: the record shows the loss.
"""

import logging
import time
from collections.abc import Callable

from service.resilience.supervised_thread import SupervisedThread
from storage.database.engine import Database
from storage.operation import audit
from storage.operation.audit import BEGINNING

logger = logging.getLogger(__name__)

LOOK_S = 600.0
A_DAY_S = 86_400.0


class AuditWatch(SupervisedThread):
    """Thread that checks the audit trail periodically."""

    def __init__(self, database: Database, *, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__("audit watch", failure="the audit trail cannot be checked", retry_s=LOOK_S)
        self._database = database
        self._clock = clock
        self._last_entry = (0, BEGINNING)
        self._logged_at: float | None = None
        self.warnings: list[str] = []
        """Warnings of changed entries; they stay until the next start."""

    @property
    def gauges(self) -> dict[str, float]:
        """Return figures for a monitoring system, by the name of the metric."""
        return {"rundown_audit_trail_holds": float(not self.warnings)}

    def check(self, *, report: bool = False) -> None:
        """Compare the trail with the recorded entry, and record the newest. report: whether to log it at once."""
        with self._database.reading() as session:
            held, newest = audit.is_intact(session, self._last_entry), audit.head(session)
        if not held:
            number, digest = self._last_entry
            words = f"the audit trail was changed: entry {number}, which was there before, is not there as it was"
            logger.error("%s; see rundown audit verify --noted %d:%s", words, number, digest)
            self.warnings = [*self.warnings, words]
        self._last_entry = newest
        if report or not held or self._logged_at is None or self._clock() - self._logged_at >= A_DAY_S:
            logger.info("audit trail: the newest entry is %d:%s", *newest)
            self._logged_at = self._clock()

    def run_once(self) -> float:
        """Check once; the first successful check logs the newest entry."""
        self.check()
        return LOOK_S

    def finish(self) -> None:
        """Log the newest entry, to show entries cut off while the service does not run."""
        self.check(report=True)
