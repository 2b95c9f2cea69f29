"""The evidence of alignment as a page: what was asked, and what single runs and machines over weeks came to."""

import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path

from benchmarks.figure_tables import fallen_words, figure_table
from benchmarks.fluid_film.report_line import ReportLine
from benchmarks.kept_outcomes import commit
from benchmarks.thesis.tables import paragraphs

PAGE = Path(__file__).parents[2] / "docs" / "evidence-alignment.md"
INTRODUCTION = """\
# The evidence: alignment on oil films

Plants are of other make than the estimator (`tests/film_plant`). Every other one is drawn around a motor and compressor, the
others around a turbine and its generator: lengths, masses, clearances and oil by 15 %, diameters by 8 %, couplings by 20 %.
Phasors have 1 % noise. Runs differ by 1 % in stiffness, and by 5 % in damping and viscosity; one supply oils all bearings of a
train, whose viscosities differ by 3 %. Documents believe what is drawn. Samples are steady: the sweep is not simulated.

- **asked** is the figure that the project has set itself; an empty one is told only. **SHORT** marks what falls short.
- **95 % intervals hold** is the part of the intervals of accepted runs that contain the truth.
- Parts are followed by their 95 % intervals (Clopper and Pearson); upper bounds of rates are the 97.5 % ones (Garwood).
- Processor times are those of the machine that ran it, of fits and assessments on one core."""
RUNS = """\
Each plant is identified once, then six times as a baseline; then its coupling moves. The second shaft is off by 100 µm and
100 µrad (flexible) or 40 µm and 50 µrad (rigid) rms in each plane, each bearing by 10 or 5 µm besides, and moves by as much
again. With gap: the shaft centreline rides along, with 1 µm of noise and zeros that drift by 5 µm over the run."""
WEEKS = """\
Every week's run goes through the gate, the real fit and the service's own assessment. Baselines are of 5 to 8 runs; over the
year the oil is up to 10 K warmer and colder, with 2 K of weather, and the second shaft's pedestals grow by 1 µm/K; every other
pair of machines sends the oil's temperature; one third is misaligned by half of what is allowed from the beginning."""
PAIRS = """\
The second shaft sinks by twice what is allowed beside another cause, or there are two that are no misalignment; two machines
of each train for each pair. *Called otherwise*: what was named that had not happened."""
CONDITIONS = {"Runs": RUNS, "Machines": WEEKS, "Two causes": PAIRS}
"""Conditions of sections by the beginning of their names: said in the first of them."""


def write_page(found: Mapping[str, Sequence[ReportLine]]) -> Path:
    """Write the page.

    Args:
        found: Figures by section.

    Returns:
        The page.
    """
    fallen = fallen_words([one for figures in found.values() for one in figures])
    code = commit("benchmarks.alignment")
    written = (
        f"This page was written by `python -m benchmarks.alignment --write` on commit {code}: {fallen} short of what was "
        "asked, as far as they are judged. Seeds are stated in the code, so that the same numbers come again."
    )
    parts, untold = [INTRODUCTION, textwrap.fill(written, 120, break_on_hyphens=False)], dict(CONDITIONS)
    for name, figures in found.items():
        if not figures:
            continue
        parts.append(f"## {name}")
        parts += [untold.pop(one) for one in CONDITIONS if name.startswith(one) and one in untold]
        parts.append(figure_table(figures))
    PAGE.write_text(paragraphs(*parts) + "\n", encoding="utf-8")
    return PAGE
