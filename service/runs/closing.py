"""Closing of runs: the thread that gathers the samples of runs that have ended, and sorts in samples that came late.

Ingest only notes that a run is over. What belongs to it is read and looked at here, outside of all transactions, and
then stored in one short transaction for each run: however much a run or a document holds, nobody's storing waits for it.
"""

import logging
import time

from sqlalchemy.orm import Session

from service.replication.work_share import Share, WholeShare
from service.resilience.backoff import Backoff
from service.resilience.internal_errors import damaged_blocks, unexpected_error
from service.resilience.supervised_thread import SupervisedThread
from service.runs import late_samples
from service.runs.collector import Collector
from service.runs.run_samples import RunContent, gather
from storage.database.damage import is_damage
from storage.database.engine import Database
from storage.database.errors import LeaseLost, is_database_wide
from storage.findings import jobs
from storage.machines import machines
from storage.measurements import quarantine, runs
from storage.tables import RunRow

logger = logging.getLogger(__name__)

CYCLE_S = 0.2
"""Between two looks for runs that have ended."""
LATE_CHECK_S = 2.0
"""Between two looks for samples that came late."""
RETRY_S = 1.0
MOST_WINDOWS = 20
"""Of one machine, before it is another one's turn."""
AT_ONCE = 500
"""Machines that are looked at together."""


class Closing(SupervisedThread):
    """Closes the runs of the machines that this process stores. collector: the one that ends them."""

    def __init__(self, database: Database, collector: Collector, share: Share | None = None) -> None:
        super().__init__("closing", failure="runs cannot be closed", retry_s=RETRY_S)
        self._database = database
        self._collector = collector
        self._share = share or WholeShare()
        self._run_backoff = Backoff[int]()
        self._machine_backoff = Backoff[str]()
        self._next_late = 0.0

    def turn(self) -> float:
        """Close what has ended; now and then sort in what came late. A stop ends it between two runs."""
        self.close_ended()
        if time.monotonic() >= self._next_late:
            self._next_late = time.monotonic() + LATE_CHECK_S
            self.sort_in_late()
        return CYCLE_S

    def close_ended(self) -> None:
        """Close all runs that have ended. One of which this fails holds up no other. Raises what concerns all."""
        with self._database.reading() as session:
            ended = runs.ended(session)
        for run_id, machine_id in ended:
            if self._stop.is_set():
                return
            if self._share.owns(machine_id) and self._run_backoff.is_due(run_id):
                self._close(run_id, machine_id)

    def sort_in_late(self) -> None:
        """Sort in what came late, where no more of it comes. A machine of which this fails holds up no other.

        Raises what concerns all.
        """
        for machine_id in self._with_late():
            if self._stop.is_set():
                return
            try:
                self._settle(machine_id)
                self._machine_backoff.succeeded(machine_id)
            except LeaseLost:
                logger.info("%s: another replica sorts in what came late", machine_id)
            except Exception as error:
                if is_database_wide(error):
                    raise
                self._note_damage(error, machine_id)
                pause = self._machine_backoff.failed(machine_id)
                logger.exception("%s: late samples cannot be sorted in; tried again in %.0f s", machine_id, pause)
                self._quarantine(machine_id, error, of=f"runs of {machine_id}", what="late samples cannot be sorted in")

    def _close(self, run_id: int, machine_id: str) -> None:
        try:
            with self._database.reading() as session:
                row = runs.get(session, run_id)
                found, version = gather(session, row), _version(row)
            with self._database.transaction(beside_others=True) as session:
                self._share.require(session, [machine_id])
                row = runs.get(session, run_id)
                if _version(row) == version:
                    _close_with(session, row, found)
            self._run_backoff.succeeded(run_id)
        except LeaseLost:
            logger.info("run %d is another replica's to close", run_id)
        except Exception as error:
            if is_database_wide(error):
                raise
            self._note_damage(error, machine_id)
            pause = self._run_backoff.failed(run_id)
            logger.exception("%s: run %d cannot be closed; tried again in %.0f s", machine_id, run_id, pause)
            self._quarantine(machine_id, error, of=f"run {run_id}", what="it cannot be closed")

    def _note_damage(self, error: Exception, machine_id: str) -> None:
        if is_damage(error):
            self._database.damage.record_machine(machine_id)

    def _quarantine(self, machine_id: str, error: Exception, *, of: str, what: str) -> None:
        with self._database.transaction(beside_others=True) as session:
            quarantine.add(session, [unexpected_error(error, of=of, machine_id=machine_id, what=what)])

    def _with_late(self) -> list[str]:
        """Return the machines of which late samples may wait."""
        with self._database.reading() as session:
            own = [machine_id for machine_id in machines.list_ids(session) if self._share.owns(machine_id)]
        unsettled = [machine_id for machine_id in own if self._collector.late.may_wait(machine_id)]
        for first in range(0, len(unsettled), AT_ONCE):
            self._note_settled(unsettled[first : first + AT_ONCE])
        return [one for one in unsettled if self._collector.late.may_wait(one) and self._machine_backoff.is_due(one)]

    def _note_settled(self, machine_ids: list[str]) -> None:
        """See by one look at all of them which have nothing late; where one spoils that, each is looked at alone."""
        try:
            with self._collector.lock, self._database.reading() as session:
                self._collector.late.note_settled(session, machine_ids)
        except Exception as error:
            if is_database_wide(error):
                raise
            logger.warning("%d machines cannot be looked at together: one by one", len(machine_ids), exc_info=error)

    def _settle(self, machine_id: str) -> None:
        """Sort in window by window, the runs that this ends closed in between: the next window may lie beside them."""
        with self._collector.lock, self._database.reading() as session:
            patience = self._collector.late.patience(session, machine_id)
            windows = [] if patience is None else self._collector.late.windows(session, machine_id)
            together = late_samples.by_run(session, machine_id, windows)
        for window in together[:MOST_WINDOWS]:
            if patience is None or self._stop.is_set():
                return
            with self._database.reading() as session:
                plan = late_samples.plan(session, machine_id, window, patience_s=patience)
            if plan is None:
                continue
            with self._collector.lock, self._database.transaction(beside_others=True) as session:
                self._share.require(session, [machine_id])
                if late_samples.still_holds(session, plan) and self._collector.late.take(session, machine_id, window):
                    late_samples.apply(session, plan)
            self.close_ended()


def _version(row: RunRow) -> tuple[object, ...]:
    """Return what changes when a run ends or is made anew."""
    return row.state, row.time_first, row.time_last, row.times_reopened


def _close_with(session: Session, row: RunRow, found: RunContent) -> None:
    """Close a run with what was gathered, and ask for its identification; a run made anew is identified anew."""
    weakness, reason = found.weakness, row.reason or ""
    quarantine.add(session, damaged_blocks(found.damaged, run_id=row.id, machine_id=row.machine_id))
    runs.close(
        row,
        samples=found.samples,
        state=runs.DISCARDED if weakness else runs.CLOSED,
        reason=f"{reason}; {weakness}" if weakness else reason,
        coverage=found.coverage,
        data=found.data,
    )
    logger.info("%s: %s %s with %d samples: %s", row.machine_id, row.kind, row.state, len(found.samples), row.reason)
    if not weakness:
        options = {"reopened": row.times_reopened} if row.times_reopened else None
        jobs.enqueue(session, row.machine_id, scope=jobs.RUN, run_ids=[row.id], options=options)
