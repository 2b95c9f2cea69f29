"""The scheduler of identification jobs: the thread that keeps the workers busy and files their results."""

import logging
import threading
import time

from estimator.fit.identification import Options
from service.configuration.settings import Settings
from service.identification import standing_errors
from service.identification.computing_jobs import ComputingJobs
from service.identification.job_submission import JobSubmission
from service.identification.pooled_jobs import queue_pooled_jobs
from service.identification.result_filing import ResultFiling
from service.identification.worker_tasks import TASKS
from service.monitoring.assessment_queue import AssessmentQueue
from service.replication.held_jobs import HeldJobs
from service.replication.work_share import GATHERING, Share, WholeShare
from service.resilience.supervised_thread import SupervisedThread
from service.workers.executor import Executor, ExecutorUnavailable
from service.workers.executors import executor_of
from storage.database.engine import Database

logger = logging.getLogger(__name__)

POLL_S = 0.1
RETRY_S = 1.0


class JobScheduler(SupervisedThread):
    """Scheduler that takes queued jobs, has them computed, files the results and has these assessed."""

    def __init__(
        self, database: Database, settings: Settings, share: Share | None = None, *, executor: Executor | None = None
    ) -> None:
        """Set up without starting.

        share: this replica's share of the work; all of it by default. executor: a shared executor, which stays open when this
        scheduler ends; by default a new one after the settings, which ends with this scheduler.
        """
        super().__init__("identifying", failure="identification jobs cannot be read or filed", retry_s=RETRY_S)
        self._database = database
        self._settings = settings
        self._share = share or WholeShare()
        self._executor = executor or executor_of(settings, TASKS)
        self._owns_executor = executor is None
        self._held = HeldJobs(database, self._share)
        self._computing: ComputingJobs = {}
        self._news = threading.Event()  # a result is there, or the service stops
        self._assessments = AssessmentQueue(
            database,
            self._executor,
            self._held,
            settings,
            wake=self._news.set,
            identify_beside=standing_errors.identify_beside,
        )
        options = Options()
        self._submission = JobSubmission(
            database,
            self._executor,
            self._held,
            self._computing,
            self._assessments,
            options=options,
            timeout_s=settings.identification_timeout_s,
            wake=self._news.set,
        )
        self._filing = ResultFiling(database, self._held, self._computing, self._assessments, options)
        self._pooled_at = 0.0
        self._may_have_lost = False  # jobs, taken in a transaction whose outcome is unknown

    def start(self) -> None:
        """Put back jobs that an earlier process left unfinished, then start the thread."""
        self._held.requeue_unfinished()
        self._pooled_at = time.monotonic()
        super().start()

    def stop(self) -> None:
        """Take no more jobs and end the workers; their jobs are computed again after the next start."""
        self._stop.set()
        self._news.set()
        super().stop()
        if self._owns_executor:
            self._executor.close()

    @property
    def warnings(self) -> list[str]:
        """Return the executor's problems that do not prevent taking jobs, and unresponsive workers of the last hour."""
        return [*self._executor.warnings(), *self._filing.warnings]

    @property
    def gauges(self) -> dict[str, float]:
        """Return figures for monitoring, by the name of the metric."""
        return {"rundown_stuck_identifications": self._filing.stuck_count}

    def run_once(self) -> float:
        """Wait for news, for POLL_S at most, then schedule jobs."""
        self._news.wait(POLL_S)
        self._news.clear()
        if self._may_have_lost:
            self._put_back_lost()
            self._may_have_lost = False
        self._schedule()
        self._executor.require_workers()  # behind: what waits is the next try to start one
        return 0.0

    def failed(self, error: Exception) -> float:
        """Log an error and keep it as `trouble`; after one that is not the executor's, taken jobs may be lost."""
        if isinstance(error, ExecutorUnavailable):
            if str(error) != self.trouble:
                logger.error("%s; trying again", error)
            self.trouble = str(error)
            return RETRY_S
        self._may_have_lost = True
        return super().failed(error)

    def _schedule(self) -> None:
        """Submit waiting jobs, file computed ones, and queue pooled jobs when it is time."""
        try:
            self._executor.check_tasks()
            self._assessments.submit()
            self._submission.submit()  # first: no worker need wait for results to be filed
        finally:
            self._filing.file_done()
            self._assessments.file_done()
        interval = self._settings.gathered_interval_s
        if time.monotonic() - self._pooled_at >= interval and self._share.is_leader(GATHERING):
            self._pooled_at = time.monotonic()
            queue_pooled_jobs(self._database, newest_runs=self._settings.gathered_runs)

    def _put_back_lost(self) -> None:
        """Put back own jobs that are unknown here: the database's answer was lost when they were taken."""
        computing = {taken.job_id for taken in self._computing.values() if taken.holder == self._held.holder}
        self._held.requeue_lost(computing | self._assessments.job_ids)
