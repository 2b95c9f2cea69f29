"""Rows and columns that are no part of a run are left out, and it is said why, by the library and by commands alike."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas
import pytest
from typer.testing import CliRunner

import rotorundown as rd
from estimator.machine.document import Machine
from formats.recordings.recording import write_recording
from service.commands.app import app
from tests.rotorundown.wrong_input import PUMP

STILL = "left out: at standstill (0 r/min) there is no vibration at the running speed"


def coasted(run: rd.MachineRun, *, rows: int = 1) -> Any:
    """A run as a data frame that goes on for some rows after the machine stands."""
    frame = run.to_frame()
    last = frame.iloc[[-1] * rows].assign(speed_rpm=0.0, time_s=frame["time_s"].iloc[-1] + 1.0 + np.arange(rows))
    return pandas.concat([frame, last], ignore_index=True)


def file_with_sidecar(folder: Path, machine: Machine, run: rd.MachineRun) -> Path:
    """A recording that ends with a row at standstill, with its sidecar."""
    file = folder / "run.csv"
    speed, phasor = np.append(run.speed_rpm, 0.0), np.vstack([run.recorded.phasor, run.recorded.phasor[-1:]])
    write_recording(file, machine, speed_rpm=speed, phasor=phasor, interval_s=run.interval_s)
    return file


def test_rows_at_standstill_are_left_out_of_a_table(pump: Machine, run: rd.MachineRun) -> None:
    count = len(run)
    read = rd.read_run(coasted(run), machine=pump)
    assert (len(read), read.left_out) == (count, (f"run, row {count + 1} {STILL}",))
    assert len(read.recorded.speed) == len(read.measurement.speed) == count
    several = rd.read_run(coasted(run, rows=4), machine=pump)
    assert (len(several), several.left_out) == (count, (f"run, rows {count + 1} to {count + 4} {STILL}",))
    frame = coasted(run)
    frame.loc[1, "speed_rpm"] = 0.0
    assert rd.read_run(frame, machine=pump).left_out == (f"run, rows 2 to {count + 1}, 2 of these, {STILL}",)


def test_rows_at_standstill_are_left_out_beside_a_sidecar(pump: Machine, run: rd.MachineRun, tmp_path: Path) -> None:
    file = file_with_sidecar(tmp_path, pump, run)
    read = rd.read_run(file, machine=pump)
    assert (len(read), read.left_out) == (len(run), (f"{file}, row {len(run) + 1} {STILL}",))
    assert rd.identify(pump, read).accepted


@pytest.mark.parametrize("sidecar", [True, False])
def test_commands_say_that_rows_at_standstill_are_left_out(
    pump: Machine, run: rd.MachineRun, tmp_path: Path, sidecar: bool
) -> None:
    file = file_with_sidecar(tmp_path, pump, run) if sidecar else tmp_path / "plain.csv"
    if not sidecar:
        coasted(run).to_csv(file, index=False)
    checked = CliRunner().invoke(app, ["check", str(PUMP), str(file)])
    assert checked.exit_code == 0, checked.output
    assert f"row {len(run) + 1} {STILL}" in checked.output
    assert " 0 to " not in checked.output
    ended = CliRunner().invoke(app, ["identify", str(PUMP), str(file)])
    assert ended.exit_code == 0, ended.output
    assert f"row {len(run) + 1} {STILL}" in ended.stderr
