"""Submission of queued jobs to the executor, in their order."""

import logging
from collections.abc import Callable

from sqlalchemy.orm import Session

from estimator.fit.identification import Options
from service.identification import computation, job_options, standing_errors
from service.identification.calibration_computation import compute_calibration
from service.identification.calibration_jobs import calibration_task
from service.identification.calibration_task import CalibrationTask
from service.identification.computing_jobs import ComputingJobs, JobFuture, TakenJob
from service.identification.task import IdentificationTask
from service.identification.task_builder import reopened, task
from service.monitoring.assessment_queue import AssessmentQueue, DueAssessment
from service.replication.held_jobs import HeldJobs
from service.workers.executor import Executor, ExecutorUnavailable
from storage.database.damage import is_damage
from storage.database.engine import Database
from storage.database.errors import error_message, is_database_wide
from storage.findings import identifications, jobs
from storage.findings.job_order import AUTOMATIC, OVERDUE_SHARE
from storage.tables.findings import JobRow

logger = logging.getLogger(__name__)


class JobSubmission:
    """Submission of as many jobs as the executor has capacity for. For one thread."""

    def __init__(
        self,
        database: Database,
        executor: Executor,
        held: HeldJobs,
        computing: ComputingJobs,
        assessments: AssessmentQueue,
        *,
        options: Options,
        timeout_s: float,
        wake: Callable[[], None],
    ) -> None:
        """Set up without taking a job. wake: called from another thread when a job is computed."""
        self._database = database
        self._executor = executor
        self._held = held
        self._computing = computing
        self._assessments = assessments
        self._options = options
        self._timeout_s = timeout_s
        self._wake = wake
        self._automatic_in_a_row = 0

    def submit(self) -> None:
        """Submit the next jobs, if any wait. Raises the database's errors, and ExecutorUnavailable."""
        if not self._any_waiting():
            return
        capacity = self._executor.capacity()
        busy = sum(not future.done() for future in self._computing) + self._assessments.computing
        free = min(capacity - busy, 2 * capacity - len(self._computing))
        asked = sum(not (future.done() or taken.automatic) for future, taken in self._computing.items())
        behind = max(1, capacity - 1) - asked
        if free <= 0 or (behind <= 0 and not self._any_waiting(automatic=True)):
            return
        unavailable: ExecutorUnavailable | None = None
        for taken in self._take(free, behind):
            built = self._task(taken)
            if built is None:
                continue
            try:
                future = self._submitted(built)
                self._computing[future] = taken
                future.add_done_callback(lambda _: self._wake())
            except ExecutorUnavailable as error:
                unavailable = error
                self._held.requeue_uncounted(taken.job_id)
        if unavailable is not None:
            raise unavailable

    def _submitted(self, built: IdentificationTask | CalibrationTask) -> JobFuture:
        if isinstance(built, CalibrationTask):
            return self._executor.submit(built.timeout_s, compute_calibration, built)
        return self._executor.submit(built.timeout_s, computation.compute, built)

    def _any_waiting(self, *, automatic: bool = False) -> bool:
        with self._database.reading() as session:
            return jobs.any_waiting(session, automatic=automatic)

    def _take(self, count: int, behind: int) -> list[TakenJob]:
        """Take the next jobs. behind: how many of them may be requested by people.

        A job whose result was stored, but not assessed, by a process that has ended is only assessed.
        """
        taken = []
        holder = self._held.holder
        with self._database.transaction() as session:
            overdue = self._automatic_in_a_row >= OVERDUE_SHARE - 1
            for row in jobs.claim_next(session, count, holder=holder, behind=behind, overdue=overdue):
                automatic = row.priority == AUTOMATIC
                self._automatic_in_a_row = self._automatic_in_a_row + 1 if automatic else 0
                stored = identifications.of_job(session, row.id)
                if stored is None:
                    if row.scope != jobs.CALIBRATION:  # which subtracts none
                        job_options.slow_roll_version(session, row)
                        self._leave_named_errors_open(session, row)
                    taken.append(TakenJob(row.id, automatic, reopened(session, row), holder))
                else:
                    self._assessments.add(DueAssessment(row.id, stored, row.machine_id))
        return taken

    @staticmethod
    def _leave_named_errors_open(session: Session, row: JobRow) -> None:
        """Store what a job's estimates leave open; a diagnosis that cannot be read holds no job up."""
        try:
            standing_errors.store_open_errors(session, row)
        except Exception as error:
            if is_database_wide(error):
                raise
            logger.exception("job %d is computed without what its machine's diagnosis has named", row.id)

    def _task(self, taken: TakenJob) -> IdentificationTask | CalibrationTask | None:
        """Build a job's task; return None when its data cannot be read, so that other jobs go on."""
        try:
            with self._database.reading() as session:
                row = jobs.get(session, taken.job_id)
                if row.scope == jobs.CALIBRATION:
                    return calibration_task(session, row, timeout_s=self._timeout_s)
                return task(session, row, self._options, timeout_s=self._timeout_s)
        except MemoryError as error:
            self._held.requeue(taken.job_id, f"its data need more memory than there is: {error}")
            return None
        except Exception as error:
            if is_database_wide(error):
                raise
            self._held.fail_unread(taken.job_id, error_message(error), damaged=is_damage(error))
            return None
