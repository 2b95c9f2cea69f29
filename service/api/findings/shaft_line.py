"""Shaft centreline of an identification: journals in their clearance circles over speed, modelled and as gaps have them."""

from functools import partial
from typing import Any

import numpy as np
from fastapi import APIRouter, Request

from estimator.arrays import Floats
from estimator.units import METRES
from estimator.updated_model.shaft_line import JournalLines, measured_lines, modelled_lines
from service.api.conventions.dependencies import Number, database
from service.api.conventions.problems import RESPONSES, Unsuitable
from service.api.conventions.units import OptionalValues, UnitChoice, column
from service.api.findings import model_schemas as schemas
from service.api.findings.model import Points, cached_result, head
from service.identification.stored_model import Identified, UsedRun, used_runs
from service.security.requirement import VIEWER

router = APIRouter(tags=["models"], responses=RESPONSES, dependencies=[VIEWER])


@router.get("/identifications/{identification_id}/model/centreline", operation_id="read_centreline")
def read_centreline(
    request: Request, identification_id: Number, units: UnitChoice, points: Points = 60
) -> schemas.CentrelineOut:
    """Read where the journals stand in their clearance circles over the speeds of the runs, and where gaps have them.

    Only of trains on oil films. A gap's zero is set by the model, so that measured lines tell how journals have moved.
    """

    def runs(one: Identified) -> list[UsedRun]:
        with database(request).reading() as session:
            return used_runs(session, one, one.run_ids)

    asked = ("centreline", points)
    one, (speed, modelled, measured) = cached_result(
        request, identification_id, asked, partial(_lines, points=points), given=runs
    )
    if modelled is None:
        raise Unsuitable(f"the bearings of '{one.machine.id}' do not follow their oil films: no journal's place is known")
    return schemas.CentrelineOut(
        **head(one, units),
        speed=units.speeds(speed),
        bearings=[
            schemas.JournalLine(bearing=bearing, clearance_um=float(clearance / METRES["um"]), **_axes(place))
            for bearing, clearance, place in zip(
                modelled.bearings, modelled.clearance, modelled.position.swapaxes(0, 1), strict=True
            )
        ],
        measured=[
            schemas.MeasuredLines(
                run=run,
                speed=units.speeds(at),
                bearings=[
                    schemas.MeasuredLine(bearing=bearing, **_axes(place))
                    for bearing, place in zip(modelled.bearings, lines.swapaxes(0, 1), strict=True)
                    if np.isfinite(place).any()
                ],
            )
            for run, at, lines in measured
        ],
    )


def _lines(one: Identified, held: list[UsedRun], points: int) -> tuple[Floats, JournalLines | None, list[Any]]:
    """Return speeds, the modelled lines at them, and number, speeds and lines of each run with gaps."""
    speed = np.linspace(one.speed_minimum, one.speed_maximum, points)
    each = [(run.id, run.measurement.speed, measured_lines(one.model, run.measurement)) for run in held]
    return speed, modelled_lines(one.model, speed=speed), [found for found in each if found[2] is not None]


def _axes(place: Floats) -> dict[str, OptionalValues]:
    """Return places (S, 2) [m] along both axes [µm]."""
    return {name: column(place[:, axis] / METRES["um"]) for axis, name in enumerate(("x_um", "y_um"))}
