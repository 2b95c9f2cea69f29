"""Errors of measuring chains and couplings that a machine's diagnosis has named: jobs whose estimates leave them open.

A history then has the same number for a thing as the alert beside it.
"""

from collections.abc import Collection

from sqlalchemy.orm import Session

from estimator.diagnosis.open_channels import named_errors
from estimator.machine.film_speeds import follows_films
from service.identification.job_options import OPEN_ERRORS
from storage.findings import diagnoses, jobs
from storage.machines import machines
from storage.measurements import runs
from storage.tables.findings import IdentificationRow, JobRow


def store_open_errors(session: Session, row: JobRow) -> None:
    """Store with a job the errors that its estimates leave open: those that the diagnosis named which is the newest by then.

    Only trains on oil films are estimated beside them.
    """
    options = row.options or {}
    if row.scope not in (jobs.RUN, jobs.VARIANT) or OPEN_ERRORS in options:
        return
    run = runs.get(session, row.run_ids[0])
    newest = diagnoses.newest(session, row.machine_id, last=run.time_last or run.time_first)
    named = named_errors(diagnoses.named_causes(newest))
    if named and follows_films(machines.document(session, row.machine_id, run.revision)):
        row.options = {**options, OPEN_ERRORS: sorted(named)}


def identify_beside(session: Session, identification: IdentificationRow, errors: Collection[str]) -> None:
    """Queue an identification of the same run again, with errors left open that its diagnosis has named."""
    options = {OPEN_ERRORS: sorted(errors)}
    jobs.enqueue(session, identification.machine_id, scope=jobs.RUN, run_ids=identification.run_ids, options=options)
