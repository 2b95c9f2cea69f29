"""Errors of measuring chains that a machine's diagnosis has named: jobs whose estimates leave them open.

A history then has the same number for a thing as the alert beside it. Only trains on oil films are estimated beside them, run
by run; fits of several runs together are not.
"""

from collections.abc import Collection

from sqlalchemy.orm import Session

from estimator.diagnosis.open_channels import named_errors
from service.identification import job_options
from service.identification.job_options import OPEN_ERRORS
from storage.findings import diagnoses, jobs
from storage.machines import baselines
from storage.measurements import runs
from storage.tables.findings import IdentificationRow, JobRow

_NAMED_BY = "named_by"
"""Option that tells requests apart: a run may be identified anew, and be diagnosed anew."""


def store_open_errors(session: Session, row: JobRow) -> None:
    """Store with a job the errors that its estimates leave open: those that the diagnosis of the run before has named.

    That run is of the same kind, revision and slow-roll vectors, and was compared with the baseline in force: a probe may have
    been repaired when another baseline was begun.
    """
    options = row.options or {}
    if row.scope not in (jobs.RUN, jobs.VARIANT) or OPEN_ERRORS in options:
        return
    run, version = runs.get(session, row.run_ids[0]), job_options.slow_roll_version(session, row)
    ended = run.time_last or run.time_first
    began = baselines.in_force(session, row.machine_id, at=ended)
    since = 0 if began is None else began.since
    before = diagnoses.newest_on_films(session, run, slow_roll_version=version, since=since, before=ended)
    named = named_errors(diagnoses.named_causes(before))
    if named:
        row.options = {**(row.options or {}), OPEN_ERRORS: sorted(named)}


def identify_beside(session: Session, identification: IdentificationRow, errors: Collection[str]) -> None:
    """Queue an identification of the same run again, with errors left open that its diagnosis has named.

    Those that it was asked to leave open stay so: the list of them only grows, and what it was asked for is not asked again.
    """
    asked = set(identification.options.get(OPEN_ERRORS, ()))
    (run_id,) = identification.run_ids
    run = runs.get(session, run_id)
    if not set(errors) - asked or run.state != runs.CLOSED or run.released_at is not None:
        return
    options = {OPEN_ERRORS: sorted(asked | set(errors)), _NAMED_BY: identification.id}
    jobs.enqueue(session, identification.machine_id, scope=jobs.RUN, run_ids=[run_id], options=options)
