"""Trend of a parameter over several results, with 95 % intervals."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from estimator.errors import Invalid
from rotorundown.plots.canvas import FITTED, figure
from rotorundown.plots.protocols import PlottedResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class NothingToPlot(Invalid):
    """Raised where no list of results is given to be drawn."""


def plot_trend(results: Sequence[PlottedResult], name: str, *, when: Sequence[Any] | None = None) -> "Figure":
    """Plot a parameter over results. when: a time for each, such as datetimes; by default they are numbered.

    Results that are not accepted, or do not determine the parameter, leave a gap. Raises UnknownName, NothingToPlot.
    """
    results = list(results) if isinstance(results, Iterable) else []
    # A single result gives the names of its parameters, and a run was not identified.
    if not results or not all(hasattr(one, "accepted") for one in results):
        raise NothingToPlot("a trend is drawn of a list of results of identify(machine, runs), one at least")
    times = list(range(1, len(results) + 1)) if when is None else list(when)
    if len(times) != len(results):
        raise NothingToPlot(f"when has {len(times)} times for {len(results)} results")
    estimates = [one[name] for one in results]
    known = [i for i, one in enumerate(estimates) if one.estimable and results[i].accepted]
    drawn, axes = figure(1, 1)
    drawn.set_size_inches(8.0, 3.5)
    plot = axes[0, 0]
    value = np.array([_size(estimates[i]) for i in known])
    ends = np.array([[estimates[i].lower, estimates[i].upper] for i in known], dtype=float).reshape(-1, 2)
    below, above = np.maximum(value - ends[:, 0], 0.0), np.maximum(ends[:, 1] - value, 0.0)
    plot.errorbar([times[i] for i in known], value, yerr=[below, above], fmt="o", color=FITTED, capsize=3)
    plot.set_ylabel(f"{name} [{estimates[0].unit if estimates else ''}]")
    if when is None:
        plot.xaxis.get_major_locator().set_params(integer=True)
        plot.set_xlabel("result")
    return drawn


def _size(estimate: Any) -> float:
    """Return the value, or the magnitude of a complex one, which its interval bounds."""
    return abs(complex(estimate.value, estimate.imaginary or 0.0)) if estimate.imaginary is not None else estimate.value
