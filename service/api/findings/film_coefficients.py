"""Coefficients of the oil films of an identification over speed, with their 95 % bands."""

from functools import partial
from itertools import groupby

import numpy as np
from fastapi import APIRouter, Request

from estimator.arrays import Floats
from estimator.machine.film_speeds import reported_rpm
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.film_coefficients import FilmCoefficient, film_coefficients
from service.api.conventions.dependencies import Number
from service.api.conventions.problems import RESPONSES, Unsuitable
from service.api.conventions.units import UnitChoice, column
from service.api.findings import model_schemas as schemas
from service.api.findings.model import Points, cached_result, head
from service.identification.stored_model import Identified
from service.security.requirement import VIEWER

router = APIRouter(tags=["models"], responses=RESPONSES, dependencies=[VIEWER])


@router.get("/identifications/{identification_id}/model/film-coefficients", operation_id="read_film_coefficients")
def read_film_coefficients(
    request: Request, identification_id: Number, units: UnitChoice, points: Points = 40
) -> schemas.FilmCoefficientsOut:
    """Read stiffness and damping of each oil film, from the lowest speed at which it carries to running speed.

    Only of trains on oil films. A coefficient is null at speeds at which the data leave it too uncertain.
    """
    asked = ("film-coefficients", points)
    one, (speed, found) = cached_result(request, identification_id, asked, partial(_coefficients, points=points))
    if not found:
        raise Unsuitable(f"the bearings of '{one.machine.id}' do not follow their oil films: no coefficients follow from them")
    return schemas.FilmCoefficientsOut(
        **head(one, units),
        speed=units.speeds(speed),
        bearings=[
            schemas.FilmOverSpeed(bearing=bearing, coefficients=list(map(_curve, own)))
            for bearing, own in groupby(found, key=lambda one: one.bearing)
        ],
    )


def _coefficients(one: Identified, points: int) -> tuple[Floats, tuple[FilmCoefficient, ...]]:
    """Return speeds, and the coefficients at them."""
    reported = reported_rpm(one.machine)
    speed = np.linspace(rpm_to_rad_per_s(reported[0]), rpm_to_rad_per_s(reported[-1]), points)
    return speed, film_coefficients(one.model, speed=speed)


def _curve(one: FilmCoefficient) -> schemas.CoefficientCurve:
    return schemas.CoefficientCurve(
        term=one.term, unit=one.unit, value=column(one.value), lower=column(one.lower), upper=column(one.upper)
    )
