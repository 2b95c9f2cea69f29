"""Calibrations of machines from stored runs: asked for, built for a worker, filed, and put in force.

A calibration changes nothing by itself: put in force it is a new revision of the document, which every later fit starts from
and is held by.
"""

import logging
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from msgspec.structs import replace
from sqlalchemy.orm import Session

from estimator.calibration.calibrated_document import calibrated_document, is_the_same_but_for_calibrations, with_gain_drift
from estimator.calibration.calibration_runs import CalibrationRun
from estimator.errors import Conflict, Invalid
from estimator.machine.document import Machine, parse_machine
from estimator.runs.dwells import dwelling
from rotorundown.environment.release import VERSION
from service.balancing.stored_runs import StoredWeight, added_unbalance, read_weights
from service.identification.calibration_task import CalibrationOutcome, CalibrationTask, StoredCalibrationRun
from service.identification.job_options import Requester
from service.identification.job_quota import LONGEST_IDENTITY
from service.monitoring import baseline_changes
from storage.clock import now
from storage.encoding.sample_blocks import Samples, encode
from storage.findings import jobs
from storage.machines import machines, model_calibrations, timeline
from storage.measurements import runs
from storage.tables.findings import JobRow
from storage.tables.machines import ModelCalibrationRow, RevisionRow
from storage.tables.measurements import RunRow

logger = logging.getLogger(__name__)

CALIBRATION = "calibration"
"""Kind of its entry on the timeline."""


class CalibrationRunUnsuitable(Invalid):
    """Raised for a run that cannot be part of a calibration: open, named twice, of another machine or of another train."""


class DocumentMoved(Conflict):
    """Raised when a document was changed while runs were checked under it."""


class CalibrationRefused(Conflict):
    """Raised when a calibration cannot be put in force; the message states the reason."""


@dataclass(frozen=True)
class CalibrationRunAsked:
    """A stored run with all weights that were on. mounting: its name; by default the run is a mounting of its own."""

    run: int
    weights: tuple[StoredWeight, ...] = ()
    mounting: str | None = None
    steady: bool = False


def require_place(session: Session, machine_id: str, requester: Requester) -> None:
    """Raise QuotaExceeded unless another calibration may be asked for."""
    requester.quota.require(session, by=requester.identity[:LONGEST_IDENTITY], machine_id=machine_id)


def read_runs(
    session: Session, machine_id: str, revision: int, asked: Sequence[CalibrationRunAsked]
) -> tuple[Machine, list[CalibrationRun]]:
    """Return a machine and the runs that shall calibrate it, for `check_runs` of the estimator.

    Raises MachineUnknown, RunUnknown, CalibrationRunUnsuitable, SamplesReleased.
    """
    numbers = Counter(one.run for one in asked)
    twice = sorted(run for run, times in numbers.items() if times > 1)
    if twice:
        raise CalibrationRunUnsuitable(f"run {twice[0]} stands twice in the calibration: each run counts once")
    machine = machines.document(session, machine_id, revision)
    return machine, [_checked(session, machine, one) for one in asked]


def request_calibration(
    session: Session,
    machine_id: str,
    asked: Sequence[CalibrationRunAsked],
    requester: Requester,
    *,
    revision: int,
    seed: int,
    by: str,
    comment: str,
) -> ModelCalibrationRow:
    """Queue a calibration from stored runs, which were checked under a revision of the document as far as that costs no fit.

    Raises MachineUnknown, DocumentMoved, QuotaExceeded, and where a run was changed since RunUnknown,
    CalibrationRunUnsuitable, SamplesReleased.
    """
    if machines.get(session, machine_id).revision != revision:
        raise DocumentMoved(
            f"the document of machine '{machine_id}' was changed meanwhile: ask again, with another Idempotency-Key"
        )
    require_place(session, machine_id, requester)
    for one in asked:
        _require_usable(runs.get(session, one.run), steady=one.steady)
    stored = {"runs": [asdict(one) for one in asked], "seed": seed}
    row = model_calibrations.add(session, machine_id, revision=revision, asked=stored, by=by, comment=comment)
    job = jobs.enqueue(
        session,
        machine_id,
        scope=jobs.CALIBRATION,
        run_ids=[one.run for one in asked],
        options={CALIBRATION: row.id},
        asked_by=requester.identity[:LONGEST_IDENTITY],
        priority=requester.priority,
    )
    assert job is not None
    row.job_id = job.id
    return row


def of_job(session: Session, job: JobRow) -> ModelCalibrationRow:
    """Return the calibration that a job computes. Raises ModelCalibrationUnknown."""
    return model_calibrations.get(session, job.machine_id, (job.options or {})[CALIBRATION], to_change=True)


def calibration_task(session: Session, job: JobRow, *, timeout_s: float) -> CalibrationTask:
    """Build the task of a calibration's job. Raises the errors of reading its data."""
    row = of_job(session, job)
    document = machines.revision(session, row.machine_id, row.revision).document
    machine = parse_machine(document)
    found = [_stored(session, machine, _read(one)) for one in row.asked["runs"]]
    return CalibrationTask(document, found, int(row.asked["seed"]), timeout_s)


def file_calibration(session: Session, job: JobRow, outcome: CalibrationOutcome) -> None:
    """Store a calibration and finish its job."""
    row = of_job(session, job)
    told = {"remarks": list(outcome.remarks), "starts": outcome.starts, "unique": outcome.unique}
    model_calibrations.record(
        row,
        accepted=outcome.accepted,
        verdict=outcome.verdict,
        result=told,
        document=outcome.document,
        code_version=VERSION,
    )
    jobs.finish(job, state=jobs.DONE)
    logger.info("%s: calibration %d %s", row.machine_id, row.id, outcome.verdict)


def put_in_force(session: Session, machine_id: str, calibration_id: int, *, by: str, gain_drift: float = 0.0) -> RevisionRow:
    """Make an accepted calibration part of the document in force, as a new revision, and note it on the timeline.

    gain_drift: rms by which channels' gains may have changed until a later run, in parts of them [-].

    Raises MachineUnknown, ModelCalibrationUnknown, CalibrationRefused.
    """
    row = model_calibrations.get(session, machine_id, calibration_id, to_change=True)
    if not row.accepted or row.document is None:
        why = "it is not computed yet" if row.accepted is None else f"it was not accepted: {row.verdict}"
        raise CalibrationRefused(f"calibration {calibration_id} cannot be put in force: {why}")
    calibrated, current = with_gain_drift(parse_machine(row.document), gain_drift), machines.document(session, machine_id)
    if not is_the_same_but_for_calibrations(calibrated, current):
        raise CalibrationRefused(
            f"calibration {calibration_id} is of revision {row.revision} of the document; the one in force describes another "
            "train: calibrate that one"
        )
    assert calibrated.calibration is not None
    revision = baseline_changes.revise(session, calibrated_document(current, calibrated, calibrated.calibration))
    if row.revision_in_force != revision.revision:
        row.revision_in_force = revision.revision
        words = f"calibration {row.id} of the model is in force, as revision {revision.revision} of the document"
        timeline.add(session, machine_id, at=now(), kind=CALIBRATION, text=words, by=by)
    return revision


def _checked(session: Session, machine: Machine, one: CalibrationRunAsked) -> CalibrationRun:
    """Return a run as the checks before a fit need it. Raises RunUnknown, CalibrationRunUnsuitable, SamplesReleased."""
    run = runs.get(session, one.run)
    if run.machine_id != machine.id:
        raise CalibrationRunUnsuitable(f"run {one.run} is one of machine '{run.machine_id}', not of '{machine.id}'")
    if not is_the_same_but_for_calibrations(machine, machines.document(session, machine.id, run.revision)):
        raise CalibrationRunUnsuitable(
            f"run {one.run} was measured under revision {run.revision} of the document, which describes another train than "
            "the one in force"
        )
    _require_usable(run, steady=one.steady)
    held = _samples(session, one)
    added = np.tile(added_unbalance(machine, one.weights), (len(held), 1))
    measurement = replace(held.measurement(), added=added)
    return CalibrationRun(_name(one), measurement, (_mounting(one),) * len(held), one.steady)


def _require_usable(run: RunRow, *, steady: bool) -> None:
    """Raise CalibrationRunUnsuitable or SamplesReleased unless a run is over and its samples calibrate."""
    if run.state not in (runs.CLOSED, runs.DISCARDED):
        raise CalibrationRunUnsuitable(f"run {run.id} is {run.state}: only closed runs calibrate, and dwells")
    if run.state == runs.DISCARDED and not steady:
        raise CalibrationRunUnsuitable(
            f"run {run.id} is discarded ({run.reason}), and calibrates nothing as a sweep; where its samples are dwells at "
            "constant speed, say so: `steady: true`"
        )
    runs.require_kept(run)


def _stored(session: Session, machine: Machine, one: CalibrationRunAsked) -> StoredCalibrationRun:
    added = added_unbalance(machine, one.weights)
    return StoredCalibrationRun(_name(one), encode(_samples(session, one)), added, _mounting(one), one.steady)


def _samples(session: Session, one: CalibrationRunAsked) -> Samples:
    """Return the samples of a run that calibrate: all of a sweep, those at constant speed of dwells."""
    held = runs.samples(session, one.run)
    if held is None or len(held) == 0:
        raise CalibrationRunUnsuitable(f"run {one.run} has no samples")
    return held.pick(dwelling(held.speed)) if one.steady else held


def _read(said: Mapping[str, Any]) -> CalibrationRunAsked:
    return CalibrationRunAsked(**{**said, "weights": tuple(read_weights(said["weights"]))})


def _name(one: CalibrationRunAsked) -> str:
    return f"run {one.run}"


def _mounting(one: CalibrationRunAsked) -> str:
    return one.mounting or _name(one)
