"""Rows and columns that are no part of a run are left out, and it is said why, by the library and by commands alike."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas
import pytest
from typer.testing import CliRunner

import rotorundown as rd
from estimator.machine.document import Machine
from formats.recordings.written_recording import write_recording
from service.commands.app import app
from tests.rotorundown.wrong_input import PUMP

STILL = "left out: at standstill (0 r/min) there is no vibration at the running speed"


def dates(count: int) -> list[str]:
    """Return the dates of samples three seconds apart, by the minute."""
    return [f"2025-01-01 00:{3 * row // 60:02}" for row in range(count)]


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


def test_columns_of_no_channel_are_left_out_of_a_table(pump: Machine, run: rd.MachineRun, tmp_path: Path) -> None:
    frame = run.to_frame().assign(comment="ok", bearing_temperature=61.5)
    words = "columns 'bearing_temperature', 'comment' left out: of no channel of 'motor-pump'"
    assert rd.read_run(frame, machine=pump).left_out == (f"run, {words}",)
    file = tmp_path / "run.csv"
    frame.to_csv(file, index=False)
    assert rd.read_run(file, machine=pump).left_out == (f"run.csv, {words}",)
    ended = CliRunner().invoke(app, ["identify", str(PUMP), str(file)])
    assert (ended.exit_code, f"run.csv, {words}" in ended.stderr) == (0, True)


def test_numbers_of_rows_are_not_worth_a_note(pump: Machine, run: rd.MachineRun, tmp_path: Path) -> None:
    file = tmp_path / "run.csv"
    run.to_frame().to_csv(file)
    assert rd.read_run(file, machine=pump).left_out == ()
    assert rd.read_run(pandas.read_csv(file), machine=pump).left_out == ()


def test_a_column_that_seems_to_hold_the_times_is_asked_for(pump: Machine, run: rd.MachineRun) -> None:
    frame = run.to_frame()
    stamped = frame.drop(columns="time_s").assign(Timestamp="2026-11-27 04:00:00")
    (said,) = rd.read_run(stamped, machine=pump).left_out
    assert said.endswith(
        "of no channel of 'motor-pump'; where 'Timestamp' holds the times, name it time, in seconds or as dates"
    )
    (said,) = rd.read_run(frame.assign(Timestamp="2026-11-27 04:00:00"), machine=pump).left_out
    assert said.endswith("of no channel of 'motor-pump'")


def test_times_that_are_doubted_are_told(pump: Machine, run: rd.MachineRun) -> None:
    frame = run.to_frame()
    slow = frame.assign(time_s=1000.0 * np.arange(len(frame)))
    (said,) = rd.read_run(slow, machine=pump).left_out
    assert said.startswith("run, the run lasts ")
    assert said.endswith(" h: are its times in milliseconds? Write seconds")
    back = frame.assign(time_s=np.arange(len(frame), dtype=float))
    back.loc[[4, 5], "time_s"] = [5.0, 4.0]
    (said,) = rd.read_run(back, machine=pump).left_out
    assert said == "run, the times go back 1 time, first from row 5 to row 6, from 5 s to 4 s: are the rows in order of time?"
    equal = frame.assign(time_s=np.arange(len(frame)) // 2)
    assert rd.read_run(equal, machine=pump).left_out == ()


def test_rows_of_blank_cells_are_none_beside_a_sidecar(pump: Machine, run: rd.MachineRun, tmp_path: Path) -> None:
    file = file_with_sidecar(tmp_path, pump, run)
    lines = file.read_text().splitlines()[:-1]
    file.write_text("\n".join([*lines, "," * lines[0].count(","), "," * lines[0].count(",")]) + "\n")
    read = rd.read_run(file, machine=pump)
    assert (len(read), read.left_out) == (len(run), ())


def test_a_date_beside_times_within_the_minute_is_told(pump: Machine, run: rd.MachineRun) -> None:
    count = len(run)
    frame = run.to_frame().drop(columns="time_s").assign(Date=dates(count), Time=3.0 * np.arange(count) % 60.0)
    said = rd.read_run(frame, machine=pump).left_out
    assert (
        "run, the times go back 9 times, first from row 20 to row 21, from 57 s to 0 s: are the rows in order of time?" in said
    )
    assert "run, column 'Date' seems part of the times: write both as one column time, such as 2025-01-01 00:00:00" in said
    assert not any("seems part" in one for one in rd.read_run(frame.assign(Time=np.arange(count)), machine=pump).left_out)


def test_dates_over_a_day_are_not_asked_for_milliseconds(pump: Machine, run: rd.MachineRun) -> None:
    days = pandas.date_range("2025-01-01", periods=len(run), freq="10min")
    frame = run.to_frame()
    assert rd.read_run(frame.drop(columns="time_s").set_index(days), machine=pump).left_out == ()
    assert rd.read_run(frame.drop(columns="time_s").assign(time=days.astype(str)), machine=pump).left_out == ()
    (said,) = rd.read_run(frame.assign(time_s=600.0 * np.arange(len(run))), machine=pump).left_out
    assert said.endswith("are its times in milliseconds? Write seconds")
