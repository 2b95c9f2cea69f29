"""The page of the evidence on films: what was written by hand stays where it stands when a benchmark writes it anew."""

from pathlib import Path

import pytest

from benchmarks.fluid_film import page
from benchmarks.fluid_film.report_line import ReportLine

PART = "other-trains"


def test_a_paragraph_by_hand_stays_in_its_section(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written = tmp_path / "films.md"
    before = page.PAGE.read_text(encoding="utf-8")
    (by_hand,) = page.paragraphs_by_hand(before)[page.SECTIONS[PART]]
    written.write_text(before, encoding="utf-8")
    monkeypatch.setattr(page, "PAGE", written)
    monkeypatch.setattr(page, "DOCS", tmp_path)
    figures = {part: [ReportLine(f"{part}: accepted", ">= 80 %", "100 %", True)] for part in ("sweep", PART, "own-forms")}
    for _ in range(2):
        page.write_page(figures, plants=dict.fromkeys(figures, 4), left_out=[])
        paragraphs = written.read_text(encoding="utf-8").strip().split("\n\n")
        place = paragraphs.index(by_hand)
        assert paragraphs.count(by_hand) == 1
        assert paragraphs[place - 1].startswith("| what | asked | measured |")
        assert f"{PART}: accepted" in paragraphs[place - 1]
        assert paragraphs[place + 1] == f"## {page.SECTIONS['own-forms']}"


def test_a_first_page_has_nothing_by_hand(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page, "PAGE", tmp_path / "films.md")
    page.write_page({}, plants={}, left_out=[])
    assert page.paragraphs_by_hand(page.PAGE.read_text(encoding="utf-8")) == {}
