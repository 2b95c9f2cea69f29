"""Curves that an identification's fit predicts for all channels over speed, with bands, and its runs, in µm pp and r/min."""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.units import METRES, PEAK, RAD_PER_S
from estimator.updated_model.fitted_response import fitted_response
from service.identification.stored_model import Identified, UsedRun
from service.wording.shown_units import ShownUnits

MICROMETRES_PP = METRES["um"] * PEAK["peak-to-peak"]
"""Metres 0-to-peak of a micrometre peak-to-peak."""
SPEEDS = 200
FAR, MOST_PARTS = 0.05, 16
"""Step of a vector, as a part of its channel's largest, that is divided, into at most so many parts."""


@dataclass(frozen=True)
class ResponseCurves:
    """Fitted 1× over speed (S,) [r/min]: phasors (S, m) [µm pp], phase lead, with the amplitudes' 95 % band."""

    speed: Floats
    value: Complexes
    lower: Floats
    upper: Floats

    @property
    def lag(self) -> Floats:
        """Return the phase lag (S, m), 0 to 360 [°], with gaps where it passes from one end to the other."""
        found = lag_deg(self.value)
        found[1:][np.abs(np.diff(found, axis=0)) > 180.0] = np.nan
        return found

    def shown_in(self, units: ShownUnits) -> "ResponseCurves":
        """Return the same with speeds and amplitudes in other units."""
        size = units.amplitude_factor()
        return ResponseCurves(self.speed * units.speed_factor(), self.value * size, self.lower * size, self.upper * size)


@dataclass(frozen=True)
class MeasuredPoints:
    """Measured 1× of a run that the fit used, over speed (S,) [r/min]: phasors (S, m) [µm pp], NaN where left out."""

    speed: Floats
    value: Complexes

    def shown_in(self, units: ShownUnits) -> "MeasuredPoints":
        """Return the same with speeds and amplitudes in other units."""
        return MeasuredPoints(self.speed * units.speed_factor(), self.value * units.amplitude_factor())


def response_curves(one: Identified, speed_rpm: Floats | None = None) -> ResponseCurves:
    """Return the fitted curves, over the speeds of the fit by default."""
    ends = np.array([one.speed_minimum, one.speed_maximum]) / RAD_PER_S["rpm"]
    if speed_rpm is not None:
        return _curves(one, speed_rpm)
    coarse = _curves(one, np.linspace(ends[0], ends[1], SPEEDS))
    between = _between_distant(coarse)
    return _joined(coarse, _curves(one, between)) if between.size else coarse


def _curves(one: Identified, speed: Floats) -> ResponseCurves:
    band = fitted_response(
        one.machine,
        *one.with_errors,
        speed=speed * RAD_PER_S["rpm"],
        direction=np.full(speed.size, float(one.direction)),
    )
    size = MICROMETRES_PP
    return ResponseCurves(speed, value=band.value / size, lower=band.lower / size, upper=band.upper / size)


def _between_distant(found: ResponseCurves) -> Floats:
    """Return speeds [r/min] between neighbours whose vectors lie far apart: a line would cut resonances off."""
    largest = np.maximum(abs(found.value).max(axis=0), 1e-12)
    steps = (abs(np.diff(found.value, axis=0)) / largest).max(axis=1)
    parts = np.clip(np.ceil(steps / FAR), 1, MOST_PARTS).astype(int)
    added = [
        np.linspace(first, last, count + 1)[1:-1]
        for first, last, count in zip(found.speed, found.speed[1:], parts, strict=False)
    ]
    return np.concatenate([*added, np.empty(0)])


def _joined(one: ResponseCurves, other: ResponseCurves) -> ResponseCurves:
    speed = np.concatenate([one.speed, other.speed])
    order = np.argsort(speed)
    value, lower, upper = (
        np.concatenate([getattr(one, name), getattr(other, name)])[order] for name in ("value", "lower", "upper")
    )
    return ResponseCurves(speed[order], value=value, lower=lower, upper=upper)


def measured_points(run: UsedRun) -> MeasuredPoints:
    """Return a run's points."""
    phasor = run.measurement.phasor / MICROMETRES_PP
    phasor[run.left_out] = np.nan
    return MeasuredPoints(run.measurement.speed / RAD_PER_S["rpm"], phasor)


def lag_deg(value: Complexes) -> Floats:
    """Return phase lags, 0 to 360 [°]."""
    return np.asarray(-np.degrees(np.angle(value)) % 360.0)
