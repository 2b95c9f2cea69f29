"""The queue of assessments: stored identifications whose consequences for their machine are still to be concluded.

A machine's identifications are assessed one after the other, in the order in which they were stored. The context is read in
one transaction and the conclusions are written in another; in between a worker computes, and no writer waits for it.
"""

import logging
from collections import Counter, deque
from collections.abc import Callable, Collection
from concurrent.futures import CancelledError, Future
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass

from sqlalchemy.orm import Session

from service.configuration.settings import Settings
from service.monitoring import conclusions, context_loading
from service.monitoring.assessment.context import Assessment, AssessmentContext
from service.monitoring.assessment_task import assess_in_time
from service.replication.held_jobs import HeldJobs
from service.resilience.internal_errors import unexpected_error
from service.workers.executor import Executor, TaskRefused
from service.workers.process_pool import Interrupted, WorkerStuck
from service.workers.time_limit import OutOfTime
from storage.database.damage import is_damage
from storage.database.engine import Database
from storage.database.errors import is_database_wide
from storage.findings import identifications, jobs
from storage.machines import machines
from storage.measurements import quarantine
from storage.tables.findings import IdentificationRow

logger = logging.getLogger(__name__)

LARGEST_ATTEMPTS = 3
"""Largest number of times that an assessment may crash its worker or exceed a limit."""


IdentifyBeside = Callable[[Session, IdentificationRow, Collection[str]], None]


@dataclass(frozen=True)
class DueAssessment:
    """An identification to be assessed, and the job that this finishes."""

    job_id: int
    identification_id: int
    machine_id: str


class AssessmentQueue:
    """Assessments that are due or being computed. For one thread."""

    def __init__(
        self,
        database: Database,
        executor: Executor,
        held: HeldJobs,
        settings: Settings,
        *,
        wake: Callable[[], None],
        identify_beside: IdentifyBeside,
    ) -> None:
        """Set up an empty queue. wake: called from another thread when a worker has computed an assessment. identify_beside:
        queues an identification again with errors left open that its diagnosis has named and it has not found along."""
        self._database = database
        self._executor = executor
        self._held = held
        self._limit_s = settings.identification_timeout_s
        self._baseline_runs = settings.baseline_runs
        self._wake = wake
        self._identify_beside = identify_beside
        self._due: dict[str, deque[DueAssessment]] = {}
        self._computed: dict[Future[Assessment], tuple[DueAssessment, AssessmentContext]] = {}
        self._attempts: Counter[int] = Counter()

    @property
    def job_ids(self) -> frozenset[int]:
        """Return the jobs whose assessment is due or being computed."""
        return frozenset(one.job_id for machine in self._due.values() for one in machine)

    @property
    def computing(self) -> int:
        """Return the number of workers that compute assessments."""
        return sum(not future.done() for future in self._computed)

    def add(self, due: DueAssessment) -> None:
        """Queue an identification that was stored just now, or before this process began."""
        self._due.setdefault(due.machine_id, deque()).append(due)

    def submit(self) -> None:
        """Submit the first assessment of each machine. Raises the database's errors, and ExecutorUnavailable.

        One that could not be submitted is submitted with the next call.
        """
        busy = {due.machine_id for due, _ in self._computed.values()}
        for due in [machine[0] for machine_id, machine in self._due.items() if machine_id not in busy]:
            try:
                context = self._load(due)
            except Exception as error:
                if is_database_wide(error):
                    raise
                self._give_up(due, error)
                continue
            if context is None:
                self._held.finish(due.job_id)
                self._forget(due)
            else:
                future = self._executor.submit(self._limit_s, assess_in_time, (context, self._limit_s))
                future.add_done_callback(lambda _: self._wake())
                self._computed[future] = due, context

    def file_done(self) -> None:
        """Store the conclusions of computed assessments; those that cannot be stored now are retried later."""
        for future in [future for future in self._computed if future.done()]:
            due, context = self._computed.pop(future)
            try:
                self._file(future, due, context)
            except Exception:
                self._computed[future] = due, context
                raise

    def _load(self, due: DueAssessment) -> AssessmentContext | None:
        with self._database.reading() as session:
            stored = identifications.get(session, due.identification_id)
            return context_loading.load_context(session, stored, baseline_runs=self._baseline_runs)

    def _file(self, future: Future[Assessment], due: DueAssessment, context: AssessmentContext) -> None:
        try:
            assessment = future.result()
        except (CancelledError, TaskRefused, Interrupted):
            logger.warning("an assessment of %s was lost with its worker process; it is retried", due.machine_id)
        except (BrokenProcessPool, WorkerStuck, OutOfTime, MemoryError) as error:
            self._attempts[due.job_id] += 1
            logger.error("identification %d cannot be assessed: %s", due.identification_id, error or type(error).__name__)
            if self._attempts[due.job_id] >= LARGEST_ATTEMPTS:
                self._give_up(due, error)
        except Exception as error:  # noqa: BLE001 - whatever an assessment raises is told
            self._give_up(due, error)
        else:
            self._conclude(due, context, assessment)

    def _conclude(self, due: DueAssessment, context: AssessmentContext, assessment: Assessment) -> None:
        """Store all conclusions, or none; when that fails the result is kept, and the next job can go on."""
        try:
            with self._database.transaction() as session:
                row = self._held.own(session, due.job_id)
                if row is not None:
                    machines.lock(session, due.machine_id)
                    stored = identifications.get(session, due.identification_id)
                    state = context_loading.load_state(session, stored)
                    if state.basis != context.basis:
                        logger.info("identification %d is assessed again: baseline or limits were changed", stored.id)
                        return
                    conclusions.apply(session, stored, context, assessment, state)
                    if assessment.left_out and stored.accepted:
                        self._identify_beside(session, stored, assessment.left_out)
                    jobs.finish(row, state=jobs.DONE)
        except Exception as error:
            if is_database_wide(error):
                raise  # it is tried again
            self._give_up(due, error)
        else:
            self._forget(due)

    def _give_up(self, due: DueAssessment, error: Exception) -> None:
        if is_damage(error):
            self._database.damage.record_machine(due.machine_id)
        with self._database.transaction() as session:
            row = self._held.own(session, due.job_id)
            if row is not None:
                _record_unassessed(session, due, error)
                jobs.finish(row, state=jobs.DONE)
        self._forget(due)

    def _forget(self, due: DueAssessment) -> None:
        self._attempts.pop(due.job_id, None)
        machine = self._due[due.machine_id]
        machine.remove(due)
        if not machine:
            del self._due[due.machine_id]


def _record_unassessed(session: Session, due: DueAssessment, error: Exception) -> None:
    logger.error(
        "identification %d of %s is stored, but no alert follows from it",
        due.identification_id,
        due.machine_id,
        exc_info=error,
    )
    of, what = f"identification {due.identification_id}", "it is stored, but no alert follows from it"
    quarantine.add(session, [unexpected_error(error, of=of, machine_id=due.machine_id, what=what)])
