"""Drawing of a train to scale, from driver to driven."""

from typing import TYPE_CHECKING, Any

from estimator.machine.document import Machine
from estimator.machine.train_layout import disc_body, shaft_begins
from rotorundown.plots.canvas import figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SMALLEST_DISC_PART = 0.02
"""Least width of a disc that is drawn, as a part of the train's length [-]."""


def train(machine: Machine) -> "Figure":
    """Draw shafts, discs, bearings, couplings and probes of a machine [m]."""
    drawn, axes = figure(1, 1)
    drawn.set_size_inches(10.0, 3.5)
    plot = axes[0, 0]
    begins = shaft_begins(machine)
    length = sum(shaft.length for shaft in machine.shafts)
    _shafts(plot, machine, begins)
    for disc in machine.discs:
        body = disc_body(disc)
        radius, width = body.radius or 0.1 * length, max(body.width or 0.0, SMALLEST_DISC_PART * length)
        centre = begins[disc.shaft] + disc.station
        _block(plot, centre - width / 2, width, 2 * radius, "tab:blue")
        plot.annotate(disc.id, (centre, radius), ha="center", va="bottom", fontsize="small")
    for bearing in machine.bearings:
        at = begins[bearing.shaft] + bearing.station
        plot.plot([at], [0.0], "^", ms=10, color="0.3", zorder=4)
        plot.annotate(bearing.id, (at, 0.0), (0, -16), textcoords="offset points", ha="center", fontsize="small")
    for coupling in machine.couplings:
        plot.axvline(begins[coupling.driven], color="tab:red", ls="--", lw=1)
        plot.annotate(coupling.id, (begins[coupling.driven], 0.0), (2, 24), textcoords="offset points", color="tab:red")
    for probe in machine.probes:
        plot.plot([begins[probe.shaft] + probe.station], [0.0], "|", ms=18, color="tab:green", zorder=4)
    plot.set_xlabel("m from the driver's end")
    plot.set_yticks([])
    plot.set_title(machine.id)
    return drawn


def _shafts(plot: Any, machine: Machine, begins: dict[str, float]) -> None:
    for shaft in machine.shafts:
        at = begins[shaft.id]
        for section in shaft.sections:
            _block(plot, at, section.length, section.outer_diameter, "0.8")
            at += section.length


def _block(plot: Any, begin: float, width: float, height: float, colour: str) -> None:
    plot.bar([begin + width / 2], [height], width=width, bottom=-height / 2, color=colour, edgecolor="0.4", lw=0.5, zorder=2)
