"""Figures to draw on: matplotlib is asked for only when a plot is made, and no window is opened by itself."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from estimator.close_matches import did_you_mean
from rotorundown.environment.optional_packages import optional_package

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MEASURED, FITTED = "0.45", "tab:blue"
"""Colours of measured points and of the model."""


class UnknownChannel(KeyError):
    """Raised for a channel that the machine does not have; the message suggests names like it."""

    def __str__(self) -> str:
        return str(self.args[0])


def figure(rows: int, columns: int, **layout: Any) -> "tuple[Figure, Any]":
    """Return a figure with an array (rows, columns) of axes. Raises PackageMissing without matplotlib."""
    pyplot = optional_package("matplotlib.pyplot", needed_for="plots")
    size = (min(4.0 * columns, 14.0), 3.0 * rows)
    from rotorundown.plots.notebook_figure import NotebookFigure  # needs matplotlib, which is there by now

    drawn = pyplot.figure(FigureClass=NotebookFigure, figsize=size, layout="constrained")
    return drawn, drawn.subplots(rows, columns, squeeze=False, **layout)


def channel_numbers(known: Sequence[str], wanted: Sequence[str] | None) -> list[int]:
    """Return the indices of the wanted channels, or of the one that is named, all by default. Raises UnknownChannel."""
    if wanted is None:
        return list(range(len(known)))
    if not isinstance(wanted, Iterable):
        raise UnknownChannel(f"channels are named by their ids, not by {wanted!r:.40}; there are {', '.join(known)}")
    wanted = [wanted] if isinstance(wanted, str) else list(wanted)
    if not wanted:
        raise UnknownChannel(f"no channel is named; there are {', '.join(known)}")
    unknown = next((one for one in wanted if one not in known), None)
    if unknown is not None:
        raise UnknownChannel(f"'{unknown}' is no channel; there are {', '.join(known)}{did_you_mean(str(unknown), known)}")
    return [list(known).index(one) for one in wanted]
