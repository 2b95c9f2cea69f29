"""Commands find the examples that come with Rundown from any folder, and say that they took them."""

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from rotorundown.environment.example_machines import example_names
from service.commands.app import app

PUMP = "examples/motor-pump.yaml"
TAKEN = f"{PUMP} is not in this folder: taken from the examples that come with Rundown, "


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder, which is the working folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def invoked(*arguments: str) -> Any:
    return CliRunner().invoke(app, arguments)


def test_an_example_is_taken_and_said_on_the_error_output() -> None:
    ended = invoked("document", PUMP)
    assert (ended.exit_code, json.loads(ended.stdout)["id"]) == (0, "motor-pump")
    (line,) = ended.stderr.splitlines()
    assert line.startswith(TAKEN)
    assert Path(line.removeprefix(TAKEN)).is_file()


def test_a_scenario_of_an_example_and_a_file_of_one_s_own(elsewhere: Path) -> None:
    assert invoked("sample", f"{PUMP}:misalignment", "later.csv", "--samples", "20").exit_code == 0
    ended = invoked("check", PUMP, "later.csv", "--json")
    assert (ended.exit_code, json.loads(ended.stdout)["runs"][0]["samples"]) == (0, 20)
    assert "'tired' is no scenario; there are healthy" in invoked("sample", f"{PUMP}:tired", "run.csv").stderr
    assert "; did you mean 'unbalance'?" in invoked("sample", f"{PUMP}:unbalanced", "run.csv").stderr
    (elsewhere / "examples").mkdir()
    (elsewhere / PUMP).write_text("- 1")
    own = invoked("document", PUMP)
    assert own.exit_code == 1
    assert own.stderr.startswith(f"rundown: {PUMP} is not a machine document")


@pytest.mark.parametrize("command", [("document",), ("identify",), ("simulate",), ("check", PUMP)])
def test_a_name_that_no_example_has_gets_those_there_are(command: tuple[str, ...]) -> None:
    ended = invoked(*command, "examples/pump.yaml", *(["run.csv"] if command == ("identify",) else []))
    assert ended.exit_code == 1
    (line,) = [one for one in ended.stderr.splitlines() if not one.startswith(TAKEN)]
    assert line == (
        "rundown: there is no file examples/pump.yaml; the examples that come with Rundown are " + ", ".join(example_names())
    )


def test_a_calibrated_example_is_written_into_the_working_folder(elsewhere: Path) -> None:
    ended = invoked("calibrate", "examples/rk4-rotor-kit-four-probes.yaml", "examples/recordings/rk4_unbalance_1x.csv")
    assert ended.exit_code == 0, ended.stderr
    assert "Written: rk4-rotor-kit-four-probes-calibrated.yaml" in ended.stdout
    assert [one.name for one in elsewhere.iterdir()] == ["rk4-rotor-kit-four-probes-calibrated.yaml"]
