"""The identification jobs that this replica holds: taken from the queue, and not finished or put back yet."""

import logging
from collections.abc import Collection

from sqlalchemy.orm import Session

from service.replication.work_share import Share
from storage.database.engine import Database
from storage.findings import jobs
from storage.operation import replicas
from storage.tables.findings import JobRow

logger = logging.getLogger(__name__)


class HeldJobs:
    """Finishing and putting back of the jobs that this replica holds; jobs taken over by another are left alone."""

    def __init__(self, database: Database, share: Share) -> None:
        """Set up without reading. share: provides this replica's number."""
        self._database = database
        self._share = share

    @property
    def holder(self) -> int | None:
        """Return the number of this replica; None when it is the only one."""
        return self._share.holder

    def own(self, session: Session, job_id: int) -> JobRow | None:
        """Return a job that this replica holds; None when another one has taken it over."""
        try:
            row = jobs.get(session, job_id)
        except jobs.JobUnknown:
            logger.warning("job %d is not in the database any more: its result is left out", job_id)
            return None
        if (row.state, row.holder) == (jobs.RUNNING, self._share.holder):
            return row
        logger.warning("job %d was taken over by another replica: its result is left to that one", job_id)
        return None

    def requeue(self, job_id: int, error: str) -> None:
        """Put a job back for another attempt, or quarantine it after its last one."""
        with self._database.transaction() as session:
            if (row := self.own(session, job_id)) is not None:
                jobs.requeue(session, row, error)

    def requeue_uncounted(self, job_id: int) -> None:
        """Put a job back without counting the attempt."""
        with self._database.transaction() as session:
            if (row := self.own(session, job_id)) is not None:
                jobs.requeue_uncounted(row)

    def fail(self, job_id: int, error: str) -> None:
        """Finish a job as failed for a reason."""
        logger.warning("identification job %d failed: %s", job_id, error)
        with self._database.transaction() as session:
            if (row := self.own(session, job_id)) is not None:
                jobs.finish(row, state=jobs.FAILED, error=error)

    def fail_unread(self, job_id: int, error: str, *, damaged: bool) -> None:
        """Finish a job as failed because its data cannot be read. damaged: the store is damaged, which is noted for the
        machine."""
        logger.error("the data of job %d cannot be read: %s", job_id, error)
        with self._database.transaction() as session:
            row = self.own(session, job_id)
            if row is not None:
                if damaged:
                    self._database.damage.record_machine(row.machine_id)
                jobs.finish(row, state=jobs.FAILED, error=f"its data cannot be read: {error}")

    def finish(self, job_id: int) -> None:
        """Finish a job as done."""
        with self._database.transaction() as session:
            if (row := self.own(session, job_id)) is not None:
                jobs.finish(row, state=jobs.DONE)

    def requeue_unfinished(self) -> None:
        """Put back unfinished jobs of an earlier process, and of replicas that are gone."""
        with self._database.transaction() as session:
            living = [row.id for row in replicas.list_all(session)] if self._share.holder is not None else []
            left = jobs.requeue_running(session, living=living)
        if left:
            logger.info("%d identifications were interrupted and are computed again", left)

    def requeue_lost(self, known: Collection[int]) -> None:
        """Put back jobs whose taking was lost with the database's answer. known: ids of those computed here."""
        with self._database.transaction() as session:
            for row in jobs.held_by(session, self._share.holder):
                if row.id not in known:
                    logger.warning("job %d was taken and not begun; it is taken again", row.id)
                    jobs.requeue_uncounted(row)
