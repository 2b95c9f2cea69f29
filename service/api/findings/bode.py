"""Bode plot of an identification: the fitted curve with its band, the measured points, and the residuals."""

from functools import partial
from typing import Annotated, Any

import numpy as np
from fastapi import APIRouter, Query, Request

from estimator.phasors.noise import error_size
from estimator.updated_model.fitted_response import fitted_response
from estimator.updated_model.uncertainty import PhasorBand
from service.api.conventions.dependencies import Number, database
from service.api.conventions.problems import RESPONSES, Unsuitable
from service.api.conventions.units import UnitChoice, Units, column
from service.api.conventions.values import rfc3339_texts
from service.api.findings import model_schemas as schemas
from service.api.findings.model import cached_result, head
from service.identification.stored_model import Identified, UsedRun, used_runs
from service.security.requirement import VIEWER

router = APIRouter(tags=["models"], responses=RESPONSES, dependencies=[VIEWER])


@router.get("/identifications/{identification_id}/bode", operation_id="read_bode")
def read_bode(
    request: Request,
    identification_id: Number,
    units: UnitChoice,
    run: Annotated[int | None, Query(ge=0, le=2**62, description="only this run of the identification")] = None,
    points: Annotated[int, Query(ge=10, le=2000, description="speeds of the fitted curve")] = 200,
) -> schemas.Bode:
    """Read the fitted curve, measured points and residuals of every channel over speed."""

    def runs(one: Identified) -> list[UsedRun]:
        if run is not None and run not in one.run_ids:
            raise Unsuitable(f"run {run} is not one of identification {one.id}: it has {', '.join(map(str, one.run_ids))}")
        with database(request).reading() as session:
            return used_runs(session, one, one.run_ids if run is None else [run])

    asked = ("bode", run, points)
    one, (speed, curve, measured) = cached_result(
        request, identification_id, asked, partial(_curves, points=points), given=runs
    )
    return schemas.Bode(
        **head(one, units),
        slow_roll_subtracted=one.slow_roll is not None,
        fitted=schemas.FittedCurve(
            speed=units.speeds(speed),
            channels=[_fitted(channel, curve, number, units) for number, channel in enumerate(one.machine.channels)],
        ),
        measured=[_measured(one, each, fit, units) for each, fit in measured],
    )


def _curves(one: Identified, held: list[UsedRun], points: int) -> tuple[Any, ...]:
    """Return speeds, the fitted curve at them, and each run with the fit at its samples."""
    speed = np.linspace(one.speed_minimum, one.speed_maximum, points)
    machine = held[0].machine if held else one.machine
    curve = _fit(one, machine, speed, np.full(points, float(one.direction)))
    return speed, curve, [(each, _fit(one, each.machine, *_speeds(each))) for each in held]


def _fit(one: Identified, machine: Any, speed: Any, direction: Any) -> PhasorBand:
    return fitted_response(machine, *one.with_errors, speed=speed, direction=direction)


def _speeds(run: UsedRun) -> tuple[Any, Any]:
    return run.measurement.speed, run.measurement.direction


def _fitted(channel: str, band: PhasorBand, number: int, units: Units) -> schemas.FittedChannel:
    return schemas.FittedChannel(
        channel=channel,
        amplitude=units.amplitudes(band.amplitude[:, number]),
        phase=units.phases(band.value[:, number]),
        lower=units.amplitudes(band.lower[:, number]),
        upper=units.amplitudes(band.upper[:, number]),
    )


def _measured(one: Identified, run: UsedRun, fit: PhasorBand, units: Units) -> schemas.MeasuredRun:
    measurement = run.measurement
    residual = np.abs(measurement.phasor - fit.value)
    expected = np.full(residual.shape, np.nan)
    if one.noise is not None:
        expected = error_size(one.noise, fit.amplitude, measurement.scatter)
    channels = [
        schemas.MeasuredChannel(
            channel=channel,
            amplitude=units.amplitudes(np.abs(measurement.phasor[:, number])),
            phase=units.phases(measurement.phasor[:, number]),
            used=(~run.left_out[:, number]).tolist(),
            residual=units.amplitudes(residual[:, number]),
            residual_sigma=column(residual[:, number] / expected[:, number]),
        )
        for number, channel in enumerate(one.machine.channels)
    ]
    return schemas.MeasuredRun(
        run=run.id, time=rfc3339_texts(run.time).tolist(), speed=units.speeds(measurement.speed), channels=channels
    )
