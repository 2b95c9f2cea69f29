"""`rundown calibrate`: from the measured rotor kit's nameplate to a document with which a held-out weight is found."""

import csv
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from formats.files.document_files import read_machine
from rotorundown.calibration import NotCalibrated
from service.commands.app import app
from tests.paths import EXAMPLES
from tests.service.commands.command_line import run
from tests.service.commands.recorded_run import write_run

DOCUMENT = str(EXAMPLES / "rk4-rotor-kit-four-probes.yaml")
HELD = "A005"


def recording(folder: Path, name: str, *, held: bool, **sidecar: Any) -> str:
    """Write the measured kit's records without one condition, or those of that condition alone; None takes a field away."""
    with (EXAMPLES / "recordings" / "rk4_unbalance_1x.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    with (folder / f"{name}.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]))
        writer.writeheader()
        writer.writerows(row for row in rows if (row["condition"] == HELD) is held)
    said = yaml.safe_load((EXAMPLES / "recordings" / "rk4_unbalance_1x.yaml").read_text()) | sidecar
    (folder / f"{name}.yaml").write_text(yaml.safe_dump({key: one for key, one in said.items() if one is not None}))
    return str(folder / f"{name}.csv")


@pytest.fixture(scope="module")
def calibrated(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Path]:
    """Return what the command prints, and the document that it writes."""
    folder = tmp_path_factory.mktemp("calibrated")
    output = folder / "kit.yaml"
    return run("calibrate", DOCUMENT, recording(folder, "taught", held=False), "--output", str(output)), output


def test_two_commands_find_a_weight_that_was_not_calibrated_with(calibrated: tuple[str, Path], tmp_path: Path) -> None:
    text, output = calibrated
    assert text.startswith("accepted")
    assert "2 speeds cannot determine 16 bearing terms: held at the document's values, within 20 %" in text
    assert "reached twice" in text
    later = run("identify", str(output), recording(tmp_path, "later", held=True, added_unbalance=None))
    assert later.startswith("accepted")
    assert "sweep" not in later
    assert "too few usable points" not in later
    [line] = [line for line in later.splitlines() if line.startswith("  D1")]
    words = line.split()
    size, half, reading, open_angle = float(words[1]), float(words[3]), float(words[7]), float(words[9].rstrip("°"))
    assert abs(size - 30.0) < half < 15.0
    assert abs((reading + 180.0) % 360.0 - 180.0) < open_angle < 40.0


def test_weights_that_a_later_run_states_are_no_part_of_what_it_gained(calibrated: tuple[str, Path], tmp_path: Path) -> None:
    text = run("identify", str(calibrated[1]), recording(tmp_path, "later", held=True))
    assert "gained since the calibration, beyond the weights that the sidecar states: D1 30 g mm at 0.0° (± 95 %" in text
    [line] = [line for line in text.splitlines() if line.startswith("  D1")]
    assert "left open" in line


def only(file: str, *conditions: str) -> str:
    """Leave the rows of some conditions alone in a recording."""
    header, *rows = Path(file).read_text().splitlines()
    Path(file).write_text("\n".join([header, *(row for row in rows if row.startswith(conditions))]) + "\n")
    return file


def test_each_mounting_of_a_later_file_has_an_unbalance_of_its_own(calibrated: tuple[str, Path], tmp_path: Path) -> None:
    """One fit of both would take 60 g mm on disc 1 and 24 g mm on disc 2 for one unbalance."""
    later = only(recording(tmp_path, "later", held=False, added_unbalance=None), "A013", "B009")
    text = run("identify", str(calibrated[1]), later)
    assert "2 mountings, each identified by itself" in text
    assert text.count("Unbalance gained since the calibration") == 2
    content = json.loads(run("identify", str(calibrated[1]), later, "--json").partition("\n")[2])
    first, second = content["mountings"]
    assert [one["mounting"] for one in content["mountings"]] == ["A013", "B009"]
    put_on = {"A013": [(0.0, 0.0), (30.0, 0.0)], "B009": [(24.0, -90.0), (0.0, 0.0)]}
    for one in (first, second):
        assert one["accepted"]
        for disc, (size, angle) in zip(one["unbalance_since_calibration"], put_on[one["mounting"]], strict=True):
            said = disc["g_mm"] * np.exp(1j * np.radians(disc["scale_deg"]))
            assert abs(said - size * np.exp(1j * np.radians(angle))) < 3.5 * disc["standard_error_g_mm"]


def test_what_is_left_out_of_a_file_of_several_mountings_is_said(calibrated: tuple[str, Path], tmp_path: Path) -> None:
    later = only(recording(tmp_path, "later", held=False, added_unbalance=None), "A013", "B009")
    header, first, *rows = Path(later).read_text().splitlines()
    spoilt = first.split(",")
    spoilt[header.split(",").index("p1x_raw_re_mil")] = "1e9"
    Path(later).write_text("\n".join([header, ",".join(spoilt), first, *rows]) + "\n")
    ended = CliRunner().invoke(app, ["identify", str(calibrated[1]), later])
    assert "2 mountings, each identified by itself" in ended.output
    assert ended.stderr.startswith(f"{later}, row 1"), ended.stderr


def test_a_later_table_without_a_sidecar_is_recognised_by_the_mark(calibrated: tuple[str, Path], tmp_path: Path) -> None:
    table = tmp_path / "table.csv"
    channels = read_machine(calibrated[1]).channels
    columns = ",".join(f"{channel}_um_pp,{channel}_lag_deg" for channel in channels)
    table.write_text(f"speed_rpm,{columns}\n1004.0,10.5,-35.0,14.0,-50.0,41.0,-5.0,20.0,-70.0\n")
    text = run("identify", str(calibrated[1]), str(table), status=1)
    assert "NOT TO BE USED, the fit is refused. Unbalance gained" in text
    assert "angles from +x towards +y" in text


def test_the_document_says_where_its_calibration_comes_from(calibrated: tuple[str, Path]) -> None:
    machine = read_machine(calibrated[1])
    assert machine.calibration is not None
    [one] = machine.calibration.runs
    assert (one.name, one.samples, one.mountings) == ("taught.csv", 38, 19)
    assert len(one.sha256) == 64
    assert not machine.describes_the_same_as(read_machine(Path(DOCUMENT)))


def test_a_covariance_that_was_cut_short_is_refused(calibrated: tuple[str, Path], tmp_path: Path) -> None:
    document = yaml.safe_load(calibrated[1].read_text())
    document["calibration"]["covariance"] = document["calibration"]["covariance"][:-1]
    (tmp_path / "cut.yaml").write_text(yaml.safe_dump(document))
    assert "37 parameters need 37 values and a covariance of 37 rows" in run("document", str(tmp_path / "cut.yaml"), status=1)


@pytest.mark.parametrize(
    ("sidecar", "words"),
    [
        ({"added_unbalance": None}, "does not state which trial weights were on: `added_unbalance: none` for none"),
        (
            {"added_unbalance": {"D1": {"amount": "U1_gmm", "unit": "kg m", "angle_deg": "U1_deg"}}},
            "60 kg m on disc D1 (0.8 kg) would move its centre of mass by 75 m: 60 g mm is likely, so `unit: g mm`",
        ),
        (
            {"added_unbalance": {"D1": {"amount": "U1_gmm", "unit": "kg mm", "angle_deg": "U1_deg"}}},
            "is `unit: g mm` meant (60 g mm where kg mm was said, 83.3 g mm where oz in was said)?",
        ),
        ({"added_unbalance": "none"}, "no run has a trial weight"),
        ({"kind": "sweep", "interval_s": 1.0}, "its sidecar says `kind: dwells`"),
    ],
)
def test_wrong_runs_are_named(tmp_path: Path, sidecar: dict[str, Any], words: str) -> None:
    file = recording(tmp_path, "wrong", held=False, **sidecar)
    assert words in run("calibrate", DOCUMENT, file, "--output", str(tmp_path / "none.yaml"), status=1)
    assert not (tmp_path / "none.yaml").exists()


@pytest.mark.parametrize("command", ["check", "identify"])
def test_a_weight_in_an_unlikely_unit_is_named_before_a_calibration(tmp_path: Path, command: str) -> None:
    weights = {"D1": {"amount": "U1_gmm", "unit": "kg m", "angle_deg": "U1_deg"}}
    file = recording(tmp_path, "wrong", held=False, added_unbalance=weights)
    words = "60 kg m on disc D1 (0.8 kg) would move its centre of mass by 75 m: 60 g mm is likely, so `unit: g mm`"
    assert words in run(command, DOCUMENT, file, status=1)


@pytest.mark.parametrize("beside", [True, False], ids=["with a sidecar", "without"])
@pytest.mark.parametrize("content", ["", "\n \n"], ids=["no byte", "blank lines"])
def test_an_empty_recording_is_named_by_every_command(tmp_path: Path, content: str, beside: bool) -> None:
    file = recording(tmp_path, "empty", held=False)
    Path(file).write_text(content)
    if not beside:
        Path(file).with_suffix(".yaml").unlink()
    words = f"{file} is empty: the first line names the columns, each line below holds one sample"
    for arguments in (("check", DOCUMENT, file), ("calibrate", DOCUMENT, file), ("identify", DOCUMENT, file)):
        assert words in run(*arguments, status=1)
    assert words in run("balance", DOCUMENT, file, file, status=1)


def test_a_file_that_is_given_twice_or_copied_is_no_further_run(tmp_path: Path) -> None:
    first = recording(tmp_path, "first", held=False)
    assert "first.csv and first.csv hold the same samples: one is a copy" in run("calibrate", DOCUMENT, first, first, status=1)
    other = recording(tmp_path, "other", held=False, added_unbalance={"D1": {"amount": 5, "unit": "g mm", "angle_deg": 10}})
    assert "first.csv and other.csv hold the same samples" in run("calibrate", DOCUMENT, first, other, status=1)


def test_gains_that_no_chain_has_ask_for_the_unit_of_the_weights(tmp_path: Path) -> None:
    """All weights in g in that are g mm: a factor on all of them is one on all gains, which no run contradicts."""
    weights = {f"D{n}": {"amount": f"U{n}_gmm", "unit": "g in", "angle_deg": f"U{n}_deg"} for n in (1, 2)}
    few = recording(tmp_path, "few", held=False, added_unbalance=weights)
    header, *rows = Path(few).read_text().splitlines()
    Path(few).write_text("\n".join([header, *(row for row in rows if row.startswith(("BASE", "A007", "A015")))]))
    text = run("calibrate", DOCUMENT, few, "--output", str(tmp_path / "kit.yaml"))
    assert "which no usual chain does: are the trial weights' units right (such as" in text
    assert "g mm given as g in" in text
    *_, written, doubt = text.splitlines()
    assert written.startswith("Written: ")
    assert doubt.startswith("Before you use it: the channels read ")
    assert "(such as g mm given as g in" in doubt


@pytest.mark.parametrize("command", ["calibrate", "identify"])
def test_a_keyphasor_without_pulses_is_named(tmp_path: Path, command: str) -> None:
    file = recording(tmp_path, "still", held=False)
    header, *rows = [line.split(",") for line in Path(file).read_text().splitlines()]
    place = header.index("rpm")
    Path(file).write_text(
        "\n".join(",".join([*row[:place], "0", *row[place + 1 :]]) for row in rows).join([",".join(header) + "\n", "\n"])
    )
    assert "its speed is zero throughout: did the keyphasor give pulses" in run(command, DOCUMENT, file, status=1)


@pytest.mark.parametrize(("phase", "told"), [("0", "its phases are zero throughout"), ("", "it has no phases")])
def test_phases_that_nobody_measured_are_named(tmp_path: Path, phase: str, told: str) -> None:
    """As a vendor's export gives them that had no keyphasor."""
    kit = {"plant": "examples", "machine": "rk4-rotor-kit-four-probes"}
    speed, still = np.linspace(110.0, 160.0, 20), np.full((20, 4), 3.0 + 0.0j)
    file = Path(write_run(tmp_path / "run.csv", speed, still, channels=("P1X", "P1Y", "P2X", "P2Y"), **kit))
    header, *rows = [line.split(",") for line in file.read_text().splitlines()]
    emptied = [[phase if name.endswith("_p") else one for name, one in zip(header, row, strict=True)] for row in rows]
    file.write_text("\n".join(",".join(row) for row in [header, *emptied]))
    words = f"{told}: did the keyphasor give pulses, and are the columns of phases the right ones?"
    assert words in run("identify", DOCUMENT, str(file), status=1)


def test_units_that_are_mixed_among_the_trials_are_named(tmp_path: Path) -> None:
    """The weights on disc 1 in g mm, those on disc 2 in g in although g mm are meant."""
    weights = {
        f"D{n}": {"amount": f"U{n}_gmm", "unit": unit, "angle_deg": f"U{n}_deg"} for n, unit in ((1, "g mm"), (2, "g in"))
    }
    mixed = recording(tmp_path, "mixed", held=False, added_unbalance=weights)
    text = run("calibrate", DOCUMENT, mixed, "--output", str(tmp_path / "kit.yaml"), status=1)
    assert re.search(r"the weights on D2 are \d+ times as heavy as the others: are units mixed", text)
    assert "it fits with the weights on D2, which were given in g in, in g mm" in text


def test_runs_that_the_model_cannot_explain_write_nothing(tmp_path: Path) -> None:
    file = recording(tmp_path, "lead", held=False, phase_convention="lead", disc_scale={"counted": "against-rotation"})
    output = tmp_path / "none.yaml"
    text = run("calibrate", DOCUMENT, file, "--output", str(output), status=1)
    assert "NOT ACCEPTED" in text
    assert (
        "it fits with the angles of the weights counted the other way round (`disc_scale`) or with the opposite sign" in text
    )
    assert not output.exists()


def test_runs_that_never_enter_the_speed_range_are_told_before_the_fit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    document = tmp_path / "kit.yaml"
    said = yaml.safe_load(Path(DOCUMENT).read_text()) | {"speed_range": {"minimum_rpm": 2000, "maximum_rpm": 4000}}
    document.write_text(yaml.safe_dump(said))
    file = recording(tmp_path, "slow", held=False)

    def never(*_: object, **__: object) -> None:
        raise NotCalibrated("the fit begins")

    monkeypatch.setattr("rotorundown.calibration.calibrate_runs", never)
    first, *rest = run("calibrate", str(document), file, status=1).splitlines()
    assert first.startswith(f"{file}: it turns at 1002 to 1209 r/min and never enters the document's speed range")
    assert "the fit begins" in rest[-1]


def test_a_document_of_ones_own_is_never_written_over(tmp_path: Path) -> None:
    own = tmp_path / "own.yaml"
    own.write_bytes(Path(DOCUMENT).read_bytes())
    told = run("calibrate", str(own), recording(tmp_path, "taught", held=False), "--output", str(own), status=1)
    assert "own.yaml is there already, and is no calibrated document: name another file to write" in told
    assert own.read_bytes() == Path(DOCUMENT).read_bytes()
