"""Calibrations of a machine's model from stored runs with known unbalances: asked for, read, put in force."""

from fastapi import APIRouter, Request, Response, status
from sqlalchemy.orm import Session

from estimator.calibration.calibration_runs import check_runs
from estimator.machine.calibration import Calibration
from estimator.machine.disc_scale import DiscScale
from estimator.machine.document import parse_machine
from estimator.runs.dwells import DWELLS
from service.api.cache.model_process import ModelProcess
from service.api.cache.worker_computation import compute_in_worker
from service.api.conventions.changes_in_turn import change_place, takes_turns_of_its_own
from service.api.conventions.dependencies import MachineId, Number, Reading, database, requester
from service.api.conventions.paging import ById
from service.api.conventions.problems import CHANGES, RESPONSES, WAIT, Unsuitable
from service.api.conventions.values import time_or_none
from service.api.machines import model_calibration_schemas as schemas
from service.balancing.stored_runs import read_weights
from service.identification import calibration_jobs
from service.identification.calibration_jobs import CalibrationRunAsked
from service.security.requirement import ADMIN, ANALYST, VIEWER
from storage.clock import to_datetime
from storage.findings import jobs
from storage.machines import balancings, machines, model_calibrations
from storage.measurements import runs
from storage.tables.machines import ModelCalibrationRow

router = APIRouter(
    prefix="/machines/{machine_id}/model-calibrations", tags=["calibration"], responses=RESPONSES, dependencies=[VIEWER]
)


@router.get("", operation_id="list_model_calibrations")
def list_model_calibrations(session: Reading, machine_id: MachineId, paging: ById) -> list[schemas.ModelCalibrationSummary]:
    """List calibrations of the machine's model, newest first."""
    in_force = machines.document(session, machine_id).calibration
    rows = model_calibrations.of_machine(session, machine_id, limit=paging.wanted, after=paging.after)
    return [_summary(session, row, in_force) for row in paging.page(rows, lambda row: (row.id,))]


@router.get("/{calibration_id}", operation_id="read_model_calibration")
def read_model_calibration(session: Reading, machine_id: MachineId, calibration_id: Number) -> schemas.ModelCalibrationOut:
    """Read a calibration: its runs, its verdict, and the machine's document with it."""
    row = model_calibrations.get(session, machine_id, calibration_id)
    return _rendered(session, row)


@router.post(
    "",
    operation_id="request_model_calibration",
    dependencies=[ANALYST],
    status_code=status.HTTP_202_ACCEPTED,
    responses=WAIT,
)
@takes_turns_of_its_own
def request_model_calibration(
    request: Request, response: Response, machine_id: MachineId, body: schemas.ModelCalibrationIn
) -> schemas.ModelCalibrationOut:
    """Calibrate the model from stored runs with known unbalances; a worker computes it, and Location is where it will be.

    The weights stand in `runs`, or with the trial runs of a `balancing`. Nothing changes until it is put in force. Answers 429
    while the quota of waiting identifications is used up.
    """
    with database(request).reading() as session:
        calibration_jobs.require_place(session, machine_id, requester(request))
        revision = machines.get(session, machine_id).revision
        direction = machines.document(session, machine_id, revision).direction
        asked = [_calibration_run(one, body.disc_scale, direction) for one in body.runs]
        if body.balancing is not None:
            asked += _of_a_balancing(session, machine_id, body.balancing)

    def check(process: ModelProcess) -> None:
        with database(request).reading() as reading:
            machine, found = calibration_jobs.read_runs(reading, machine_id, revision, asked)
        process.compute(check_runs, machine, found)

    compute_in_worker(request, ("runs of a calibration", machine_id, revision, tuple(asked)), check)
    with change_place(request), database(request).transaction() as session:
        row = calibration_jobs.request_calibration(
            session,
            machine_id,
            asked,
            requester(request),
            revision=revision,
            seed=body.seed,
            by=body.by,
            comment=body.comment,
        )
        response.headers["Location"] = f"/api/v1/machines/{machine_id}/model-calibrations/{row.id}"
        return _rendered(session, row)


@router.post(
    "/{calibration_id}/in-force", operation_id="put_model_calibration_in_force", dependencies=[ADMIN], responses=CHANGES
)
def put_in_force(
    request: Request, machine_id: MachineId, calibration_id: Number, body: schemas.CalibrationInForceIn
) -> schemas.ModelCalibrationOut:
    """Put an accepted calibration in force, as a revision of the document: every later fit starts from it and is held by it.

    What else the document says by now stays; one that describes another train than was calibrated answers 409.
    """
    with database(request).transaction() as session:
        calibration_jobs.put_in_force(session, machine_id, calibration_id, by=body.by, gain_drift=body.gain_drift)
        return _rendered(session, model_calibrations.get(session, machine_id, calibration_id))


def _calibration_run(body: schemas.CalibrationRunIn, scale: DiscScale, direction: int) -> CalibrationRunAsked:
    weights = tuple(one.stored(scale, direction) for one in body.weights)
    return CalibrationRunAsked(body.run, weights, body.mounting, body.steady)


def _of_a_balancing(session: Session, machine_id: str, balancing_id: int) -> list[CalibrationRunAsked]:
    """Return the initial and trial runs of a balancing, and its check run where its weights were stated."""
    steps = balancings.get(session, machine_id, balancing_id).steps
    found = [CalibrationRunAsked(run, steady=_are_dwells(session, run)) for run in steps["initial"]]
    loaded = [one for one in [*steps["trials"], steps["check"]] if one is not None and one["weights"] is not None]
    found += [
        CalibrationRunAsked(one["run"], tuple(read_weights(one["weights"])), steady=_are_dwells(session, one["run"]))
        for one in loaded
    ]
    if len(found) == len(steps["initial"]):
        raise Unsuitable(f"balancing {balancing_id} has no trial run yet, whose weights could calibrate")
    return found


def _are_dwells(session: Session, run_id: int) -> bool:
    """Return whether a run of a balancing, which says nothing of that, was taken at constant speeds."""
    row = runs.get(session, run_id)
    return row.kind == DWELLS or row.state == runs.DISCARDED


def _summary(session: Session, row: ModelCalibrationRow, in_force: Calibration | None) -> schemas.ModelCalibrationSummary:
    job = None if row.job_id is None else jobs.get(session, row.job_id)
    result = row.result or {}
    return schemas.ModelCalibrationSummary(
        id=row.id,
        machine=row.machine_id,
        revision=row.revision,
        job=row.job_id,
        state=jobs.QUEUED if job is None else job.state,
        error=None if job is None else job.error,
        by=row.by,
        comment=row.comment,
        created_at=to_datetime(row.created_at),
        computed_at=time_or_none(row.computed_at),
        accepted=row.accepted,
        verdict=row.verdict,
        remarks=result.get("remarks", []),
        starts=result.get("starts"),
        unique=result.get("unique"),
        code_version=row.code_version,
        seed=row.asked["seed"],
        runs=[
            schemas.CalibrationRunOut(run=one["run"], weights=one["weights"], mounting=one["mounting"], steady=one["steady"])
            for one in row.asked["runs"]
        ],
        revision_in_force=row.revision_in_force,
        in_force=_is_in_force(session, row, in_force),
    )


def _is_in_force(session: Session, row: ModelCalibrationRow, in_force: Calibration | None) -> bool:
    if in_force is None or row.revision_in_force is None:
        return False
    return machines.document(session, row.machine_id, row.revision_in_force).calibration == in_force


def _rendered(session: Session, row: ModelCalibrationRow) -> schemas.ModelCalibrationOut:
    in_force = machines.document(session, row.machine_id).calibration
    summary = _summary(session, row, in_force)
    document = None if row.document is None else parse_machine(row.document)
    return schemas.ModelCalibrationOut(**dict(summary), document=document)
