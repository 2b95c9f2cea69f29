"""Field balancings of a machine: initial run, trial runs, correction and check run, each step stored.

What a computation needs is read in one transaction, computed in a worker process in no transaction, and stored in another.
"""

import json
import math
from dataclasses import asdict
from typing import Any

import numpy as np
from fastapi import APIRouter, Request, status
from sqlalchemy.orm import Session

from estimator.balancing.balance_quality import GRAM_MILLIMETRE
from estimator.balancing.field_balancing import BalancingOptions, BalancingRun
from estimator.balancing.weight_places import WeightPlaces
from estimator.errors import Conflict
from estimator.machine.disc_scale import DiscScale
from estimator.machine.document import Machine
from estimator.units import rpm_to_rad_per_s
from service.api.cache.model_process import ModelProcess
from service.api.cache.worker_computation import compute_in_worker
from service.api.conventions.changes_in_turn import change_place, takes_turns_of_its_own
from service.api.conventions.dependencies import MachineId, Number, Reading, database
from service.api.conventions.paging import ById
from service.api.conventions.problems import CHANGES, RESPONSES, Unsuitable
from service.api.machines import balancing_schemas as schemas
from service.balancing.open_causes import require_nothing_else
from service.balancing.rendering import on_scale
from service.balancing.stored_runs import StoredWeight, balancing_run, read_weights
from service.identification import balancing_computation
from service.identification.balancing_computation import BalancingTask
from service.identification.stored_model import Identified, identified
from service.security.requirement import ANALYST, VIEWER
from storage.clock import now, to_datetime
from storage.machines import balancings, machines
from storage.tables.machines import BalancingRow

router = APIRouter(prefix="/machines/{machine_id}/balancings", tags=["balancing"], responses=RESPONSES, dependencies=[VIEWER])


MOST_TRIALS = 50
"""Largest number of trial runs of a balancing: each step reads all of them."""


class BalancingMoved(Conflict):
    """Raised when somebody else took a step of the balancing meanwhile."""


class TooManyTrials(Conflict):
    """Raised for a trial run beyond as many as a balancing may have."""


class CorrectionInUse(Conflict):
    """Raised when a trial is to be withdrawn from which a correction was computed that is not given up with it."""


class StepMissing(Conflict):
    """Raised when a step is asked for before the one that it needs."""


@router.get("", operation_id="list_balancings")
def list_balancings(session: Reading, machine_id: MachineId, paging: ById) -> list[schemas.BalancingOut]:
    """List a machine's field balancings, newest first."""
    machines.get(session, machine_id)
    rows = balancings.of_machine(session, machine_id, limit=paging.wanted, after=paging.after)
    return [_rendered(session, row) for row in paging.page(rows, lambda row: (row.id,))]


@router.get("/{balancing_id}", operation_id="read_balancing_steps")
def read_balancing(session: Reading, machine_id: MachineId, balancing_id: Number) -> schemas.BalancingOut:
    """Read a field balancing with the steps taken so far."""
    return _rendered(session, balancings.get(session, machine_id, balancing_id))


@router.post("", operation_id="begin_balancing", status_code=status.HTTP_201_CREATED, dependencies=[ANALYST])
def begin_balancing(request: Request, machine_id: MachineId, body: schemas.BalancingIn) -> schemas.BalancingOut:
    """Begin a field balancing with runs of the machine as it is, before any trial weight."""
    with database(request).reading() as session:
        revision = machines.get(session, machine_id).revision
        for run in body.runs:
            balancing_run(session, machine_id, revision, run, None)
    with database(request).transaction() as session:
        row = balancings.add(
            session,
            machine_id,
            revision=revision,
            initial=list(dict.fromkeys(body.runs)),
            by=body.by,
            comment=body.comment,
            disc_scale=body.disc_scale.model_dump(mode="json"),
        )
        return _rendered(session, row)


@router.post("/{balancing_id}/trials", operation_id="add_balancing_trial", dependencies=[ANALYST], responses=CHANGES)
def add_trial(request: Request, machine_id: MachineId, balancing_id: Number, body: schemas.TrialIn) -> schemas.BalancingOut:
    """Add a run with trial weights. A correction that was computed before is computed anew on request."""
    with database(request).reading() as session:
        row = balancings.get(session, machine_id, balancing_id)
        read, weights = row.updated_at, _weights(session, row, body.weights)
        _require_other_run(row, body.run)
        if len(row.steps["trials"]) + len(balancings.withdrawn(row)) >= MOST_TRIALS:
            raise TooManyTrials(
                f"balancing {balancing_id} has {MOST_TRIALS} trial runs, as many as may be, those withdrawn counted: begin "
                "another one"
            )
        machine = machines.document(session, machine_id, row.revision)
        tried = balancing_run(session, machine_id, row.revision, body.run, weights)
        others = [balancing_run(session, machine_id, row.revision, one, None) for one in _run_ids(row)]
    balancing_computation.require_usable_trial(machine, tried, others)
    with database(request).transaction() as session:
        row = _unmoved(session, machine_id, balancing_id, read)
        trial = {"run": body.run, "weights": [asdict(one) for one in weights], "by": body.by}
        balancings.record(row, balancings.TRIED, trials=[*row.steps["trials"], trial], correction=None, check=None)
        return _rendered(session, row)


@router.post("/{balancing_id}/withdrawals", operation_id="withdraw_balancing_trial", dependencies=[ANALYST], responses=CHANGES)
def withdraw_trial(
    request: Request, machine_id: MachineId, balancing_id: Number, body: schemas.WithdrawalIn
) -> schemas.BalancingOut:
    """Take a trial run back, such as one whose weight was entered wrongly; it may be added again.

    It stays on record with who withdrew it and why. Answers 409 while a correction stands that was computed from it, unless
    that is given up with it, and its check run too.
    """
    with database(request).transaction() as session:
        row = balancings.get(session, machine_id, balancing_id, to_change=True)
        trial = next((one for one in row.steps["trials"] if one["run"] == body.run), None)
        if trial is None:
            runs = ", ".join(str(one["run"]) for one in row.steps["trials"]) or "none"
            raise Unsuitable(f"run {body.run} is no trial run of balancing {balancing_id}; its trial runs are: {runs}")
        _require_given_up(row, body)
        balancings.withdraw(row, trial, by=body.by, comment=body.comment)
        return _rendered(session, row)


@router.post(
    "/{balancing_id}/correction", operation_id="compute_balancing_correction", dependencies=[ANALYST], responses=CHANGES
)
@takes_turns_of_its_own
def compute_correction(
    request: Request, machine_id: MachineId, balancing_id: Number, body: schemas.CorrectionIn
) -> schemas.BalancingOut:
    """Compute the correction from the trial runs so far.

    Answers 409 and proposes no masses while an open alert says that something else than unbalance is wrong.
    """
    asked = body.model_dump(mode="json", exclude={"by"})
    with database(request).reading() as session:
        require_nothing_else(session, machine_id)
        key, read = _stamp(session, machine_id, balancing_id)

    def work(process: ModelProcess) -> dict[str, Any]:
        with database(request).reading() as reading:
            task = _task(reading, balancings.get(reading, machine_id, balancing_id), asked)
        return process.compute(balancing_computation.compute_correction, task)

    result = compute_in_worker(request, ("balancing correction", *key, json.dumps(asked)), work)
    step = {"asked": asked, "by": body.by, "at": now(), "result": result}
    with change_place(request), database(request).transaction() as session:
        require_nothing_else(session, machine_id)  # an alert may have come while it was computed
        row = _unmoved(session, machine_id, balancing_id, read)
        balancings.record(row, balancings.PROPOSED, correction=step, check=None)
        return _rendered(session, row)


@router.post("/{balancing_id}/check", operation_id="check_balancing", dependencies=[ANALYST], responses=CHANGES)
@takes_turns_of_its_own
def check_correction(
    request: Request, machine_id: MachineId, balancing_id: Number, body: schemas.CheckIn
) -> schemas.BalancingOut:
    """Compare a run after the correction with what was promised, and say what to trim."""
    with database(request).reading() as session:
        row = balancings.get(session, machine_id, balancing_id)
        weights = None if body.weights is None else _weights(session, row, body.weights)
        if row.steps["correction"] is None:
            raise StepMissing(f"balancing {balancing_id} has no correction yet, which a check run could keep")
        _require_other_run(row, body.run)
        asked = row.steps["correction"]["asked"]
        key, read = _stamp(session, machine_id, balancing_id)

    def work(process: ModelProcess) -> dict[str, Any]:
        with database(request).reading() as reading:
            row = balancings.get(reading, machine_id, balancing_id)
            task = _task(reading, row, asked)
            run = balancing_run(reading, machine_id, row.revision, body.run, weights)
        return process.compute(balancing_computation.compute_check, task, run)

    whole = ("balancing check", *key, body.run, None if weights is None else tuple(weights))
    step = {
        "run": body.run,
        "weights": None if weights is None else [asdict(one) for one in weights],
        "by": body.by,
        "at": now(),
        "result": compute_in_worker(request, whole, work),
    }
    with change_place(request), database(request).transaction() as session:
        row = _unmoved(session, machine_id, balancing_id, read)
        balancings.record(row, balancings.CHECKED, check=step)
        return _rendered(session, row)


def _require_given_up(row: BalancingRow, body: schemas.WithdrawalIn) -> None:
    """Raise CorrectionInUse where a correction was computed from the trials and is not given up."""
    correction, check = row.steps["correction"], row.steps["check"]
    if correction is None or body.with_correction:
        return
    checked = "" if check is None else f", and run {check['run']} has checked it"
    raise CorrectionInUse(
        f"masses were proposed by {correction['by']} from the trials with run {body.run}{checked}: withdraw it with "
        "`with_correction: true`, which gives these up, and compute the correction anew"
    )


def _run_ids(row: BalancingRow) -> list[int]:
    """Return the initial and trial runs."""
    return [*row.steps["initial"], *(trial["run"] for trial in row.steps["trials"])]


def _require_other_run(row: BalancingRow, run: int) -> None:
    """Raise Unsuitable for an initial or a trial run."""
    if run in _run_ids(row):
        raise Unsuitable(f"run {run} is part of this balancing already: each trial and the check is a run of its own")


def _stamp(session: Session, machine_id: str, balancing_id: int) -> tuple[tuple[int, int, int | None], int]:
    """Return what a balancing's computations depend on beside what is asked, and when the balancing was changed last."""
    read = balancings.get(session, machine_id, balancing_id).updated_at
    return (balancing_id, read, machines.get(session, machine_id).slow_roll_version), read


def _unmoved(session: Session, machine_id: str, balancing_id: int, read: int) -> BalancingRow:
    """Return a balancing, locked, as it was when it was read. Raises BalancingMoved."""
    row = balancings.get(session, machine_id, balancing_id, to_change=True)
    if row.updated_at != read:
        raise BalancingMoved(f"balancing {balancing_id} was changed meanwhile: read it again")
    return row


def _task(session: Session, row: BalancingRow, asked: dict[str, Any]) -> BalancingTask:
    """Return the correction to compute from a balancing's stored runs. Raises StepMissing, Unsuitable, RunUnsuitable."""
    if not row.steps["trials"]:
        raise StepMissing(f"balancing {row.id} has no trial run yet: add one with a weight on each plane")
    machine = machines.document(session, row.machine_id, row.revision)

    def run(run_id: int, weights: list[StoredWeight]) -> BalancingRun:
        return balancing_run(session, row.machine_id, row.revision, run_id, weights)

    return BalancingTask(
        machine=machine,
        initial=tuple(run(one, []) for one in row.steps["initial"]),
        trials=tuple(run(one["run"], read_weights(one["weights"])) for one in row.steps["trials"]),
        options=_options(machine, asked, _scale(row)),
        model=_model(session, machine, asked.get("identification")),
    )


def _model(session: Session, machine: Machine, identification_id: int | None) -> Identified | None:
    """Return the identification whose model is compared. Raises IdentificationUnknown, NoModel, Unsuitable."""
    if identification_id is None:
        return None
    one = identified(session, identification_id)
    if one.machine.id != machine.id or one.machine.channels != machine.channels:
        raise Unsuitable(f"identification {identification_id} is not of this machine with its probes")
    return one


def _options(machine: Machine, asked: dict[str, Any], scale: DiscScale) -> BalancingOptions:
    body = schemas.CorrectionIn.model_validate(asked | {"by": "-"})
    discs = [disc.id for disc in machine.discs]
    for name in [*(body.discs or []), *body.limits_g_mm, *body.places]:
        if name not in discs:
            raise Unsuitable(f"there is no disc {name}; the discs are {', '.join(discs)}")
    return BalancingOptions(
        planes=None if body.discs is None else tuple(body.discs),
        criterion=body.criterion,
        limit={disc: size * GRAM_MILLIMETRE for disc, size in body.limits_g_mm.items()},
        places={disc: _places(one, scale, machine.direction) for disc, one in body.places.items()},
        grade=body.grade,
        service_speed=None if body.service_rpm is None else rpm_to_rad_per_s(body.service_rpm),
        speed=None if body.speeds_rpm is None else np.array([rpm_to_rad_per_s(one) for one in body.speeds_rpm]),
    )


def _places(body: schemas.PlacesIn, scale: DiscScale, direction: int) -> WeightPlaces:
    return WeightPlaces.evenly(
        body.count,
        radius=1e-3 * body.radius_mm,
        first_deg=math.degrees(scale.angle(body.first_deg, direction=direction)),
        largest=np.inf if body.largest_g is None else 1e-3 * body.largest_g,
        step=0.0 if body.step_g is None else 1e-3 * body.step_g,
    )


def _scale(row: BalancingRow) -> DiscScale:
    return DiscScale.model_validate(row.steps.get("disc_scale") or {})


def _weights(session: Session, row: BalancingRow, body: list[schemas.WeightIn]) -> list[StoredWeight]:
    direction = machines.document(session, row.machine_id, row.revision).direction
    return [one.stored(_scale(row), direction) for one in body]


def _rendered(session: Session, row: BalancingRow) -> schemas.BalancingOut:
    correction, check = row.steps["correction"], row.steps["check"]
    scale, direction = _scale(row), machines.document(session, row.machine_id, row.revision).direction
    return schemas.BalancingOut.model_validate(
        {
            "id": row.id,
            "machine": row.machine_id,
            "revision": row.revision,
            "state": row.state,
            "by": row.by,
            "comment": row.comment,
            "created_at": to_datetime(row.created_at),
            "updated_at": to_datetime(row.updated_at),
            "disc_scale": scale,
            "initial": row.steps["initial"],
            "trials": on_scale(row.steps["trials"], scale, direction),
            "withdrawn": [
                on_scale(one, scale, direction) | {"at": to_datetime(one["at"])} for one in balancings.withdrawn(row)
            ],
            "correction": None
            if correction is None
            else on_scale(correction["result"], scale, direction) | _author_and_time(correction),
            "check": None
            if check is None
            else on_scale(check["result"] | {key: check[key] for key in ("run", "weights")}, scale, direction)
            | _author_and_time(check),
        }
    )


def _author_and_time(step: dict[str, Any]) -> dict[str, Any]:
    return {"by": step["by"], "at": to_datetime(step["at"])}
