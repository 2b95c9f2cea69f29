"""Bode plot: measured and fitted 1× amplitude and phase over speed."""

from collections.abc import Sequence
from math import ceil
from typing import TYPE_CHECKING, Any

import numpy as np

from estimator.arrays import Floats
from rotorundown.plots.canvas import FITTED, MEASURED, channel_numbers, figure
from rotorundown.plots.fitted_curve import FittedPhasors, fit_label, fitted_curve
from rotorundown.plots.protocols import PlottedResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_ACROSS = 4
"""Most channels side by side: more of them stand below, in rows of as many as fill them evenly."""


def bode(result: PlottedResult, channels: Sequence[str] | None = None) -> "Figure":
    """Draw amplitude [µm pp] above phase lag [°] for some channels, all by default, with the fit's 95 % band."""
    numbers = channel_numbers(result.machine.channels, channels)
    bands = ceil(len(numbers) / MOST_ACROSS)
    across = ceil(len(numbers) / bands)
    drawn, axes = figure(2 * bands, across, sharex=True)
    curve = fitted_curve(result)
    for place, number in enumerate(numbers):
        band, column = divmod(place, across)
        above, below = axes[2 * band, column], axes[2 * band + 1, column]
        _draw_channel(above, below, result, curve, number)
        above.tick_params(labelbottom=False)
        below.tick_params(labelbottom=True)
        if column == 0:
            above.set_ylabel("1× [µm pp]")
            below.set_ylabel("phase lag [°]")
    for unused in range(len(numbers), bands * across):
        band, column = divmod(unused, across)
        axes[2 * band, column].remove()
        axes[2 * band + 1, column].remove()
    handles, names = axes[0, 0].get_legend_handles_labels()
    drawn.legend(handles, names, fontsize="small", loc="outside upper right", ncols=len(names))
    return drawn


def _draw_channel(above: Any, below: Any, result: PlottedResult, curve: FittedPhasors, number: int) -> None:
    """Draw the amplitude of a channel into the axes above, and its phase lag into those below."""
    for run in result.runs:
        above.plot(run.speed_rpm, run.amplitude_um_pp[:, number], ".", ms=3, color=MEASURED, label=run.name)
        below.plot(run.speed_rpm, run.phase_lag_deg[:, number], ".", ms=3, color=MEASURED)
    lag = -np.degrees(np.angle(curve.value[:, number])) % 360.0
    above.plot(curve.speed_rpm, np.abs(curve.value[:, number]), color=FITTED, label=fit_label(result))
    above.fill_between(curve.speed_rpm, curve.lower[:, number], curve.upper[:, number], color=FITTED, alpha=0.25, lw=0)
    below.plot(curve.speed_rpm, _without_wraps(lag), color=FITTED)
    above.set_title(result.machine.channels[number])
    below.set_xlabel("r/min")
    below.set_ylim(360.0, 0.0)
    below.set_yticks(range(0, 361, 90))


def _without_wraps(lag: Floats) -> Floats:
    """Return a curve with gaps where the phase passes from 360° to 0°, so that no line crosses the plot."""
    broken = lag.copy()
    broken[1:][np.abs(np.diff(lag)) > 180.0] = np.nan
    return broken
