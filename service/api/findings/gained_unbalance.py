"""Unbalance that a calibrated machine has gained since its calibration, of a stored identification."""

import numpy as np
import scipy.special
from fastapi import APIRouter, Request

from estimator.balancing.balance_quality import GRAM_MILLIMETRE
from estimator.calibration.unbalance_since import UnbalanceSince, unbalance_since
from estimator.fit.estimates import CONFIDENCE_95
from estimator.phasors.slow_roll import without_run_outs
from service.api.conventions.dependencies import Number, database
from service.api.conventions.problems import RESPONSES, Unsuitable
from service.api.findings import model_schemas as schemas
from service.api.findings.model import read_identified
from service.security.requirement import VIEWER
from storage.findings import identifications

router = APIRouter(tags=["models"], responses=RESPONSES, dependencies=[VIEWER])

TWO_PARTS_95 = float(scipy.special.chdtri(2, 0.05))
"""χ² of two real parts that an unbalance of none exceeds in one of twenty cases [-]."""


@router.get("/identifications/{identification_id}/model/unbalance-gained", operation_id="read_unbalance_gained")
def read_unbalance_gained(request: Request, identification_id: Number) -> schemas.UnbalanceGained:
    """Read what each disc has gained since the calibration that the document holds, with 95 % intervals.

    Only of machines whose model was calibrated with known unbalances (`model-calibrations`).
    """
    one = read_identified(request, identification_id)
    machine = one.machine if one.slow_roll is None else without_run_outs(one.machine, one.slow_roll)
    calibration, since = machine.calibration, unbalance_since(machine, one)
    if calibration is None or since is None:
        raise Unsuitable(
            f"the document of '{one.machine.id}' that identification {identification_id} began from holds no calibration: "
            "calibrate the model with known unbalances, put that in force, and identify a later run"
        )
    with database(request).reading() as session:
        accepted = bool(identifications.get(session, identification_id).accepted)
    return schemas.UnbalanceGained(
        identification=one.id,
        machine=machine.id,
        accepted=accepted,
        calibration_runs=[run.name for run in calibration.runs],
        discs=[_disc(since, place) for place in range(len(since.discs))],
    )


def _disc(since: UnbalanceSince, place: int) -> schemas.GainedUnbalance:
    value, rows = complex(since.value[place]), slice(2 * place, 2 * place + 2)
    parts = np.array([value.real, value.imag])
    return schemas.GainedUnbalance(
        disc=since.discs[place],
        g_mm=abs(value) / GRAM_MILLIMETRE,
        half_width_g_mm=CONFIDENCE_95 * since.standard_error(place) / GRAM_MILLIMETRE,
        angle_deg=float(np.degrees(np.angle(value)) % 360.0 % 360.0),
        half_width_deg=since.angle_error_deg(place),
        clear=bool(parts @ np.linalg.solve(since.covariance[rows, rows], parts) > TWO_PARTS_95),
    )
