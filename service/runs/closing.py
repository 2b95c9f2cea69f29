"""Closing of runs: the thread that collects the samples of ended runs, and sorts in late samples.

Ingest only notes that a run is over. Its samples are read and checked here, outside of all transactions, and then stored in
one short transaction per run: however large a run or a document is, it does not delay other writers.
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
from storage.tables.measurements import RunRow

logger = logging.getLogger(__name__)

CYCLE_S = 0.2
"""Pause between two looks for ended runs."""
LATE_CHECK_S = 2.0
"""Interval between two looks for late samples."""
RETRY_S = 1.0
MAXIMUM_WINDOWS = 20
"""Windows of one machine that are sorted in before another machine's turn."""
AT_ONCE = 500
"""Machines that are checked together."""


class Closing(SupervisedThread):
    """The thread that closes the runs of the machines that this process stores. collector: the one that ends the runs."""

    def __init__(self, database: Database, collector: Collector, share: Share | None = None) -> None:
        super().__init__("closing", failure="runs cannot be closed", retry_s=RETRY_S)
        self._database = database
        self._collector = collector
        self._share = share or WholeShare()
        self._run_backoff = Backoff[int]()
        self._machine_backoff = Backoff[str]()
        self._next_late = 0.0

    def run_once(self) -> float:
        """Close ended runs; now and then sort in late samples. A stop takes effect between two runs."""
        self.close_ended()
        if time.monotonic() >= self._next_late:
            self._next_late = time.monotonic() + LATE_CHECK_S
            self.sort_in_late()
        return CYCLE_S

    def close_ended(self) -> None:
        """Close all ended runs; a failure with one does not block the others. Raises errors that affect all runs."""
        with self._database.reading() as session:
            ended = runs.ended(session)
        for run_id, machine_id in ended:
            if self._stop.is_set():
                return
            if self._share.is_owner(machine_id) and self._run_backoff.is_due(run_id):
                self._close(run_id, machine_id)

    def sort_in_late(self) -> None:
        """Sort in late samples once no more of them come; a failure with one machine does not block the others.

        Raises errors that affect all machines.
        """
        for machine_id in self._with_late():
            if self._stop.is_set():
                return
            try:
                self._sort_in_windows(machine_id)
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
            logger.info("another replica closes run %d", run_id)
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
        """Return the machines that may have late samples."""
        with self._database.reading() as session:
            own = [machine_id for machine_id in machines.list_ids(session) if self._share.is_owner(machine_id)]
        unsettled = [machine_id for machine_id in own if self._collector.late.may_wait(machine_id)]
        for first in range(0, len(unsettled), AT_ONCE):
            self._note_settled(unsettled[first : first + AT_ONCE])
        return [one for one in unsettled if self._collector.late.may_wait(one) and self._machine_backoff.is_due(one)]

    def _note_settled(self, machine_ids: list[str]) -> None:
        """Note which of the machines have no late samples; when the joint query fails, each is checked alone."""
        try:
            with self._collector.lock, self._database.reading() as session:
                self._collector.late.note_settled(session, machine_ids)
        except Exception as error:
            if is_database_wide(error):
                raise
            logger.warning(
                "%d machines cannot be checked together; they are checked one by one", len(machine_ids), exc_info=error
            )

    def _sort_in_windows(self, machine_id: str) -> None:
        """Sort in window by window, and close the runs that this ends in between: the next window may lie beside them."""
        with self._collector.lock, self._database.reading() as session:
            patience = self._collector.late.patience(session, machine_id)
            windows = [] if patience is None else self._collector.late.windows(session, machine_id)
            together = late_samples.by_run(session, machine_id, windows)
        for window in together[:MAXIMUM_WINDOWS]:
            if patience is None or self._stop.is_set():
                return
            with self._database.reading() as session:
                plan = late_samples.plan(session, machine_id, window, patience_s=patience)
            if plan is None:
                continue
            with self._collector.lock, self._database.transaction(beside_others=True) as session:
                self._share.require(session, [machine_id])
                if late_samples.is_plan_current(session, plan) and self._collector.late.take(session, machine_id, window):
                    late_samples.apply(session, plan)
            self.close_ended()


def _version(row: RunRow) -> tuple[object, ...]:
    """Return the values that change when a run ends or is rebuilt."""
    return row.state, row.time_first, row.time_last, row.times_reopened


def _close_with(session: Session, row: RunRow, found: RunContent) -> None:
    """Close a run with its samples and queue its identification, again for a rebuilt run."""
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
