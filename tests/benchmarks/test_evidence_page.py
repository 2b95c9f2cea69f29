"""The evidence page is whole: headings stand alone, tables are rectangular, figures exist."""

import re
from pathlib import Path

DOCS = Path(__file__).parents[2] / "docs"
LINES = (DOCS / "evidence.md").read_text(encoding="utf-8").splitlines()


def test_every_chapter_is_there() -> None:
    chapters = [int(found[1]) for line in LINES if (found := re.match(r"## Chapter (\d)", line))]
    assert chapters == [2, 3, 4, 5]


def test_headings_stand_alone() -> None:
    crowded = [
        line
        for line, after in zip(LINES, [*LINES[1:], ""], strict=True)
        if line.startswith("#") and (after or len(line) > 120)
    ]
    assert crowded == []


def test_tables_are_rectangular() -> None:
    width = 0
    for number, line in enumerate(LINES, start=1):
        cells = line.count("|") if line.startswith("|") else 0
        assert cells in (width, 0) or width == 0, f"line {number} has {cells - 1} cells, its table {width - 1}"
        width = cells


def test_figures_exist_and_none_is_left_over() -> None:
    linked = set(re.findall(r"\]\((evidence/[\w-]+\.svg)\)", "\n".join(LINES)))
    assert linked == {f"evidence/{path.name}" for path in (DOCS / "evidence").glob("*.svg")}


def test_no_number_is_missing() -> None:
    assert [line for line in LINES if re.search(r"\bnan\b|\binf\b", line)] == []
