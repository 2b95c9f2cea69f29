"""Figures of a benchmark as a table of a page: what is measured, what was asked and what came."""

from collections.abc import Sequence

from benchmarks.fluid_film.report_line import ReportLine
from benchmarks.thesis.tables import table


def figure_table(figures: Sequence[ReportLine]) -> str:
    """Return a markdown table of figures."""
    rows = [[_shown(one.what), one.asked, f"{one.measured}{'' if one.kept else ' **SHORT**'}"] for one in figures]
    return table(["what", "asked", "measured"], rows)


def fallen_words(figures: Sequence[ReportLine]) -> str:
    """Return in words how many figures fall short, without the end of the sentence."""
    short = sum(not one.kept for one in figures)
    return f"{short} of its figures {'falls' if short == 1 else 'fall'}" if short else "none of its figures falls"


def _shown(what: str) -> str:
    """Return what a line tells; what belongs to the line before is moved in."""
    text = what.strip()
    return "&emsp;" * ((len(what) - len(text)) // 4) + text
