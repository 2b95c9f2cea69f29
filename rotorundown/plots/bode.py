"""Bode plot: measured and fitted 1× amplitude and phase over speed."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rotorundown.plots.canvas import FITTED, MEASURED, channel_numbers, figure
from rotorundown.plots.fitted_curve import fitted_curve
from rotorundown.plots.protocols import PlottedResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDE_ENOUGH = 4
"""Channels side by side up to which the figures at the axes of speed do not run into each other [-]."""


def bode(result: PlottedResult, channels: Sequence[str] | None = None) -> "Figure":
    """Draw amplitude [µm pp] above phase lag [°] for some channels, all by default, with the fit's 95 % band."""
    numbers = channel_numbers(result.machine.channels, channels)
    drawn, axes = figure(2, len(numbers), sharex=True)
    curve = fitted_curve(result)
    lag = -np.degrees(np.angle(curve.value)) % 360.0
    for column, number in enumerate(numbers):
        above, below = axes[0, column], axes[1, column]
        for run in result.runs:
            above.plot(run.speed_rpm, run.amplitude_um_pp[:, number], ".", ms=3, color=MEASURED, label=run.name)
            below.plot(run.speed_rpm, run.phase_lag_deg[:, number], ".", ms=3, color=MEASURED)
        above.plot(curve.speed_rpm, np.abs(curve.value[:, number]), color=FITTED, label="fit")
        above.fill_between(curve.speed_rpm, curve.lower[:, number], curve.upper[:, number], color=FITTED, alpha=0.25, lw=0)
        below.plot(curve.speed_rpm, _without_wraps(lag[:, number]), color=FITTED)
        above.set_title(result.machine.channels[number])
        below.set_xlabel("r/min")
        if len(numbers) > WIDE_ENOUGH:
            below.locator_params(axis="x", nbins=3)
            below.tick_params(axis="x", labelsize="x-small")
        below.set_ylim(360.0, 0.0)
        below.set_yticks(range(0, 361, 90))
    axes[0, 0].set_ylabel("1× [µm pp]")
    axes[1, 0].set_ylabel("phase lag [°]")
    handles, names = axes[0, 0].get_legend_handles_labels()
    drawn.legend(handles, names, fontsize="small", loc="outside upper right", ncols=len(names))
    return drawn


def _without_wraps(lag: np.ndarray) -> np.ndarray:
    """Return a curve with gaps where the phase passes from 360° to 0°, so that no line crosses the plot."""
    broken = lag.copy()
    broken[1:][np.abs(np.diff(lag)) > 180.0] = np.nan
    return broken
