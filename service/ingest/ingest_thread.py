"""Ingest: the thread that stores what zenoh and HTTP deliver, cycle by cycle, in spite of errors."""

import logging
import time

import zenoh

from service.ingest.cycle import CYCLE_S, IngestCycle
from service.replication.work_share import Share, WholeShare
from service.resilience.supervised_thread import UNEXPECTED, SupervisedThread
from service.write_path.http_queue import Submissions
from service.write_path.sample_writer import SampleWriter
from storage.database.errors import LeaseLost, error_message, error_outline, is_database_wide
from storage.recent_maximum import RecentMaximum

logger = logging.getLogger(__name__)

STALLED_S = 5.0
"""Longest cycle: a longer one waits for the database, and the service is not ready."""
RETRY_S = 1.0
"""Pause after the database refused to store."""
LAST_TRIES = 2
"""Attempts of a service that ends to store what is held."""


class Ingest(SupervisedThread):
    """The thread. Callbacks only enqueue; everything else happens here."""

    def __init__(
        self,
        session: zenoh.Session,
        writer: SampleWriter,
        *,
        silence_s: float,
        submissions: Submissions | None = None,
        share: Share | None = None,
    ) -> None:
        super().__init__("ingest", failure="samples cannot be stored", retry_s=RETRY_S)
        self._submissions = Submissions() if submissions is None else submissions
        self._cycle = IngestCycle(session, writer, self._submissions, share or WholeShare(), silence_s=silence_s)
        self._longest_cycle = RecentMaximum()
        self._errors = 0  # that nobody foresaw, in a row
        self._began = time.monotonic()  # the cycle

    def start(self) -> None:
        """Subscribe and begin."""
        self._cycle.open()
        super().start()

    def stop(self) -> None:
        """Take no more, store what is queued, end the thread."""
        super().stop()
        self._cycle.close()

    @property
    def trouble(self) -> str | None:
        """Return why the last cycle could not be stored, or that the present one does not end."""
        lasts = time.monotonic() - self._began
        if self._trouble is None and lasts > STALLED_S and self.alive:
            return f"storing has not ended for {lasts:.0f} s"
        return self._trouble or self._cycle.checks.trouble

    @trouble.setter
    def trouble(self, words: str | None) -> None:
        """Set why the last cycle could not be stored; None once one was."""
        self._trouble = words

    @property
    def alive(self) -> bool:
        """Return whether the threads run."""
        return super().alive and self._cycle.inbox.alive

    @property
    def gauges(self) -> dict[str, float]:
        """Return figures for a monitoring system, by the name of the metric."""
        return {
            "rundown_ingest_queue_messages": len(self._cycle.inbox),
            "rundown_ingest_queue_bytes": self._cycle.inbox.size,
            "rundown_ingest_longest_cycle_seconds": self._longest_cycle.seconds,
            "rundown_clock_doubted": int(self._cycle.own_clock.doubt is not None),
        }

    @property
    def warnings(self) -> list[str]:
        """Return the doubts of this machine's clock."""
        return [] if self._cycle.own_clock.doubt is None else [self._cycle.own_clock.doubt]

    def run_once(self) -> float:
        """Run a cycle, then wait until messages have come or checks are due."""
        self._cycle.wait_for_more(self._run_cycle())
        return 0.0

    def finish(self) -> None:
        """Store what is queued, and end when there is no more, or when it cannot be stored."""
        tries = LAST_TRIES
        while True:
            try:
                count = self._run_cycle()
            except Exception as error:  # noqa: BLE001 - `failed` logs it
                pause = self.failed(error)
                if self._stops_storing(error):
                    tries -= 1
                    if tries == 0:
                        self._give_up(error)
                        return
                    time.sleep(pause)
                continue
            if count == 0 and not self._cycle.has_more:
                return
            self._cycle.wait_for_more(count)

    def failed(self, error: Exception) -> float:
        """Go on after an error: one message must never end the ingest of all others."""
        if isinstance(error, LeaseLost):
            self._cycle.drop_taken_over(error)
            return CYCLE_S
        if is_database_wide(error):
            logger.error("samples cannot be stored, trying again: %s", error_message(error))
        else:
            logger.error("unexpected error in ingest, going on", exc_info=error)
            self._errors += 1
        if not self._stops_storing(error):
            return 0.0
        of_database = is_database_wide(error)
        self.trouble = error_message(error) if of_database else UNEXPECTED
        self._submissions.trouble = error_outline(error) if of_database else UNEXPECTED
        self._cycle.refuse_all(self._submissions.trouble)
        return RETRY_S

    def _stops_storing(self, error: Exception) -> bool:
        """Return whether an error stops the storing; the first unexpected one in a row does not."""
        return not isinstance(error, LeaseLost) and (is_database_wide(error) or self._errors > 1)

    def _give_up(self, error: Exception) -> None:
        """Log how much of the held data is given up because it could not be stored while stopping."""
        count = len(self._cycle.inbox) + len(self._cycle.write_batch)
        logger.error(
            "at the end %d messages are not stored; only sources' logs have them still: %s", count, error_message(error)
        )

    def _run_cycle(self) -> int:
        """Run a cycle; return how many messages were taken."""
        self._began = time.monotonic()
        with self._longest_cycle.measured():
            count = self._cycle.run(stopping=self._stop.is_set())
        self.trouble = self._submissions.trouble = None
        self._errors = 0
        return count
