"""Building a job's task from its runs' samples, its options and the runs it is compared with; and its result's origin."""

import logging

from sqlalchemy.orm import Session

from estimator.fit.identification import Options
from estimator.machine.document import parse_machine
from rotorundown.environment.release import VERSION
from service.identification import job_options
from service.identification.task import IdentificationTask
from storage.encoding.sample_blocks import DamagedBlock, encode
from storage.findings import identifications, jobs
from storage.findings.identifications import Origin
from storage.machines import machines, slow_roll
from storage.measurements import runs
from storage.tables.findings import JobRow

logger = logging.getLogger(__name__)

GATHERED_KIND = "gathered"
"""`run_kind` of an identification from several runs, which may be of both kinds."""


def reopened(session: Session, row: JobRow) -> tuple[int, ...]:
    """Return how often each of a job's runs has been rebuilt."""
    return tuple(runs.get(session, run_id).times_reopened or 0 for run_id in row.run_ids)


def task(session: Session, row: JobRow, options: Options, *, timeout_s: float) -> IdentificationTask:
    """Build the task of a job whose slow-roll version is stored. Raises the errors of reading its data."""
    first = runs.get(session, row.run_ids[0])
    revision = first.revision
    blocks = [encode(held) for run_id in row.run_ids if (held := runs.samples(session, run_id)) is not None]
    document = machines.revision(session, row.machine_id, revision).document
    version = job_options.slow_roll_version(session, row)
    machine, vectors = parse_machine(document), None
    if version is not None:
        vectors = slow_roll.vectors(slow_roll.get(session, row.machine_id, version), machine)
    return IdentificationTask(
        document,
        blocks,
        job_options.fit_options(row, options),
        timeout_s,
        rules=job_options.quality_rules(row, machine.quality),
        earlier=_earlier(session, row) if row.scope == jobs.RUN else None,
        slow_roll=vectors,
        beginning=_beginning(session, row, revision, version),
        steady=runs.is_dwells(first),
    )


def _beginning(session: Session, row: JobRow, revision: int, slow_roll_version: int | None) -> tuple[int, bytes] | None:
    """Return the point of the machine's first good identification: a fit that starts there is not misled by outliers."""
    first = identifications.first_of(session, row.machine_id, revision=revision, slow_roll_version=slow_roll_version)
    return None if first is None or first.point is None else (first.id, first.point)


def _earlier(session: Session, row: JobRow) -> tuple[str, bytes] | None:
    """Return the run for comparison: the one before of the same kind, revision and sense of rotation; None without one."""
    before = runs.previous_run(session, runs.get(session, row.run_ids[0]))
    if before is None:
        return None
    try:
        held = runs.samples(session, before.id)
    except (DamagedBlock, runs.SamplesReleased) as error:
        logger.warning("run %d is not compared with run %d: %s", row.run_ids[0], before.id, error)
        return None
    return None if held is None else (f"run {before.id}", encode(held))


def origin(session: Session, row: JobRow, options: Options, beginning: int | None) -> Origin:
    """Return the origin of an identification. beginning: id of the identification from which the fit started, if any."""
    used = [runs.get(session, run_id) for run_id in row.run_ids]
    version = job_options.slow_roll_version(session, row)
    described = job_options.described_options(row, options)
    if beginning is not None:
        described["beginning"] = beginning
    if version is not None:
        machine = machines.document(session, row.machine_id, used[0].revision)
        described["slow_roll_left_out"] = slow_roll.doubtful(slow_roll.get(session, row.machine_id, version), machine)
    return Origin(
        machine_id=row.machine_id,
        revision=used[0].revision,
        job_id=row.id,
        scope=row.scope,
        run_kind=GATHERED_KIND if row.scope == jobs.GATHERED else used[0].kind,
        run_ids=row.run_ids,
        measured_at=max(run.time_last or run.time_first for run in used),
        options=described,
        code_version=VERSION,
        slow_roll_version=version,
    )
