"""Polar plot: measured and fitted 1× vectors, with speeds at some points of the curve."""

from collections.abc import Iterator, Sequence
from math import ceil
from typing import TYPE_CHECKING, Any

import numpy as np

from estimator.arrays import Complexes
from rotorundown.plots.canvas import FITTED, MEASURED, channel_numbers, figure
from rotorundown.plots.fitted_curve import fit_label, fitted_curve
from rotorundown.plots.protocols import PlottedResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SPEED_LABELS = 7
"""Largest number of speeds written beside a curve."""
LABELS_APART = 0.2
"""Least distance of two of them, as a part of the largest amplitude [-]: where little moves they would lie on each other."""
MOST_ACROSS = 4
"""Most circles side by side."""
RINGS = 4
"""Largest number of circles of amplitude: more of their numbers would lie on each other."""


def polar(result: PlottedResult, channels: Sequence[str] | None = None) -> "Figure":
    """Draw the 1× vectors [µm pp at °lag] of some channels, all by default; lag grows clockwise, as instruments show it."""
    numbers = channel_numbers(result.machine.channels, channels)
    across = min(len(numbers), MOST_ACROSS)
    drawn, axes = figure(ceil(len(numbers) / MOST_ACROSS), across, subplot_kw={"projection": "polar"})
    from matplotlib.ticker import MaxNLocator

    curve = fitted_curve(result)
    for plot, number in zip(axes.flat, numbers, strict=False):
        plot.set_theta_direction(-1)
        for run in result.runs:
            plot.plot(np.radians(run.phase_lag_deg[:, number]), run.amplitude_um_pp[:, number], ".", ms=3, color=MEASURED)
        vectors = curve.value[:, number]
        plot.plot(-np.angle(vectors), np.abs(vectors), color=FITTED)
        for at in _labelled(vectors):
            plot.annotate(f"{curve.speed_rpm[at]:.0f}", (-np.angle(vectors[at]), abs(vectors[at])), fontsize="x-small")
        plot.yaxis.set_major_locator(MaxNLocator(RINGS, prune="lower"))
        plot.tick_params(axis="y", labelsize="x-small")
        plot.set_title(result.machine.channels[number])
    for unused in axes.flat[len(numbers) :]:
        unused.remove()
    if not result.accepted:
        drawn.suptitle(fit_label(result))
    return drawn


def _labelled(vectors: Complexes) -> Iterator[int]:
    """Yield the places (of S) at which a speed is written, from the highest amplitude on, apart from each other."""
    apart = LABELS_APART * np.max(np.abs(vectors), initial=0.0)
    evenly = np.linspace(0, vectors.size - 1, SPEED_LABELS).astype(int)
    taken: list[Any] = []
    for at in sorted({*evenly.tolist(), int(np.argmax(np.abs(vectors)))}, key=lambda place: -abs(vectors[place])):
        if all(abs(vectors[at] - one) >= apart for one in taken):
            taken.append(vectors[at])
            yield at
