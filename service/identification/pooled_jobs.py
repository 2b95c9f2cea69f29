"""Jobs that identify a machine from its newest runs together, queued at intervals."""

from sqlalchemy.orm import Session

from storage.database.engine import Database
from storage.findings import jobs
from storage.machines import machines
from storage.measurements import runs
from storage.tables.machines import MachineRow

AT_ONCE = 10
"""Machines whose jobs are queued in one transaction."""


def queue_pooled_jobs(database: Database, *, newest_runs: int) -> None:
    """Queue an identification over the newest runs, at most `newest_runs`, of each machine with more than one."""
    with database.reading() as session:
        every = machines.list_ids(session)
    for first in range(0, len(every), AT_ONCE):
        with database.transaction() as session:
            for machine in machines.by_ids(session, every[first : first + AT_ONCE]):
                _queue(session, machine, newest_runs=newest_runs)


def _queue(session: Session, machine: MachineRow, *, newest_runs: int) -> None:
    newest = runs.newest_closed(session, machine.id, revision=machine.revision, limit=newest_runs)
    if len(newest) > 1:
        ordered = sorted(newest, key=lambda run: run.id)
        again = [run.times_reopened or 0 for run in ordered]
        # Runs rebuilt with late samples are pooled again.
        options = {"reopened": again} if any(again) else None
        jobs.enqueue(session, machine.id, scope=jobs.GATHERED, run_ids=[run.id for run in ordered], options=options)
