"""Commands name wrong input in one line, as the library does, without colours where the terminal has none."""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import rotorundown as rd
from service.commands.app import app
from tests.rotorundown.wrong_input import PUMP, in_radians, written


def invoked(*arguments: str, **environment: str) -> Any:
    """A command's end, in a terminal without colours."""
    return CliRunner().invoke(app, arguments, env={"NO_COLOR": "1", "TERM": "dumb", **environment})


def test_a_command_reads_a_table_as_the_library_does_and_says_its_units(run: rd.MachineRun, tmp_path: Path) -> None:
    ended = invoked("identify", str(PUMP), written(tmp_path / "plain.csv", run.to_frame()))
    assert ended.exit_code == 0, ended.output
    assert "plain.csv: read as r/min, µm peak-to-peak, phase lag in degrees" in ended.stderr
    assert "accepted: χ²/dof" in ended.stdout


TABLES: dict[str, tuple[Callable[[Any], Any], str]] = {
    "no rows": (lambda frame: frame[:0], "has no rows below a header line"),
    "wrong columns": (lambda frame: frame.rename(columns={"speed_rpm": "n"}), "no column holds the speed: name it speed"),
    "no channel": (lambda frame: frame[["speed_rpm"]], "no column holds an amplitude of a channel of 'motor-pump'"),
    "radians": (in_radians, "which looks like radians"),
    "a speed in Hz": (
        lambda frame: frame.assign(speed=frame["speed_rpm"] / 60.0).drop(columns="speed_rpm"),
        "are these in rad/s or Hz? Say so with speed_unit",
    ),
    "decimal commas": (lambda frame: frame.map(lambda one: f"{one}".replace(".", ",")), "write numbers with a decimal point"),
}


@pytest.mark.parametrize("name", TABLES)
def test_a_command_names_what_is_wrong_with_a_table(run: rd.MachineRun, tmp_path: Path, name: str) -> None:
    change, words = TABLES[name]
    ended = invoked("identify", str(PUMP), written(tmp_path / "run.csv", change(run.to_frame())))
    assert ended.exit_code == 1
    (line,) = ended.stderr.splitlines()
    assert line.startswith(f"rundown: {tmp_path / 'run.csv'}")
    assert words in line
    # A command has no option for units.
    assert line.endswith("(or in a sidecar, run.yaml)") is ("_unit" in line)


def test_an_empty_file_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "empty.csv").touch()
    ended = invoked("identify", str(PUMP), str(tmp_path / "empty.csv"))
    assert (ended.exit_code, len(ended.stderr.splitlines())) == (1, 1)
    assert "is empty: the first line names the columns" in ended.stderr


def test_decimal_commas_beside_a_sidecar_are_one_line(tmp_path: Path) -> None:
    file = tmp_path / "run.csv"
    assert invoked("sample", str(PUMP), str(file)).exit_code == 0
    file.write_text(file.read_text().replace("3596.4000,", '"3596,4",', 1))
    ended = invoked("identify", str(PUMP), str(file))
    (line,) = ended.stderr.splitlines()
    assert line.endswith("line 2: '3596,4' in column 'speed_rpm' is not a number: write numbers with a decimal point")


def test_misspelt_files_get_those_like_them(tmp_path: Path) -> None:
    file = tmp_path / "healthy.csv"
    assert invoked("sample", str(PUMP), str(file)).exit_code == 0
    wrong = tmp_path / "helthy.csv"
    missing = invoked("identify", str(PUMP), str(wrong))
    assert missing.stderr == f"rundown: {wrong}: no such file; did you mean 'healthy.csv'?\n"
    checked = invoked("check", str(PUMP), str(wrong))
    assert f"{wrong}: No such file or directory; did you mean 'healthy.csv'?\n" in checked.output
    shutil.copy(PUMP, tmp_path / "pump-12.yaml")
    ended = invoked("check", str(tmp_path / "pump.yaml"))
    assert ended.stderr.endswith("No such file or directory; did you mean 'pump-12.yaml'?\n")


def test_a_document_in_a_recording_s_place_is_said() -> None:
    ended = invoked("identify", str(PUMP), str(PUMP))
    assert ended.stderr == f"rundown: {PUMP} is no recording: name the table of the run, such as a CSV file\n"


def test_nothing_is_coloured_where_the_terminal_has_no_colours() -> None:
    for arguments in (("--help",), ("identify", "--help"), ("identify",), ("nothing",)):
        assert "\x1b" not in invoked(*arguments).output


def test_what_is_there_already_or_no_address_is_said(tmp_path: Path) -> None:
    shutil.copy(PUMP, tmp_path / "pump-12.yaml")
    assert "is there already: name another file" in invoked("init", str(tmp_path / "pump-12.yaml")).stderr
    nowhere = tmp_path / "nowhere" / "run.csv"
    assert invoked("sample", str(PUMP), str(nowhere)).stderr == f"rundown: {nowhere}: No such file or directory\n"
    assert "write protocol, host and port, such as tcp://" in invoked("worker", "nowhere").stderr
    assert "there is no file" in invoked("restore", str(tmp_path / "none.db")).stderr
