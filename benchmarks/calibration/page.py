"""The evidence of calibration by known weights as a page: what was asked and measured, by part."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from benchmarks.figures_page import figures_page
from benchmarks.fluid_film.report_line import ReportLine

PAGE = Path(__file__).parents[2] / "docs" / "evidence-calibration.md"
INTRODUCTION = """\
# The evidence: calibration by known weights

A train whose probes' gains, phases and run-outs are unknown is calibrated from runs with known weights; later its unbalance is
told in g mm. The measured rotor kit is that of the balancing data with 48 and 24 g mm on its discs, described by its nameplate
only; simulated trains are the examples, drawn from their documents, with gains off by a factor of two, phases that are any and
run-outs of 3 µm, and mounted anew before every run.

- **asked** is the figure that the project has set itself; an empty one is told only. **SHORT** marks what falls short.
- Errors are told as rms of the magnitude and median of the angle.
- **95 % intervals hold** is the part of the intervals of accepted fits that contain the truth.
- Times are those of the machine that ran it, on one core."""
SECTIONS = {
    "folds": (
        "The measured kit, a fifth held out",
        "Conditions are parted into five folds at random, in a number of splits; the known unbalances of each fifth are "
        "estimated by a calibration from the others. Least squares: phasors linear in the weights, in the same folds.",
    ),
    "both-speeds": ("The measured kit, both speeds in one fit", ""),
    "three-runs": (
        "The measured kit, from three runs",
        "The bare kit and 48 g mm on each disc, and all nine sets with one weight from 24 g mm on each disc. Mountings "
        "of the kit differ by some 8 g mm, which three runs cannot show.",
    ),
    "printed": (
        "Printed balancing cases",
        "Printed inputs are rounded, and so are the corrections. Where a correction is more than 2 % from the published one, "
        "it must be what the inputs give when solved by other means (*inputs*: the difference from that), and leave no "
        "more than the published one does.",
    ),
    "influence": ("Influence coefficients on the measured kit", ""),
    "simulated": ("Simulated kits", "Kits of seeds 0, 1, …, mounted anew before every run."),
    "changed-gains": (
        "Gains that changed since the calibration",
        "Simulated kits calibrated from 16 mountings, one of whose gains is then larger; and the same where the calibration "
        "allows for a drift of its gains.",
    ),
    "trains": (
        "Simulated trains",
        "Trains of seeds 0, 1, …: eight runs of 60 speeds calibrate each, three later changes of the unbalance are estimated.",
    ),
    "sweeps": ("Time", ""),
    "wrong-weights": (
        "Weights that are stated wrongly",
        "Right weights whose mountings differ by more than usual, angles counted the other way round, discs exchanged, every "
        "third run in another unit, and each run with the weights of the next.",
    ),
}
"""Heading of each part, and its conditions."""


def write_page(found: Mapping[str, Sequence[ReportLine]]) -> Path:
    """Write the page.

    Args:
        found: Figures by part.

    Returns:
        The page.
    """
    PAGE.write_text(figures_page(INTRODUCTION, SECTIONS, found, benchmark="benchmarks.calibration"), encoding="utf-8")
    return PAGE
