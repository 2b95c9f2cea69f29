"""Polar plot: measured and fitted 1× vectors, with speeds at some points of the curve."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rotorundown.plots.canvas import FITTED, MEASURED, channel_numbers, figure
from rotorundown.plots.fitted_curve import fitted_curve
from rotorundown.plots.protocols import PlottedResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SPEED_LABELS = 5
"""Number of speeds written beside a curve."""


def polar(result: PlottedResult, channels: Sequence[str] | None = None) -> "Figure":
    """Draw the 1× vectors [µm pp at °lag] of some channels, all by default; lag grows clockwise, as instruments show it."""
    numbers = channel_numbers(result.machine.channels, channels)
    drawn, axes = figure(1, len(numbers), subplot_kw={"projection": "polar"})
    curve = fitted_curve(result)
    for column, number in enumerate(numbers):
        plot = axes[0, column]
        plot.set_theta_direction(-1)
        for run in result.runs:
            plot.plot(np.radians(run.phase_lag_deg[:, number]), run.amplitude_um_pp[:, number], ".", ms=3, color=MEASURED)
        vectors = curve.value[:, number]
        plot.plot(-np.angle(vectors), np.abs(vectors), color=FITTED)
        for at in np.linspace(0, vectors.size - 1, SPEED_LABELS).astype(int):
            plot.annotate(f"{curve.speed_rpm[at]:.0f}", (-np.angle(vectors[at]), abs(vectors[at])), fontsize="x-small")
        plot.set_title(result.machine.channels[number])
    return drawn
