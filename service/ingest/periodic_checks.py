"""Periodic checks of the ingest: request missing samples from logs of quiet sources, end runs of silent machines."""

import logging
import time
from collections.abc import Callable

from service.ingest.clock_doubt import OwnClock
from service.recovery.gap_recovery import GapRecovery
from service.resilience.supervised_thread import UNEXPECTED
from service.write_path.sample_writer import SampleWriter
from storage.database.errors import LeaseLost, error_message, is_database_wide

logger = logging.getLogger(__name__)

TAIL_CHECK_S = 2.0
"""Interval at which a live source's log is asked for samples that never came."""
DOUBTED_CHECK_S = 30.0
"""Interval of the checks while the own clock is wrong: replies from logs have to wait, too."""


class IngestChecks:
    """The periodic checks; samples are stored even when they fail."""

    def __init__(self, writer: SampleWriter, recovery: GapRecovery, own_clock: OwnClock, *, silence_s: float) -> None:
        self._writer = writer
        self._recovery = recovery
        self._own_clock = own_clock
        self._silence_s = silence_s
        self._next = 0.0
        self.trouble: str | None = None
        """Why the last checks failed."""

    def check_clock(self) -> None:
        """Check whether a doubt about the own clock has ended; if so, request what was left in the logs at once."""
        if self._own_clock.assess():
            self._next = 0.0

    def check_if_due(self) -> None:
        """Run the checks, if they are due. Raises LeaseLost."""
        if time.monotonic() < self._next:
            return
        self._next = time.monotonic() + (TAIL_CHECK_S if self._own_clock.doubt is None else DOUBTED_CHECK_S)
        unasked = _tried("logs cannot be asked", lambda: self._recovery.check_tails(quiet_s=TAIL_CHECK_S))
        alive = {key.machine for key in self._recovery.live}
        unended = _tried("runs cannot be ended", lambda: self._writer.end_silent(silence_s=self._silence_s, alive=alive))
        self.trouble = unended or unasked


def _tried(trouble: str, check: Callable[[], None]) -> str | None:
    """Run a check; return why it failed, None when it did not. Raises LeaseLost."""
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
