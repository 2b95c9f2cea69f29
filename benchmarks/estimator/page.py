"""The evidence of single fits as a page: what was asked and measured, by part."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from benchmarks.figures_page import figures_page
from benchmarks.fluid_film.report_line import ReportLine

PAGE = Path(__file__).parents[2] / "docs" / "evidence-estimator.md"
INTRODUCTION = """\
# The evidence: one identification

Constant coefficients of the train of the thesis's Chapter 3, measured at its bearings only (150 speeds, 8 channels, 50
unknowns), and of the turbine-compressor-generator example (290 speeds, 12 channels, 78 unknowns); 1 % noise where nothing else
is said.

- **asked** is the figure that the project has set itself; an empty one is told only. **SHORT** marks what falls short.
- The **bound** is that of Cramér and Rao: no unbiased estimate has a smaller rms error.
- Times are those of the machine that ran it, on one core and one thread of the linear algebra."""
SECTIONS = {
    "model": ("The model", "Response of the same mesh, computed by ROSS."),
    "efficiency": ("Efficiency and coverage", "Over seeds of the noise, from the document's nominal values."),
    "convergence": ("Wrong documents", "Every nominal value off by up to ±50 %, drawn anew for each document."),
    "silence": ("Documents that say nothing", "No nominal values of some elements; no promise is made for these."),
    "bias": ("Wrong elasticity and density", "Both 5 % off, with a stated spread of 5 %."),
    "outliers": ("Wrong points", "A twentieth of the points is off."),
    "speed": ("Time and memory", ""),
    "script": ("A user's own script", "Dense finite elements, `least_squares`, finite differences; same data, same start."),
}


def page(found: Mapping[str, Sequence[ReportLine]]) -> str:
    """Return the page with the figures of its parts.

    Args:
        found: Figures by part.

    Returns:
        The page in markdown.
    """
    return figures_page(INTRODUCTION, SECTIONS, found, benchmark="benchmarks.estimator")
