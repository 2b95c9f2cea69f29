"""Renders identifications, estimates and jobs as answers of the API."""

import math

import numpy as np

from estimator.units import rad_per_s_to_rpm
from estimator.updated_model.vector_angle import angle_deg, angle_half_width_deg
from service.api.conventions.parameter_units import ParameterUnits, shown_in
from service.api.conventions.values import time_or_none
from service.api.findings import schemas
from service.api.findings.job_remedies import remedy
from storage.clock import to_datetime
from storage.tables.findings import DerivedRow, EstimateRow, IdentificationRow, JobRow


def identification(row: IdentificationRow) -> schemas.IdentificationSummary:
    """Return an identification as the API shows it, without its estimates."""
    return schemas.IdentificationSummary(
        id=row.id,
        machine=row.machine_id,
        revision=row.revision,
        scope=row.scope,
        run_kind=row.run_kind,
        runs=row.run_ids,
        measured_at=to_datetime(row.measured_at),
        computed_at=to_datetime(row.computed_at),
        accepted=row.accepted,
        verdict=row.verdict,
        chi_square=row.chi_square,
        degrees_of_freedom=row.degrees_of_freedom,
        condition_number=row.condition_number if math.isfinite(row.condition_number) else 1e308,
        samples=row.samples,
        speed_minimum_rpm=rad_per_s_to_rpm(row.speed_minimum),
        speed_maximum_rpm=rad_per_s_to_rpm(row.speed_maximum),
        starts=row.starts,
        iterations=row.iterations,
        options=row.options,
        code_version=row.code_version,
        noise_relative=row.noise_relative,
        noise_floor=row.noise_floor,
        outliers=row.outliers,
        slow_roll_version=row.slow_roll_version,
        load_balance=row.load_balance,
        conditions=row.conditions,
    )


def estimate(row: EstimateRow, units: ParameterUnits) -> schemas.EstimateOut:
    """Return an estimate in the chosen units."""
    unit, size = shown_in(row.unit, units)
    magnitude, angle, half_width = _polar(row)
    return schemas.EstimateOut(
        parameter=row.parameter,
        element=row.element,
        quantity=row.quantity,
        unit=unit,
        value=_scaled(row.value, size),
        standard_error=_scaled(row.standard_error, size),
        lower=_scaled(row.lower, size),
        upper=_scaled(row.upper, size),
        imaginary=_scaled(row.imaginary, size),
        imaginary_standard_error=_scaled(row.imaginary_standard_error, size),
        magnitude=_scaled(magnitude, size),
        angle_deg=angle,
        angle_half_width_deg=half_width,
        reason=row.reason,
    )


def _polar(row: EstimateRow) -> tuple[float | None, float | None, float | None]:
    if row.value is None or row.imaginary is None or row.upper is None:
        return None, None, None
    value = np.array([complex(row.value, row.imaginary)])
    return abs(complex(value[0])), float(angle_deg(value)[0]), float(angle_half_width_deg(value, np.array([row.upper]))[0])


def job(row: JobRow) -> schemas.JobOut:
    """Return an identification job as the API shows it."""
    return schemas.JobOut(
        id=row.id,
        machine=row.machine_id,
        scope=row.scope,
        runs=row.run_ids,
        state=row.state,
        attempts=row.attempts,
        error=row.error,
        remedy=remedy(row.error),
        created_at=to_datetime(row.created_at),
        finished_at=time_or_none(row.finished_at),
        options=row.options,
    )


def derived(row: DerivedRow, units: ParameterUnits) -> schemas.DerivedOut:
    """Return a derived quantity in the chosen units."""
    unit, size = shown_in(row.unit, units)
    return schemas.DerivedOut(
        name=row.name,
        unit=unit,
        value=_scaled(row.value, size),
        lower=_scaled(row.lower, size),
        upper=_scaled(row.upper, size),
        reason=row.reason,
    )


def _scaled(value: float | None, size: float) -> float | None:
    return None if value is None else value / size
