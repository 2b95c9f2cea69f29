"""`rundown report`, run as a command on a database."""

from pathlib import Path

from storage.database.engine import Database
from tests.plant import KEY
from tests.service.commands.command_line import run


def test_a_report_is_written_as_pdf(plant: Database, tmp_path: Path) -> None:
    written = tmp_path / "pump.pdf"
    url = plant.url
    said = run("report", KEY.machine, "--output", str(written), "--database", url)
    assert "0 open alerts" in said
    assert written.read_bytes().startswith(b"%PDF-")


def test_what_is_wrong_is_one_line(plant: Database, tmp_path: Path) -> None:
    url, written = plant.url, str(tmp_path / "none.pdf")
    unknown = run("report", "none", "--output", written, "--database", url, status=1)
    assert unknown == f"rundown: no machine 'none' is known; there are {KEY.machine}\n"
    misspelt = run("report", KEY.machine[:-1], "--output", written, "--database", url, status=1)
    assert misspelt == f"rundown: no machine '{KEY.machine[:-1]}' is known; did you mean '{KEY.machine}'?\n"
    late = run("report", KEY.machine, "--from", "2200-01-01", "--output", written, "--database", url, status=1)
    assert "ends before it begins" in late
    inches = run("report", KEY.machine, "--units", "inch,rpm", "--output", written, "--database", url, status=1)
    assert "units 'inch,rpm' are none of: um_pp,rpm; " in inches
    assert not Path(written).exists()
