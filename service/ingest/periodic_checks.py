"""What the ingest does now and then: logs of quiet sources are asked for what is missing, runs of silent machines end."""

import logging
import time
from collections.abc import Callable

from service.ingest.clock_doubt import OwnClock
from service.journal.journal import Journal
from service.recovery.gap_recovery import GapRecovery
from service.resilience.supervised_thread import UNEXPECTED
from storage.database.errors import LeaseLost, error_message, is_database_wide

logger = logging.getLogger(__name__)

TAIL_CHECK_S = 2.0
"""How often a live source's log is asked for samples that never came."""
DOUBTED_CHECK_S = 30.0
"""The same while the own clock is wrong: what logs answer has to wait, too."""


class IngestChecks:
    """Do the checks when they are due; samples are stored though they fail."""

    def __init__(self, journal: Journal, recovery: GapRecovery, own_clock: OwnClock, *, silence_s: float) -> None:
        self._journal = journal
        self._recovery = recovery
        self._own_clock = own_clock
        self._silence_s = silence_s
        self._next = 0.0
        self.trouble: str | None = None
        """Why the last checks were not done."""

    def look_at_clock(self) -> None:
        """See whether a doubt of the own clock has ended: then what was left to the logs is asked for at once."""
        if self._own_clock.look():
            self._next = 0.0

    def check_if_due(self) -> None:
        """Do the checks, if they are due. Raises LeaseLost."""
        if time.monotonic() < self._next:
            return
        self._next = time.monotonic() + (TAIL_CHECK_S if self._own_clock.doubt is None else DOUBTED_CHECK_S)
        unasked = _tried("logs cannot be asked", lambda: self._recovery.check_tails(quiet_s=TAIL_CHECK_S))
        alive = {key.machine for key in self._recovery.live}
        unended = _tried("runs cannot be ended", lambda: self._journal.end_silent(silence_s=self._silence_s, alive=alive))
        self.trouble = unended or unasked


def _tried(trouble: str, check: Callable[[], None]) -> str | None:
    """Do a check; return why it could not be done. Raises LeaseLost."""
    try:
        check()
    except LeaseLost:
        raise
    except Exception as error:
        if is_database_wide(error):
            logger.error("%s, trying again: %s", trouble, error_message(error))
            return f"{trouble}: {error_message(error)}"
        logger.exception("%s, trying again", trouble)
        return f"{trouble}: {UNEXPECTED}"
    return None
