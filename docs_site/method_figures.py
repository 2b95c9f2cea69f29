"""Figures of the method's pages: each is computed and drawn when the site is built, from simulated runs of the examples.

A page names one in a comment of its own line, `figure: bode: what it shows`, between the marks of a comment in HTML.
"""

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import rotorundown as rd
from rotorundown.plots.campbell import campbell_diagram
from rotorundown.plots.canvas import FITTED, MEASURED, figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

EXAMPLES = Path(__file__).parents[1] / "examples"
MARK = re.compile(r"(?m)^<!-- figure: ([\w-]+): (.+) -->$")
"""Place of a figure: its name, and what it shows."""


def campbell(*, short: bool) -> "Figure":
    """Draw natural frequencies of the motor and pump over speed. short: has no effect."""
    del short
    return campbell_diagram(rd.model(_pump()).campbell().si)


def polar(*, short: bool) -> "Figure":
    """Draw the measured and fitted vectors of a run-down at two probes. short: fewer samples."""
    result = rd.identify(_pump(), rd.simulate(_pump(), samples=120 if short else 240))
    return result.plot_polar(["B1L", "B2L"])


def bode(*, short: bool) -> "Figure":
    """Draw a run-down with its fit and the fit's band at two probes. short: fewer samples."""
    result = rd.identify(_pump(), rd.simulate(_pump(), samples=120 if short else 240))
    return result.plot_bode(["B1L", "B4L"])


def coverage(*, short: bool) -> "Figure":
    """Draw errors of estimates in their own standard errors over many runs beside the normal law. short: few runs."""
    errors: list[float] = []
    for seed in range(1, 4 if short else 31):
        run = rd.simulate(_pump(), run_seed=seed, samples=120)
        found = rd.identify(_pump(), run)
        for one in found.identification.estimates:
            true = (run.truth or {}).get(one.name)
            if true is not None and one.value is not None and one.imaginary is None and one.standard_error:
                errors.append((one.value - true) / one.standard_error)
    drawn, axes = figure(1, 1)
    plot, grid = axes[0, 0], np.linspace(-4.0, 4.0, 161)
    plot.hist(errors, bins=np.linspace(-4.0, 4.0, 33).tolist(), density=True, color=MEASURED, label=f"{len(errors)} estimates")
    plot.plot(grid, np.exp(-(grid**2) / 2.0) / np.sqrt(2.0 * np.pi), color=FITTED, label="what intervals promise")
    plot.set_xlabel("error over stated standard error")
    plot.set_yticks([])
    plot.legend()
    return drawn


def centreline(*, short: bool) -> "Figure":
    """Draw where journals stand in their clearances over speed, as identified. short: fewer samples."""
    train = rd.read_machine(EXAMPLES / "motor-compressor.yaml")
    return rd.identify(train, rd.simulate(train, samples=80 if short else 200)).plot_centreline()


def trend(*, short: bool) -> "Figure":
    """Draw a coupling's stiffness over healthy runs and, behind them, runs with a misalignment. short: fewer runs."""
    count, pump = (2 if short else 6), _pump()
    healthy = [rd.identify(pump, rd.simulate(pump, run_seed=seed)) for seed in range(1, count + 1)]
    later = [
        rd.identify(pump, rd.simulate(pump, scenario="misalignment", run_seed=seed))
        for seed in range(count + 1, 2 * count + 1)
    ]
    return rd.plot_trend([*healthy, *later], "coupling.C1.kxx")


FIGURES: Mapping[str, Callable[..., "Figure"]] = {
    one.__name__: one for one in (campbell, polar, bode, coverage, centreline, trend)
}
"""Figures by name."""


def with_figures(text: str, pages: Path, *, short: bool) -> str:
    """Return a page with its figures, which are written into the folder of the pages. Raises KeyError for an unknown one."""

    from matplotlib import pyplot

    pyplot.switch_backend("Agg")

    def drawn(found: re.Match[str]) -> str:
        name, words = found[1], found[2]
        made = FIGURES[name](short=short)
        made.savefig(pages / f"method-{name}.svg")
        pyplot.close(made)
        return f"![{words}](method-{name}.svg)\n\n*{words[:1].upper()}{words[1:]}.*"

    return MARK.sub(drawn, text)


def _pump() -> rd.Machine:
    return rd.read_machine(EXAMPLES / "motor-pump.yaml")
