"""Curve that a fit predicts for each channel, with its band, in the units of plots."""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.fit.omitted_errors.open_errors import beside_its_errors
from estimator.units import METRES, PEAK, RAD_PER_S
from estimator.updated_model.fitted_response import fitted_response
from rotorundown.plots.protocols import PlottedResult

CURVE_SPEEDS = 300
MICROMETRES_PP = METRES["um"] * PEAK["peak-to-peak"]
"""Metres 0-to-peak of a micrometre peak-to-peak."""


@dataclass(frozen=True)
class FittedPhasors:
    """Fitted 1× over speed.

    Attributes:
        speed_rpm: Speeds (S,) [r/min].
        value: Phasors (S, m) [µm pp], phase lead.
        lower: Lower end of the 95 % band of the amplitude (S, m) [µm pp].
        upper: Upper end (S, m) [µm pp].
    """

    speed_rpm: Floats
    value: Complexes
    lower: Floats
    upper: Floats


def fitted_curve(result: PlottedResult, speed_rpm: Floats | None = None) -> FittedPhasors:
    """Return the fitted curve of a result. speed_rpm: speeds (S,) [r/min]; those of the fit's range by default."""
    found = result.identification
    speed = (
        np.linspace(found.speed_minimum, found.speed_maximum, CURVE_SPEEDS)
        if speed_rpm is None
        else np.asarray(speed_rpm, dtype=float) * RAD_PER_S["rpm"]
    )
    band = fitted_response(
        result.machine,
        *beside_its_errors(
            found.coordinates, found.point, found.covariance, found.channel_effects, channels=result.machine.channels
        ),
        speed=speed,
        direction=np.full(speed.size, float(result.machine.direction)),
    )
    return FittedPhasors(
        speed / RAD_PER_S["rpm"], band.value / MICROMETRES_PP, band.lower / MICROMETRES_PP, band.upper / MICROMETRES_PP
    )


def fit_label(result: PlottedResult) -> str:
    """Return what a plot calls the fit: one that is not accepted says so."""
    return "fit" if result.accepted else "fit, NOT ACCEPTED"
