"""The pages of evidence are whole: headings stand alone, tables are rectangular, figures exist."""

import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
NAMES = sorted(path.name for path in DOCS.glob("evidence*.md"))
PAGES = {one: (DOCS / one).read_text(encoding="utf-8").splitlines() for one in NAMES}


def test_every_chapter_is_there() -> None:
    chapters = [int(found[1]) for line in PAGES["evidence.md"] if (found := re.match(r"## Chapter (\d)", line))]
    assert chapters == [2, 3, 4, 5]


@pytest.mark.parametrize("page", PAGES)
def test_headings_stand_alone(page: str) -> None:
    crowded = [
        line
        for line, after in zip(PAGES[page], [*PAGES[page][1:], ""], strict=True)
        if line.startswith("#") and (after or len(line) > 120)
    ]
    assert crowded == []


@pytest.mark.parametrize("page", PAGES)
def test_tables_are_rectangular(page: str) -> None:
    width = 0
    for number, line in enumerate(PAGES[page], start=1):
        cells = line.count("|") if line.startswith("|") else 0
        assert cells in (width, 0) or width == 0, f"line {number} has {cells - 1} cells, its table {width - 1}"
        width = cells


def test_figures_exist_and_none_is_left_over() -> None:
    linked = set(re.findall(r"\]\((evidence/[\w-]+\.svg)\)", "\n".join(line for lines in PAGES.values() for line in lines)))
    assert linked == {f"evidence/{path.name}" for path in (DOCS / "evidence").glob("*.svg")}


@pytest.mark.parametrize("page", PAGES)
def test_no_number_is_missing(page: str) -> None:
    assert [line for line in PAGES[page] if re.search(r"\bnan\b|\binf\b", line)] == []
