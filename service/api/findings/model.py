"""Serves results of an identified model: critical speeds, Campbell diagram, modes, coupling loads, balancing proposal.

All results are computed once, from the stored values and covariance in SI, and rendered in the requested units.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Annotated, Any, TypeVar

import numpy as np
from fastapi import APIRouter, Query, Request

from estimator.arrays import Floats
from estimator.balancing.model_balancing import Correction, balance
from estimator.fit.estimates import CONFIDENCE_95
from estimator.machine.train_layout import shaft_begins
from estimator.modes.campbell import Campbell, campbell
from estimator.modes.critical_speed import CriticalSpeed, critical_speed_table
from estimator.modes.eigenmodes import log_decrement
from estimator.modes.mode_shapes import ModeShape, ShaftShape, mode_shapes
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s
from estimator.updated_model.coupling_loads import CouplingForce, coupling_forces
from estimator.updated_model.modal_uncertainty import critical_speed_errors, modes_at, natural_frequency_errors
from estimator.updated_model.uncertainty import PhasorBand
from service.api.cache.computed_cache import ComputedCache
from service.api.cache.model_process import ModelProcess, is_long
from service.api.cache.worker_computation import caller_of, has_gone
from service.api.conventions.dependencies import Number, database
from service.api.conventions.problems import RESPONSES, Unsuitable
from service.api.conventions.units import UnitChoice, Units, column
from service.api.conventions.values import direction
from service.api.findings import model_schemas as schemas
from service.identification.stored_model import Identified, identified
from service.security.requirement import VIEWER

router = APIRouter(
    prefix="/identifications/{identification_id}/model", tags=["models"], responses=RESPONSES, dependencies=[VIEWER]
)

ABOVE_TRIP = 1.25
"""Highest speed of the computations, as a multiple of the speed range's end."""
HIGHEST_FREQUENCY = 2.0
"""Highest natural frequency shown, as a multiple of the highest speed."""

T = TypeVar("T")

Rpm = Annotated[float | None, Query(ge=0.1, lt=1e6, allow_inf_nan=False)]
Points = Annotated[int, Query(ge=10, le=500, description="evenly spaced speeds")]


@router.get("/critical-speeds", operation_id="read_critical_speeds")
def read_critical_speeds(request: Request, identification_id: Number, units: UnitChoice) -> schemas.CriticalSpeeds:
    """Read the critical speeds of the updated model, with standard errors, up to 1.25 times the end of the speed range."""

    one, (table, errors) = cached_result(request, identification_id, ("critical-speeds",), _table, slow=True)
    return schemas.CriticalSpeeds(
        **head(one, units),
        highest=units.speed_of(_highest(one)),
        critical_speeds=[_critical_speed(found, float(error), units) for found, error in zip(table, errors, strict=True)],
    )


@router.get("/campbell", operation_id="read_campbell")
def read_campbell(
    request: Request,
    identification_id: Number,
    units: UnitChoice,
    points: Annotated[int, Query(ge=10, le=120, description="evenly spaced speeds")] = 40,
) -> schemas.CampbellOut:
    """Read the Campbell diagram of the updated model, from standstill to 1.25 times the end of the speed range."""

    one, found = cached_result(request, identification_id, ("campbell", points), partial(_diagram, points=points), slow=True)
    return schemas.CampbellOut(
        **head(one, units),
        speed=units.speeds(found.speed),
        synchronous_hz=column(found.speed / (2 * math.pi)),
        curves=[
            schemas.Curve(
                frequency_hz=column(found.frequency[:, number] / (2 * math.pi)),
                damping_ratio=column(found.damping_ratio[:, number]),
                whirl=column(found.whirl[:, number]),
            )
            for number in range(found.eigenvalue.shape[1])
        ],
        critical_speeds=[_critical_speed(crossing, math.nan, units) for crossing in found.critical_speeds],
    )


@router.get("/modes", operation_id="read_modes")
def read_modes(request: Request, identification_id: Number, units: UnitChoice, rpm: Rpm = None) -> schemas.ModesOut:
    """Read the modes of the updated model and their shapes at a spin speed, by default the highest one of the runs."""

    one, (shapes, errors) = cached_result(request, identification_id, ("modes", rpm), partial(_shapes, rpm=rpm))
    begins = shaft_begins(one.machine)
    return schemas.ModesOut(
        **head(one, units),
        speed=units.speed_of(_speed(one, rpm)),
        highest_hz=HIGHEST_FREQUENCY * _highest(one) / (2 * math.pi),
        modes=[_mode(shape, float(error), begins) for shape, error in zip(shapes, errors, strict=True)],
    )


@router.get("/misalignment-force", operation_id="read_misalignment_force")
def read_misalignment_force(
    request: Request,
    identification_id: Number,
    units: UnitChoice,
    from_rpm: Rpm = None,
    to_rpm: Rpm = None,
    points: Points = 100,
) -> schemas.MisalignmentForce:
    """Read 1× forces and moments in each coupling over speed, by default over the speeds of the runs."""

    work = partial(_coupling_forces, from_rpm=from_rpm, to_rpm=to_rpm, points=points)
    one, found = cached_result(request, identification_id, ("misalignment-force", from_rpm, to_rpm, points), work)
    return schemas.MisalignmentForce(
        **head(one, units),
        speed=units.speeds(_speeds(one, from_rpm, to_rpm, points)),
        couplings=[
            schemas.CouplingLoad(
                coupling=load.coupling,
                force_x=_load(load.force_x, units),
                force_y=_load(load.force_y, units),
                moment_x=_load(load.moment_x, units),
                moment_y=_load(load.moment_y, units),
            )
            for load in found
        ],
    )


@router.get("/balancing", operation_id="read_balancing")
def read_balancing(
    request: Request,
    identification_id: Number,
    units: UnitChoice,
    plane: Annotated[list[str] | None, Query(max_length=50, description="discs to correct in; by default all")] = None,
    from_rpm: Rpm = None,
    to_rpm: Rpm = None,
    points: Points = 30,
) -> schemas.Balancing:
    """Read the correction that minimises the vibration over the speeds, without trial weights, and the remaining vibration."""

    asked = ("balancing", None if plane is None else tuple(plane), from_rpm, to_rpm, points)
    work = partial(_correction, plane=plane, from_rpm=from_rpm, to_rpm=to_rpm, points=points)
    one, found = cached_result(request, identification_id, asked, work)
    return schemas.Balancing(
        **head(one, units),
        speed=units.speeds(found.speed),
        corrections=[
            schemas.PlaneCorrection(
                plane=name, unbalance_g_mm=1e6 * abs(one_of), angle_deg=float(np.degrees(np.angle(one_of)) % 360.0 % 360.0)
            )
            for name, one_of in zip(found.planes, found.unbalance.tolist(), strict=True)
        ],
        before=_vibration(found.channels, found.before, units),
        after=_vibration(found.channels, found.after, units),
        condition_number=min(found.condition_number, 1e308),
    )


def cached_result(
    request: Request,
    identification_id: int,
    asked: tuple[Any, ...],
    compute: Callable[..., T],
    *,
    slow: bool = False,
    given: Callable[[Identified], Any] | None = None,
) -> tuple[Identified, T]:
    """Return a result for an identification, cached or computed now, in its turn; for a long train in a separate process.

    compute: function of the identification and, where `given` is set, of the data that it reads; it must be picklable. Raises
    IdentificationUnknown, NoModel, ComputationsBusy, NotComputed.
    """
    one = read_identified(request, identification_id)
    cache: ComputedCache = request.app.state.computed_cache
    process: ModelProcess = request.app.state.model_process
    key, apart = (identification_id, *asked), is_long(one.machine)

    def work() -> T:
        read = () if given is None else (given(one),)
        # A copy without cached properties: they need not be sent, and some cannot be pickled.
        return process.compute(compute, replace(one), *read) if apart else compute(one, *read)

    caller = caller_of(request)
    return one, cache.compute_queued(key, work, long=slow or apart, caller=caller, wanted=lambda: not has_gone(request))


def read_identified(request: Request, identification_id: int) -> Identified:
    """Return an identification, from memory where it was read recently. Raises IdentificationUnknown, NoModel."""
    cache: ComputedCache = request.app.state.computed_cache

    def read() -> Identified:
        with database(request).reading() as session:
            return identified(session, identification_id)

    return cache.get_or_compute((identification_id,), read)


def head(one: Identified, units: Units) -> dict[str, Any]:
    """Return the fields that all answers begin with."""
    return {
        "identification": one.id,
        "machine": one.machine.id,
        "direction": direction(one.direction),
        "units": units,
    }


def _table(one: Identified) -> tuple[tuple[CriticalSpeed, ...], Floats]:
    model = one.model
    table = critical_speed_table(model.scaled_machine, highest=_highest(one), coefficients=model.coefficients)
    return table, critical_speed_errors(model, table)


def _diagram(one: Identified, points: int) -> Campbell:
    return campbell(
        one.model.scaled_machine,
        speed=np.linspace(0.0, _highest(one), points),
        highest_frequency=HIGHEST_FREQUENCY * _highest(one),
        coefficients=one.model.coefficients,
    )


def _shapes(one: Identified, rpm: float | None) -> tuple[tuple[ModeShape, ...], Floats]:
    speed, model = _speed(one, rpm), one.model
    shapes = mode_shapes(
        model.scaled_machine,
        spin=one.direction * speed,
        highest_frequency=HIGHEST_FREQUENCY * _highest(one),
        coefficients=model.coefficients(speed),
    )
    found = modes_at(model, speed=speed)
    errors = natural_frequency_errors(model, found, speed=speed)
    return shapes, np.array([errors[np.argmin(np.abs(found.eigenvalue - shape.eigenvalue))] for shape in shapes])


def _coupling_forces(one: Identified, from_rpm: float | None, to_rpm: float | None, points: int) -> tuple[CouplingForce, ...]:
    return coupling_forces(one.model, speed=_speeds(one, from_rpm, to_rpm, points))


def _correction(
    one: Identified, plane: list[str] | None, from_rpm: float | None, to_rpm: float | None, points: int
) -> Correction:
    planes = plane or [disc.id for disc in one.machine.discs]
    if not planes:
        raise Unsuitable(f"machine '{one.machine.id}' has no disc to correct in")
    speed = _balancing_speeds(one, from_rpm, to_rpm, points)
    try:
        return balance(one.model, planes=planes, speed=speed)
    except ValueError as error:
        raise Unsuitable(f"plane: {error}") from error


def _balancing_speeds(one: Identified, from_rpm: float | None, to_rpm: float | None, points: int) -> Floats:
    """Return the speeds to balance at, inside the document's range: the machine may not be asked to run elsewhere."""
    speed, limits = _speeds(one, from_rpm, to_rpm, points), one.machine.speed_range
    outside = [rpm for rpm in (from_rpm, to_rpm) if rpm is not None and not limits.minimum_rpm <= rpm <= limits.maximum_rpm]
    if outside:
        raise Unsuitable(
            f"{outside[0]:g} r/min lies outside the document's speed range, "
            f"{limits.minimum_rpm:g} to {limits.maximum_rpm:g} r/min"
        )
    lowest, highest = rpm_to_rad_per_s(limits.minimum_rpm), rpm_to_rad_per_s(limits.maximum_rpm)
    return np.linspace(max(speed[0], lowest), min(speed[-1], highest), points)


def _highest(one: Identified) -> float:
    return ABOVE_TRIP * rpm_to_rad_per_s(one.machine.speed_range.maximum_rpm)


def _speed(one: Identified, rpm: float | None) -> float:
    return one.speed_maximum if rpm is None else rpm_to_rad_per_s(rpm)


def _speeds(one: Identified, from_rpm: float | None, to_rpm: float | None, points: int) -> Floats:
    first = one.speed_minimum if from_rpm is None else rpm_to_rad_per_s(from_rpm)
    last = one.speed_maximum if to_rpm is None else rpm_to_rad_per_s(to_rpm)
    if not first < last:
        own = f"{rad_per_s_to_rpm(one.speed_minimum):.0f} and {rad_per_s_to_rpm(one.speed_maximum):.0f}"
        raise Unsuitable(
            f"from_rpm must be below to_rpm, not {rad_per_s_to_rpm(first):.0f} and {rad_per_s_to_rpm(last):.0f}: "
            f"where one is left out, that of the runs is taken, {own}"
        )
    return np.linspace(first, last, points)


def _critical_speed(found: CriticalSpeed, error: float, units: Units) -> schemas.CriticalSpeedOut:
    half = CONFIDENCE_95 * error
    shown = units.speeds(np.array([error, found.speed - half, found.speed + half]))
    return schemas.CriticalSpeedOut(
        speed=units.speed_of(found.speed),
        standard_error=shown[0],
        lower=shown[1],
        upper=shown[2],
        damping_ratio=found.damping_ratio,
        log_decrement=found.log_decrement,
        whirl=found.whirl,
    )


def _mode(shape: ModeShape, error: float, begins: dict[str, float]) -> schemas.ModeOut:
    return schemas.ModeOut(
        frequency_hz=shape.frequency / (2 * math.pi),
        standard_error_hz=error / (2 * math.pi) if math.isfinite(error) else None,
        damping_ratio=shape.damping_ratio,
        log_decrement=float(log_decrement(np.array([shape.eigenvalue]))[0]),
        whirl=shape.whirl,
        shafts=[_shaft_shape(one, begins[one.shaft]) for one in shape.shafts],
    )


def _shaft_shape(one: ShaftShape, begin: float) -> schemas.ShaftShapeOut:
    return schemas.ShaftShapeOut(
        shaft=one.shaft,
        at=(begin + one.station).tolist(),
        x=schemas.Displacement(real=one.x.real.tolist(), imaginary=one.x.imag.tolist()),
        y=schemas.Displacement(real=one.y.real.tolist(), imaginary=one.y.imag.tolist()),
        semi_major=one.orbit.semi_major.tolist(),
        semi_minor=one.orbit.semi_minor.tolist(),
        inclination_deg=np.degrees(one.orbit.inclination).tolist(),
    )


def _load(band: PhasorBand, units: Units) -> schemas.Load:
    return schemas.Load(
        amplitude=column(band.amplitude),
        lower=column(band.lower),
        upper=column(band.upper),
        phase=units.phases(band.value),
    )


def _vibration(channels: Sequence[str], band: PhasorBand, units: Units) -> list[schemas.Vibration]:
    return [
        schemas.Vibration(
            channel=channel,
            amplitude=units.amplitudes(band.amplitude[:, number]),
            lower=units.amplitudes(band.lower[:, number]),
            upper=units.amplitudes(band.upper[:, number]),
        )
        for number, channel in enumerate(channels)
    ]
