"""Renders samples and runs as answers of the API."""

import math
from collections.abc import Collection
from typing import Any

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.phasors.channel_status import ChannelStatus
from estimator.units import METRES, RADIANS, rad_per_s_to_rpm
from service.api.conventions.units import Units
from service.api.conventions.values import MICROMETRES, direction, rpm_or_none, time_or_none
from service.api.measurements import schemas
from storage.clock import to_datetime
from storage.encoding.sample_blocks import Samples
from storage.tables.measurements import RunRow


def phasors(machine: Machine, samples: Samples, include: Collection[schemas.PhasorExtra] = ()) -> schemas.Phasors:
    """Return samples in the usual units of vibration analysis. include: values wanted beside the 1×."""
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
        gap_um=_columns(samples.gap / METRES["um"], np.isfinite(samples.gap)) if "gap" in include else None,
        overall_um_pp=(
            _columns(samples.overall / MICROMETRES, np.isfinite(samples.overall)) if "overall" in include else None
        ),
        conditions={
            name: [value if math.isfinite(value) else None for value in column]
            for name, column in zip(machine.condition_names, samples.conditions.T.tolist(), strict=False)
        },
    )


def phasors_in_units(samples: Samples, units: Units, include: Collection[schemas.PhasorExtra] = ()) -> schemas.PhasorsInUnits:
    """Return samples in other units. include: values wanted beside the 1×."""
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
        gap=[units.lengths(channel) for channel in samples.gap.T] if "gap" in include else None,
        overall=[units.amplitudes(channel) for channel in samples.overall.T] if "overall" in include else None,
    )


def _lag(phasor: Complexes) -> Floats:
    # The modulo of a tiny negative lag would be a full turn.
    return np.asarray(np.mod(-np.angle(phasor) / RADIANS["deg"], 360.0) % 360.0)


def _columns(table: Floats, good: NDArray[np.bool_]) -> list[list[float | None]]:
    columns = zip(table.T.tolist(), good.T.tolist(), strict=True)
    return [[value if good else None for value, good in zip(*column, strict=True)] for column in columns]


def run(row: RunRow) -> schemas.Run:
    """Return a run as the API shows it."""
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
        speed_minimum_rpm=rpm_or_none(row.speed_minimum),
        speed_maximum_rpm=rpm_or_none(row.speed_maximum),
        reopened_at=time_or_none(row.reopened_at),
        samples_released_at=time_or_none(row.released_at),
        coverage=None if row.coverage is None else schemas.RunCoverage.model_validate(row.coverage),
        quality=None if row.quality is None else schemas.QualitySummary.model_validate(row.quality),
    )


def channel_rows(phasors: schemas.Phasors) -> dict[str, list[Any]]:
    """Return a table with a row for each sample and channel."""
    names = ("time", "channel", "speed_rpm", "amplitude_um_pp", "phase_lag_deg")
    table: dict[str, list[Any]] = {name: [] for name in names}
    columns = list(zip(phasors.channels, phasors.amplitude_um_pp, phasors.phase_lag_deg, strict=True))
    for number, moment in enumerate(phasors.time):
        for channel, amplitude, phase in columns:
            told = (moment.isoformat(), channel, phasors.speed_rpm[number], amplitude[number], phase[number])
            for name, value in zip(names, told, strict=True):
                table[name].append(value)
    return table
