"""Pages of the evidence on alignment, fleets and calibration: what benchmarks write is whole, and says what falls short."""

from pathlib import Path

import pytest

from benchmarks.alignment import page as alignment_page
from benchmarks.calibration import page as calibration_page
from benchmarks.calibration.__main__ import PARTS
from benchmarks.fleet import page as fleet_page
from benchmarks.fleet.report import figures_command
from benchmarks.fluid_film.report_line import ReportLine


def test_a_page_of_alignment_says_what_falls_short_and_its_conditions_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(alignment_page, "PAGE", tmp_path / "alignment.md")
    alone = ReportLine("runs: accepted", ">= 95%", "100 %", True)
    short = ReportLine("    size told within 30 %", ">= 90%", "80 %", False)
    found = {"Runs with a rigid coupling": [alone], "Runs with a flexible coupling": [short], "Machines over weeks": []}
    written = alignment_page.write_page(found).read_text(encoding="utf-8")
    assert "1 of its figures falls short" in " ".join(written.split())
    assert "| &emsp;size told within 30 % | >= 90% | 80 % **SHORT** |" in written
    assert written.count(alignment_page.RUNS) == 1
    assert written.index("## Runs with a rigid coupling") < written.index(alignment_page.RUNS) < written.index("accepted |")
    assert "## Machines" not in written
    assert alignment_page.WEEKS not in written


def test_a_page_of_fleets_leaves_tables_without_rows_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fleet_page, "PAGE", tmp_path / "fleets.md")
    parts = [[["what", "of which"], *([["named", "3"]] if place == 1 else [])] for place in range(len(fleet_page.HEADINGS))]
    written = fleet_page.write_page(parts, command="--scale 0.1 --write", amount="3 machines").read_text(encoding="utf-8")
    assert [line for line in written.splitlines() if line.startswith("## ")] == [f"## {fleet_page.HEADINGS[1]}"]
    assert "| named | 3 |" in written
    assert "`python -m benchmarks.fleet --scale 0.1 --write` on commit" in " ".join(written.split())


def test_the_command_of_a_page_leaves_out_what_no_figure_depends_on() -> None:
    arguments = ["--scale", "0.1", "healthy=1.6", "--processes", "2", "--only", "probe drifts", "--keep", "folder", "--write"]
    assert figures_command(arguments) == "--scale 0.1 healthy=1.6 --only 'probe drifts' --write"


def test_a_page_of_calibration_tells_of_the_parts_that_were_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(calibration_page, "PAGE", tmp_path / "calibration.md")
    assert set(calibration_page.SECTIONS) == set(PARTS)
    short = ReportLine("20 sweeps of 150 speeds", "<= 10 s", "11.0 s", False)
    written = calibration_page.write_page({"sweeps": [short]}).read_text(encoding="utf-8")
    assert "| 20 sweeps of 150 speeds | <= 10 s | 11.0 s **SHORT** |" in written
    assert "`python -m benchmarks.calibration --only sweeps --write`" in " ".join(written.split())
    assert [line for line in written.splitlines() if line.startswith("## ")] == ["## Time"]
    whole = calibration_page.write_page({part: [short] for part in PARTS}).read_text(encoding="utf-8")
    assert "`python -m benchmarks.calibration --write`" in " ".join(whole.split())
