"""Campbell diagram."""

from typing import TYPE_CHECKING

from estimator.modes.campbell import Campbell
from estimator.units import RAD_PER_S
from rotorundown.plots.canvas import FITTED, figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def campbell_diagram(found: Campbell) -> "Figure":
    """Draw natural frequencies [cycles/min] over speed [r/min] with the 1× line and the critical speeds on it."""
    drawn, axes = figure(1, 1)
    drawn.set_size_inches(8.0, 5.0)
    plot = axes[0, 0]
    speed = found.speed / RAD_PER_S["rpm"]
    plot.plot(speed, found.frequency / RAD_PER_S["rpm"], color=FITTED, lw=1)
    plot.plot(speed, speed, color="0.6", ls="--", label="1×")
    crossings = [one.speed / RAD_PER_S["rpm"] for one in found.critical_speeds]
    plot.plot(crossings, crossings, "o", color="tab:red", label="critical speed")
    plot.set_xlim(0.0, speed[-1])
    plot.set_ylim(0.0, speed[-1])
    plot.set_xlabel("r/min")
    plot.set_ylabel("natural frequency [cycles/min]")
    plot.legend(fontsize="small")
    return drawn
