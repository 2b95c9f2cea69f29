"""`rundown init` and `rundown check`: a document to begin with that works, and what is said of documents and runs."""

import json
import re
from pathlib import Path

import pytest
import yaml

import rotorundown as rd
from tests.paths import EXAMPLES
from tests.service.commands.command_line import run


@pytest.fixture
def pump(tmp_path: Path) -> Path:
    file = tmp_path / "pump-12.yaml"
    assert "rundown check" in run("init", str(file))
    return file


def test_the_document_to_begin_with_can_be_identified(pump: Path) -> None:
    machine = rd.read_machine(pump)
    assert machine.id == "pump-12"
    assert rd.identify(machine, rd.simulate(machine)).accepted


def test_the_document_is_checked_without_a_warning(pump: Path) -> None:
    assert run("check", str(pump)) == ("pump-12: 2 shafts, 2 discs, 4 bearings, 1 coupling, 8 probes; 300 to 3600 r/min\n")


def test_nothing_is_overwritten(pump: Path) -> None:
    pump.write_text("mine")
    assert "is there already" in run("init", str(pump), status=1)
    assert pump.read_text() == "mine"


def test_a_name_that_is_no_id_is_refused(tmp_path: Path) -> None:
    assert "is no id" in run("init", str(tmp_path / "pump 12.yaml"), status=1)


def test_runs_are_checked_against_the_document(pump: Path, tmp_path: Path) -> None:
    good, bad = tmp_path / "good.csv", tmp_path / "bad.csv"
    run("sample", str(pump), str(good))
    bad.write_text("speed;B1L_amplitude\n1500,5;3\n")
    text = run("check", str(pump), str(good), str(bad), status=1)
    assert "good.csv: 200 samples, B1L, B1R" in text
    assert "bad.csv: no column holds the phase of B1L: name it B1L_phase or B1L_lag_deg" in text
    assert "1 of 2 runs cannot be read" in text


def with_wrong_phasors(file: Path) -> None:
    """Freeze the first channel of a recorded run, and put one value of the next far out."""
    header, *rows = file.read_text(encoding="utf-8").splitlines()
    columns, cells = header.split(","), [row.split(",") for row in rows]
    for row in cells:
        row[columns.index("B1L_um_pp")], row[columns.index("B1L_lag_deg")] = "7.5", "20"
    cells[50][columns.index("B1R_um_pp")] = "5000"
    file.write_text("\n".join([header, *map(",".join, cells)]) + "\n", encoding="utf-8")


def test_what_is_wrong_with_phasors_is_reported(pump: Path, tmp_path: Path) -> None:
    file = tmp_path / "run.csv"
    run("sample", str(pump), str(file))
    assert "left out" not in run("check", str(pump), str(file))
    with_wrong_phasors(file)
    text = run("check", str(pump), str(file))
    assert "run.csv: channel lost: B1L has no usable value in the whole run (frozen)" in text
    assert "run.csv: 201 of 1600 phasors left out for their quality (200 frozen, 1 outlier)" in text
    (told,) = json.loads(run("check", str(pump), str(file), "--json"))["runs"]
    assert told["unusable_phasors"] == {"outlier": 1, "frozen": 200}


def test_a_wrong_unit_is_named(pump: Path) -> None:
    pump.write_text(pump.read_text().replace("kxx: 1.8e+7", "kxx: 18"))
    assert "was 18 N/µm meant, 1.8e+07 N/m?" in run("check", str(pump), status=1)


def test_a_train_that_would_whirl_is_warned_of(tmp_path: Path) -> None:
    said = yaml.safe_load((EXAMPLES / "motor-compressor.yaml").read_text(encoding="utf-8"))
    said["speed_range"]["maximum_rpm"] = 6000
    file = tmp_path / "fast.yaml"
    file.write_text(yaml.safe_dump(said), encoding="utf-8")
    assert re.search(r"warning: bearings: on the oil films .* would whirl from 5\d\d\d r/min", run("check", str(file)))


def test_films_that_carry_at_no_speed_of_the_range_are_told_once(tmp_path: Path) -> None:
    said = yaml.safe_load((EXAMPLES / "motor-compressor.yaml").read_text(encoding="utf-8"))
    said["bearings"][0]["film"]["valid_above_rpm"] = 9000
    file = tmp_path / "lifted.yaml"
    file.write_text(yaml.safe_dump(said), encoding="utf-8")
    (warning,) = [line for line in run("check", str(file)).splitlines() if line.startswith("warning")]
    assert "bearings[0].film.valid_above_rpm: 9000 r/min is not below the end of the speed range, 4600 r/min" in warning


def test_a_shaft_that_nothing_carries_is_said(tmp_path: Path) -> None:
    said = yaml.safe_load((EXAMPLES / "motor-compressor.yaml").read_text(encoding="utf-8"))
    said["couplings"] = []
    said["bearings"] = [one for one in said["bearings"] if one["id"] != "B1"]
    file = tmp_path / "loose.yaml"
    file.write_text(yaml.safe_dump(said), encoding="utf-8")
    assert "warning: bearings: a shaft is held neither by two bearings nor by a coupling" in run("check", str(file))


def test_a_document_is_begun_as_yaml(tmp_path: Path) -> None:
    assert "pump.json: the document is YAML, with comments; name it pump.yaml" in run(
        "init", str(tmp_path / "pump.json"), status=1
    )
    assert list(tmp_path.iterdir()) == []
