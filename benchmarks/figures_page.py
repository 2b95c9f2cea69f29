"""A benchmark's figures as a page of the evidence: what was asked and what came, by section."""

import textwrap
from collections.abc import Mapping, Sequence

from benchmarks.figure_tables import fallen_words, figure_table
from benchmarks.fluid_film.report_line import ReportLine
from benchmarks.kept_outcomes import commit
from benchmarks.thesis.tables import paragraphs


def figures_page(
    introduction: str, sections: Mapping[str, tuple[str, str]], found: Mapping[str, Sequence[ReportLine]], *, benchmark: str
) -> str:
    """Return a page in markdown.

    Args:
        introduction: Its beginning, from the title on.
        sections: Heading and conditions of each section, by name.
        found: Figures by section.
        benchmark: Module that was run.

    Returns:
        The page.
    """
    fallen = fallen_words([one for figures in found.values() for one in figures])
    only = "" if set(found) == set(sections) else "".join(f" --only {name}" for name in found)
    code = commit(benchmark)
    written = (
        f"This page was written by `python -m {benchmark}{only} --write` on commit {code}: {fallen} short of what "
        "was asked, as far as they are judged. Seeds are stated in the code, so that the same numbers come again."
    )
    parts = [introduction, _filled(written)]
    for name, (heading, conditions) in sections.items():
        if found.get(name):
            parts += [f"## {heading}", *([_filled(conditions)] if conditions else []), figure_table(found[name])]
    return paragraphs(*parts) + "\n"


def _filled(text: str) -> str:
    return textwrap.fill(text, 120, break_on_hyphens=False)
