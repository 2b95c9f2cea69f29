"""Filing of jobs' outcomes: a result is stored and its assessment queued, an error decides what happens to the job."""

import logging
import time
from collections import deque
from concurrent.futures import CancelledError
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace

from sqlalchemy.exc import DataError, IntegrityError
from sqlalchemy.orm import Session

from estimator.fit.identification import Options
from service.identification.calibration_jobs import file_calibration
from service.identification.calibration_task import CalibrationOutcome
from service.identification.computing_jobs import ComputingJobs, JobFuture, TakenJob
from service.identification.task import IdentificationOutcome
from service.identification.task_builder import origin, reopened
from service.monitoring.assessment_queue import AssessmentQueue, DueAssessment
from service.replication.held_jobs import HeldJobs
from service.workers.executor import TaskRefused
from service.workers.process_pool import Interrupted, WorkerStuck
from service.workers.time_limit import OutOfTime
from storage.database.engine import Database
from storage.database.errors import is_database_wide
from storage.findings import derived, identifications, jobs
from storage.machines import machines
from storage.measurements import runs
from storage.tables.findings import IdentificationRow, JobRow

logger = logging.getLogger(__name__)

REPORTED_S = 3600.0
"""Time for which a warning is shown for a job whose process stopped responding."""


class ResultFiling:
    """Filing of the executor's results. For one thread."""

    def __init__(
        self, database: Database, held: HeldJobs, computing: ComputingJobs, assessments: AssessmentQueue, options: Options
    ) -> None:
        """Set up with nothing filed. options: options of a usual fit."""
        self._database = database
        self._held = held
        self._computing = computing
        self._assessments = assessments
        self._options = options
        self._stuck: deque[tuple[float, str]] = deque(maxlen=1000)
        self.stuck_count = 0
        """Number of jobs given up since the start because their process stopped responding."""

    @property
    def warnings(self) -> list[str]:
        """Return a warning of processes that stopped responding within the last hour."""
        stuck = [words for at, words in self._stuck if time.monotonic() < at + REPORTED_S]
        return [f"identifications given up in the last hour: {len(stuck)}; of the last one, {stuck[-1]}"] if stuck else []

    def file_done(self) -> None:
        """File all computed outcomes. One that cannot be filed now is retried after the others, so that it does not block
        them."""
        for future in [future for future in self._computing if future.done()]:
            taken = self._computing.pop(future)
            try:
                self._file(future, taken)
            except Exception:
                self._computing[future] = taken
                raise

    def _file(self, future: JobFuture, taken: TakenJob) -> None:
        if taken.holder != self._held.holder:
            # Others believed this replica dead and put its jobs back: whoever took this one since computes it, perhaps this
            # process under its new number.
            logger.warning(
                "job %d was put back while this replica was thought dead: its earlier result is left out", taken.job_id
            )
            return
        try:
            outcome: IdentificationOutcome | CalibrationOutcome = future.result()
        except Exception as error:  # noqa: BLE001 - whatever a fit raises is recorded with its job
            self._file_error(taken.job_id, error)
            return
        try:
            self._store(taken, outcome)
        except (DataError, IntegrityError) as error:
            self._held.fail(taken.job_id, f"its result cannot be stored: {error.orig}")
        except MemoryError:
            raise  # of the moment, not of the result
        except Exception as error:
            if is_database_wide(error):
                raise  # so is this
            logger.exception("the result of job %d cannot be stored", taken.job_id)
            self._held.fail(taken.job_id, f"its result cannot be stored: {type(error).__name__}: {error}")

    def _file_error(self, job_id: int, error: Exception) -> None:
        """Put a job back if the error is not its own or may not recur; fail it otherwise."""
        if isinstance(error, BrokenProcessPool):
            logger.error("the worker process of job %d died; it is retried", job_id)
            self._held.requeue(job_id, str(error))
        elif isinstance(error, WorkerStuck):
            logger.error("job %d was given up with its worker process; it is tried three times at most: %s", job_id, error)
            self._stuck.append((time.monotonic(), str(error)))
            self.stuck_count += 1
            self._held.requeue(job_id, f"Stuck: {error}")
        elif isinstance(error, TaskRefused | Interrupted):
            logger.warning("job %d is retried: %s", job_id, error)
            self._held.requeue_uncounted(job_id)
        elif isinstance(error, CancelledError):
            logger.warning("job %d was lost with its worker process; it is retried", job_id)
            self._held.requeue_uncounted(job_id)
        elif isinstance(error, OutOfTime | MemoryError):
            # With fewer jobs running it may finish within both: it is retried as often as after a crash.
            logger.error(
                "job %d exceeded its time or memory limit; it is tried three times at most: %s", job_id, type(error).__name__
            )
            self._held.requeue(job_id, f"{type(error).__name__}: {error}")
        else:
            self._held.fail(job_id, f"{type(error).__name__}: {error}")

    def _store(self, taken: TakenJob, outcome: IdentificationOutcome | CalibrationOutcome) -> None:
        """Store an outcome and finish its job, or queue its assessment, which finishes the job."""
        with self._database.transaction() as session:
            row = self._held.own(session, taken.job_id)
            if row is None:
                return
            machines.lock(session, row.machine_id)
            if reopened(session, row) != taken.reopened:
                logger.info("job %d is computed again: late samples have rebuilt its run meanwhile", taken.job_id)
                jobs.requeue_uncounted(row)
                return
            if isinstance(outcome, CalibrationOutcome):
                file_calibration(session, row, outcome)
                return
            # Of dwells there are variants only: the newest one's quality is theirs.
            if row.scope == jobs.RUN or runs.is_dwells(runs.get(session, row.run_ids[0])):
                runs.store_quality(session, row.run_ids[0], outcome.qualities[0])
                runs.store_crossed_speeds(session, row.run_ids[0], outcome.crossed[0])
            if outcome.identification is None:
                jobs.finish(row, state=jobs.FAILED, error=outcome.error)
                logger.warning("identification job %d failed: %s", taken.job_id, outcome.error)
                return
            stored = _stored(session, row, self._options, outcome)
            due = DueAssessment(taken.job_id, stored.id, stored.machine_id)
        self._assessments.add(due)
        logger.info("%s: identification %d %s", row.machine_id, stored.id, outcome.identification.verdict)


def _stored(session: Session, row: JobRow, options: Options, outcome: IdentificationOutcome) -> IdentificationRow:
    """Store an identification with its derived quantities."""
    assert outcome.identification is not None
    came_from = origin(session, row, options, outcome.beginning)
    came_from = replace(came_from, conditions=outcome.conditions or None, load_balance=outcome.load_balance)
    stored = identifications.add(session, came_from, outcome.identification)
    derived.add(session, stored, outcome.derived)
    if outcome.underived is not None:
        logger.warning("no derived quantities for identification %d: %s", stored.id, outcome.underived)
    session.flush()
    return stored
