"""Serves 1× orbits of a run at stations whose probes measure both axes, and their findings about the wiring."""

from typing import Annotated

import numpy as np
from fastapi import APIRouter, Query
from pydantic import BaseModel, Field

from estimator.arrays import Complexes, Floats
from estimator.phasors.orbits import OrbitFinding, StationOrbits, orbit_findings, station_orbits
from estimator.phasors.probe_axes import axis_phasors, probe_stations
from estimator.phasors.slow_roll import corrected
from estimator.units import METRES, RADIANS, rad_per_s_to_rpm, rpm_to_rad_per_s
from service.api.conventions.dependencies import Number, Reading
from service.api.conventions.problems import RESPONSES
from service.api.conventions.units import Units, UnitsIfAsked
from service.api.measurements.corrections import SlowRollQuery, chosen, run_samples
from service.security.requirement import VIEWER

router = APIRouter(tags=["measurements"], responses=RESPONSES, dependencies=[VIEWER])

UNDETERMINED_DEG = 45.0
"""Largest standard error of an inclination that is shown [°]."""


class AxisPhasor(BaseModel):
    """A displacement along an axis, 0-to-peak [µm], x(t) = Re((real + j imaginary) e^{jωt})."""

    real_um: float
    imaginary_um: float


class OrbitInUnits(BaseModel):
    """Speed and size of an orbit in the requested units, with the phases of x and y in the requested unit of phase."""

    speed: float
    x: float | None = Field(description="amplitude")
    x_phase: float | None
    y: float | None = Field(description="amplitude")
    y_phase: float | None
    semi_major: float | None
    semi_major_error: float | None
    semi_minor: float | None = Field(description="positive with the rotation, negative against it")
    semi_minor_error: float | None


class OrbitOut(BaseModel):
    """The 1× orbit at one station in the sample nearest to the requested speed; errors are standard errors."""

    shaft: str
    station: float = Field(description="[m] from the shaft's driver-side end")
    channels: list[str]
    angles_deg: list[float] = Field(description="of the probes, from +x towards +y [°]")
    angles_condition: float = Field(description="condition number of the probes' angles, 1 at right angles")
    speed_rpm: float
    x: AxisPhasor
    y: AxisPhasor
    x_2x: AxisPhasor | None = Field(default=None, description="2× along x, x(t) = Re(X e^{2jωt}); null where not sent")
    y_2x: AxisPhasor | None = None
    semi_major_um: float
    semi_major_error_um: float
    semi_minor_um: float = Field(description="positive with the rotation, negative against it")
    semi_minor_error_um: float
    inclination_deg: float | None = Field(description="of the major axis, from +x towards +y; null for too round an orbit")
    inclination_error_deg: float | None
    sense: str = Field(description="forward, backward, or undecided where the orbit is too flat for the noise")
    in_units: OrbitInUnits | None = Field(default=None, description="where `units` are asked for")


class FindingOut(BaseModel):
    """A finding about the wiring, or the reason why the orbits cannot show one."""

    code: str
    channels: list[str]
    words: str


class Orbits(BaseModel):
    """Orbits of a run near one speed. A station without an orbit has one axis only, or no good sample."""

    run: int
    asked_rpm: float
    slow_roll_version: int | None
    slow_roll_left_out: dict[str, str] = Field(default_factory=dict, description="channels left as measured, and why")
    units: Units | None = Field(default=None, description="of `in_units` of each orbit; null where none are asked for")
    orbits: list[OrbitOut]
    without: list[list[str]] = Field(description="channels of the stations that have no orbit")
    findings: list[FindingOut]


@router.get("/runs/{run_id}/orbits", operation_id="read_orbits")
def read_orbits(
    session: Reading,
    run_id: Number,
    rpm: Annotated[float, Query(ge=0.1, lt=1e6, description="speed; the nearest sample with all it takes is used")],
    units: UnitsIfAsked,
    slow_roll: SlowRollQuery = "none",
) -> Orbits:
    """Read the orbits at the sample nearest to a speed, with their uncertainty, and swapped channels where they show."""
    machine, held = run_samples(session, run_id)
    version, vectors, left_out = chosen(session, machine, slow_roll)
    measurement = held.measurement()
    described, without = (machine, measurement) if vectors is None else corrected(machine, measurement, vectors)
    nearest = [(one, _nearest(one, without.speed, rpm_to_rad_per_s(rpm))) for one in station_orbits(described, without)]
    second = {one.place.channels: _second_order(one, held.second) for one, _ in nearest}
    seen = {one.place.channels for one, sample in nearest if sample is not None}
    return Orbits(
        run=run_id,
        asked_rpm=rpm,
        slow_roll_version=version,
        slow_roll_left_out=left_out,
        units=units,
        orbits=[
            _rendered(one, sample, without.speed).model_copy(
                update=_axes_of(second[one.place.channels], sample)
                | {"in_units": _in_units(one, sample, without.speed, units)}
            )
            for one, sample in nearest
            if sample is not None
        ],
        without=[list(place.channels) for place in probe_stations(machine) if place.channels not in seen],
        findings=[_finding(one) for one in orbit_findings(machine, measurement)],
    )


def _nearest(orbits: StationOrbits, speed: Floats, wanted: float) -> int | None:
    known = np.flatnonzero(np.isfinite(orbits.semi_major))
    return None if known.size == 0 else int(known[np.argmin(np.abs(speed[known] - wanted))])


def _rendered(one: StationOrbits, sample: int, speed: Floats) -> OrbitOut:
    def micrometres(values: Floats) -> float:
        return float(values[sample]) / METRES["um"]

    x, y = complex(one.x[sample]) / METRES["um"], complex(one.y[sample]) / METRES["um"]
    error = float(one.inclination_error[sample]) / RADIANS["deg"]
    told = error <= UNDETERMINED_DEG
    return OrbitOut(
        shaft=one.place.shaft,
        station=one.place.station,
        channels=list(one.place.channels),
        angles_deg=[float(angle) for angle in np.rad2deg(one.place.angle)],
        angles_condition=one.place.condition,
        speed_rpm=rad_per_s_to_rpm(float(speed[sample])),
        x=AxisPhasor(real_um=x.real, imaginary_um=x.imag),
        y=AxisPhasor(real_um=y.real, imaginary_um=y.imag),
        semi_major_um=micrometres(one.semi_major),
        semi_major_error_um=micrometres(one.semi_major_error),
        semi_minor_um=micrometres(one.semi_minor),
        semi_minor_error_um=micrometres(one.semi_minor_error),
        inclination_deg=float(one.inclination[sample]) / RADIANS["deg"] if told else None,
        inclination_error_deg=error if told else None,
        sense=one.sense(sample),
    )


def _second_order(one: StationOrbits, second: Complexes) -> tuple[Complexes, Complexes]:
    axes = axis_phasors(one.place, phasor=second, usable=np.isfinite(second))
    return axes.x, axes.y


def _axes_of(second: tuple[Complexes, Complexes], sample: int) -> dict[str, AxisPhasor]:
    x, y = (complex(axis[sample]) / METRES["um"] for axis in second)
    if not np.isfinite([x, y]).all():
        return {}
    return {"x_2x": AxisPhasor(real_um=x.real, imaginary_um=x.imag), "y_2x": AxisPhasor(real_um=y.real, imaginary_um=y.imag)}


def _in_units(one: StationOrbits, sample: int, speed: Floats, units: Units | None) -> OrbitInUnits | None:
    if units is None:
        return None
    axes = np.array([one.x[sample], one.y[sample]])
    lengths = np.array([one.semi_major, one.semi_major_error, one.semi_minor, one.semi_minor_error])[:, sample]
    (x, y), (x_phase, y_phase) = units.amplitudes(np.abs(axes)), units.phases(axes)
    major, major_error, minor, minor_error = units.amplitudes(lengths)
    return OrbitInUnits(
        speed=units.speed_of(float(speed[sample])),
        x=x,
        x_phase=x_phase,
        y=y,
        y_phase=y_phase,
        semi_major=major,
        semi_major_error=major_error,
        semi_minor=minor,
        semi_minor_error=minor_error,
    )


def _finding(one: OrbitFinding) -> FindingOut:
    return FindingOut(code=one.code, channels=list(one.channels), words=one.words)
