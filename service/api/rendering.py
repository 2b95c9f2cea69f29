"""From rows of the store to answers of the API."""

import math
from collections.abc import Collection
from datetime import datetime
from typing import Any

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.channel_status import ChannelStatus
from estimator.machine import Machine
from estimator.units import METRES, PEAK, RADIANS, rad_per_s_to_rpm
from estimator.vector_angle import angle_deg, angle_half_width_deg
from service.api import schemas
from service.api.trend_units import TrendUnits, shown_in
from service.api.units import Units
from storage.blocks import Samples
from storage.clock import to_datetime
from storage.fleet import ListedMachine
from storage.tables import (
    DerivedRow,
    EstimateRow,
    IdentificationRow,
    JobRow,
    QuarantineRow,
    RevisionRow,
    RunRow,
    SourceRow,
)

MICROMETRES = METRES["um"] * PEAK["peak-to-peak"]


def direction(sign: int) -> str:
    """`positive` turns +x towards +y."""
    return "positive" if sign > 0 else "negative"


def time_or_none(nanoseconds: int | None) -> datetime | None:
    """A stored time, where there is one."""
    return None if nanoseconds is None else to_datetime(nanoseconds)


def _rpm(speed: float | None) -> float | None:
    return None if speed is None else rad_per_s_to_rpm(speed)


def listed_machine(one: ListedMachine) -> dict[str, Any]:
    """Of `MachineSummary`, for lists that are encoded without a model."""
    return {
        "id": one.id,
        "plant": one.plant,
        "name": one.name,
        "revision": one.revision,
        "created_at": to_datetime(one.created_at),
    }


def revision(row: RevisionRow) -> schemas.MachineRevision:
    return schemas.MachineRevision(
        id=row.machine_id,
        revision=row.revision,
        created_at=to_datetime(row.created_at),
        document=Machine.model_validate(row.document),
    )


def phasors(machine: Machine, samples: Samples, include: Collection[schemas.Beside] = ()) -> schemas.Phasors:
    """Samples in the units that vibration analysts expect. include: what beside the 1× is wanted."""
    second = samples.second if "2x" in include else None
    return schemas.Phasors(
        machine=machine.id,
        channels=list(machine.channels),
        time=[to_datetime(moment) for moment in samples.time.tolist()],
        speed_rpm=[rad_per_s_to_rpm(speed) for speed in samples.speed.tolist()],
        direction=[direction(sign) for sign in samples.direction.tolist()],
        amplitude_um_pp=_columns(np.abs(samples.phasor) / MICROMETRES, samples.usable),
        phase_lag_deg=_columns(_lag(samples.phasor), samples.usable),
        amplitude_2x_um_pp=None if second is None else _columns(np.abs(second) / MICROMETRES, np.isfinite(second)),
        phase_2x_lag_deg=None if second is None else _columns(_lag(second), np.isfinite(second)),
        scatter_um_pp=(
            _columns(samples.scatter / MICROMETRES, np.isfinite(samples.scatter)) if "scatter" in include else None
        ),
        status=(
            [[ChannelStatus(one).label for one in channel] for channel in samples.status.T.tolist()]
            if "status" in include
            else None
        ),
        conditions={
            name: [value if math.isfinite(value) else None for value in column]
            for name, column in zip(machine.condition_names, samples.conditions.T.tolist(), strict=False)
        },
    )


def phasors_in_units(samples: Samples, units: Units, include: Collection[schemas.Beside] = ()) -> schemas.PhasorsInUnits:
    """Samples in other units. include: what beside the 1× is wanted."""
    good = np.where(samples.usable, samples.phasor, complex(np.nan, np.nan))
    second = samples.second.T if "2x" in include else None
    return schemas.PhasorsInUnits(
        units=units,
        speed=units.speeds(samples.speed),
        amplitude=[units.amplitudes(np.abs(channel)) for channel in good.T],
        phase=[units.phases(channel) for channel in good.T],
        amplitude_2x=None if second is None else [units.amplitudes(np.abs(channel)) for channel in second],
        phase_2x=None if second is None else [units.phases(channel) for channel in second],
        scatter=[units.amplitudes(channel) for channel in samples.scatter.T] if "scatter" in include else None,
    )


def _lag(phasor: Complexes) -> Floats:
    # The modulo of a tiny negative lag would be a full turn.
    return np.asarray(np.mod(-np.angle(phasor) / RADIANS["deg"], 360.0) % 360.0)


def _columns(table: Floats, good: NDArray[np.bool_]) -> list[list[float | None]]:
    columns = zip(table.T.tolist(), good.T.tolist(), strict=True)
    return [[value if good else None for value, good in zip(*column, strict=True)] for column in columns]


def run(row: RunRow) -> schemas.Run:
    return schemas.Run(
        id=row.id,
        machine=row.machine_id,
        revision=row.revision,
        kind=row.kind,
        direction=direction(row.direction),
        state=row.state,
        reason=row.reason,
        started_at=to_datetime(row.time_first),
        ended_at=time_or_none(row.time_last),
        samples=row.count,
        speed_minimum_rpm=_rpm(row.speed_minimum),
        speed_maximum_rpm=_rpm(row.speed_maximum),
        reopened_at=time_or_none(row.reopened_at),
        samples_released_at=time_or_none(row.released_at),
        coverage=None if row.coverage is None else schemas.RunCoverage.model_validate(row.coverage),
        quality=None if row.quality is None else schemas.QualitySummary.model_validate(row.quality),
    )


def identification(row: IdentificationRow) -> schemas.IdentificationSummary:
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
        conditions=row.conditions,
    )


def estimate(row: EstimateRow, units: TrendUnits) -> schemas.EstimateOut:
    """In the units chosen in the place of SI."""
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
    return schemas.JobOut(
        id=row.id,
        machine=row.machine_id,
        scope=row.scope,
        runs=row.run_ids,
        state=row.state,
        attempts=row.attempts,
        error=row.error,
        created_at=to_datetime(row.created_at),
        finished_at=time_or_none(row.finished_at),
        options=row.options,
    )


def derived(row: DerivedRow, units: TrendUnits) -> schemas.DerivedOut:
    """In the units chosen in the place of SI."""
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


def source(row: SourceRow) -> schemas.SourceOut:
    return schemas.SourceOut(
        machine=row.machine_id,
        source=row.source,
        epoch=row.epoch,
        next_sequence=row.next_sequence,
        received=row.received,
        duplicates=row.duplicates,
        lost=row.lost,
        late=row.late,
        newest_sample_at=time_or_none(row.last_time or None),
        newest_received_at=time_or_none(row.last_received_at),
    )


def quarantine_entry(row: QuarantineRow) -> schemas.QuarantineEntry:
    return schemas.QuarantineEntry(
        id=row.id,
        received_at=to_datetime(row.received_at),
        key=row.key,
        machine=row.machine_id,
        reason=row.reason,
        detail=row.detail,
        size=row.size,
        payload=row.payload.decode("utf-8", "backslashreplace"),
    )
