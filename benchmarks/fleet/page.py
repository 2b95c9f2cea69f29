"""The evidence of simulated fleets of constant coefficients as a page."""

import textwrap
from collections.abc import Sequence
from pathlib import Path

from benchmarks.kept_outcomes import commit
from benchmarks.thesis.tables import paragraphs, table

PAGE = Path(__file__).parents[2] / "docs" / "evidence-fleets.md"
INTRODUCTION = """\
# The evidence: fleets of constant coefficients

What is simulated, and what case A₁ is: [fleets.md](fleets.md). Machines on oil films:
[evidence-alignment.md](evidence-alignment.md).
An alert is right when its kind and its element are. *Together* and *apart*: in one half of the machines all bearings and
couplings follow the season together, in the other each by its own amount and at its own time. Intervals are exact (Clopper and
Pearson for parts, Garwood for rates)."""
HEADINGS = (
    "What case A₁ does to natural frequencies",
    "False misalignment alerts",
    "Steps seen",
    "Drifts seen",
    "What is named, and what was not there",
    "First alerts after a change",
)


def write_page(parts: Sequence[Sequence[Sequence[str]]], *, command: str, amount: str) -> Path:
    """Write the page.

    Args:
        parts: Tables of the report, each with its header first.
        command: Arguments of the benchmark.
        amount: How many machines were simulated, in words.

    Returns:
        The page.
    """
    written = (
        f"This page was written by `python -m benchmarks.fleet {command}` on commit {commit('benchmarks.fleet')}: {amount}."
    )
    told = [INTRODUCTION, textwrap.fill(written, 120, break_on_hyphens=False)]
    for heading, (header, *rows) in zip(HEADINGS, parts, strict=True):
        if rows:
            told += [f"## {heading}", table(header, rows)]
    PAGE.write_text(paragraphs(*told) + "\n", encoding="utf-8")
    return PAGE
