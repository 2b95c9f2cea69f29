"""Orbits (1×) at stations with two probes, as the fit has them at one speed."""

from typing import TYPE_CHECKING, SupportsFloat

import numpy as np

from estimator.errors import Invalid
from estimator.phasors.probe_axes import probe_stations
from rotorundown.plots.canvas import FITTED, figure
from rotorundown.plots.fitted_curve import fit_label, fitted_curve
from rotorundown.plots.protocols import PlottedResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

POINTS = 200


class NoOrbit(Invalid):
    """Raised for a machine without two probes at different angles at any station, and for what is no speed."""


def orbits(result: PlottedResult, speed_rpm: float) -> "Figure":
    """Draw the fitted orbits [µm pp] at one speed [r/min], with the keyphasor's dot. Raises NoOrbit."""
    if (
        isinstance(speed_rpm, bool)
        or np.ndim(speed_rpm) != 0
        or not isinstance(speed_rpm, SupportsFloat)
        or not 0.0 < float(speed_rpm) < np.inf
    ):
        raise NoOrbit(f"an orbit is drawn at one speed [r/min], such as 2980.0, not {speed_rpm!r}")
    limits = result.machine.speed_range
    if not limits.minimum_rpm <= float(speed_rpm) <= limits.maximum_rpm:
        raise NoOrbit(
            f"{float(speed_rpm):g} r/min lies outside the range of '{result.machine.id}', "
            f"{limits.minimum_rpm:g} to {limits.maximum_rpm:g} r/min"
        )
    stations = [one for one in probe_stations(result.machine) if one.sees_both_axes]
    if not stations:
        raise NoOrbit(f"'{result.machine.id}' has no station with two probes at different angles, which an orbit needs")
    value = fitted_curve(result, np.array([speed_rpm])).value[0]
    drawn, axes = figure(1, len(stations))
    turn = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, POINTS))
    for column, station in enumerate(stations):
        x, y = np.linalg.lstsq(station.directions, value[list(station.columns)], rcond=None)[0]
        plot = axes[0, column]
        # A peak-to-peak of 1 µm is a circle of that diameter.
        plot.plot(np.real(x * turn) / 2, np.real(y * turn) / 2, color=FITTED)
        plot.plot([x.real / 2], [y.real / 2], "o", color=FITTED)
        plot.set_aspect("equal")
        plot.set_title(", ".join(station.channels))
        plot.set_xlabel("x [µm]")
    axes[0, 0].set_ylabel("y [µm]")
    drawn.suptitle(f"1× at {speed_rpm:.0f} r/min, {fit_label(result)}; dot: keyphasor")
    return drawn
