"""Tables of runs are taken as people have them; what cannot be a run is named in one line that says what would be right."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import rotorundown as rd
from estimator.machine.document import Machine
from rotorundown.run_columns import WrongRun
from tests.rotorundown.wrong_input import doubled, one_line, untimed


def test_a_column_of_no_channel_is_left_out_and_named(pump: Machine, run: rd.MachineRun) -> None:
    frame = run.to_frame()
    read = rd.read_run(frame.assign(B9L_um_pp=frame["B1L_um_pp"]), machine=pump)
    (said,) = read.left_out
    assert "column 'B9L_um_pp' left out: 'B9L' is no channel of 'motor-pump'; did you mean" in said


MISREAD: dict[str, tuple[Callable[[Any, Path], Any], dict[str, Any], str]] = {
    "columns of other machines, and many of them": (
        lambda frame, _: frame.rename(columns=lambda name: name.replace("B", "X")),
        {},
        "X2R_lag_deg, X3L_um_pp, X3L_lag_deg, X3R_um_pp and 5 more",
    ),
    "a column twice": (lambda frame, _: doubled(frame), {}, "column 'B4R_um_pp' stands twice"),
    "an array": (lambda frame, _: frame.to_numpy(), {}, "a data frame or a mapping of columns, not ndarray"),
    "complex numbers": (
        lambda frame, _: {"speed_rpm": frame["speed_rpm"], "B1L_amplitude": 1e-6j * np.ones(len(frame))},
        {},
        "column 'B1L_amplitude' is complex: give its amplitude and its phase as two columns",
    ),
    "a row without numbers": (
        lambda frame, _: frame.drop(index=2).reindex(range(len(frame))),
        {},
        "the speed has no number in row 3: leave such rows out",
    ),
    "units in names": (
        lambda frame, _: frame.rename(columns={"speed_rpm": "Speed [RPM]"}),
        {},
        "name it speed or speed_rpm or rpm; there are Speed [RPM]",
    ),
    "a speed under another name": (
        lambda frame, _: frame.rename(columns={"speed_rpm": "Speed [RPM]"}),
        {},
        "does 'Speed [RPM]' hold it?",
    ),
    "one column alone": (lambda frame, _: frame["speed_rpm"], {}, "a data frame or a mapping of columns, not Series"),
    "numbers for columns": (lambda _f, _: {"speed_rpm": 1.0}, {}, "column 'speed_rpm' is a float: give a list of numbers"),
    "truth values": (lambda frame, _: frame.assign(B1L_um_pp=True), {}, "column 'B1L_um_pp', row 1: 'True' is not a number"),
    "dates as text": (
        lambda frame, _: frame.assign(time="2026-11-27 04:00:00"),
        {},
        "'2026-11-27 04:00:00' is not a number: write seconds since the start, or give a data frame with dates",
    ),
    "two names of one column": (
        lambda frame, _: frame.assign(B1L_amplitude=frame["B1L_um_pp"]),
        {},
        "columns 'B1L_amplitude' and 'B1L_um_pp' hold the amplitude of B1L: which one counts?",
    ),
    "two speeds": (lambda frame, _: frame.assign(Speed=1.0), {}, "columns 'speed' and 'speed_rpm' hold the speed"),
}


@pytest.mark.parametrize("name", MISREAD)
def test_what_cannot_be_a_run_is_one_line(pump: Machine, run: rd.MachineRun, tmp_path: Path, name: str) -> None:
    make, options, words = MISREAD[name]
    with pytest.raises(WrongRun, match=re.escape(words)) as raised:
        rd.read_run(make(untimed(run), tmp_path / "run.csv"), machine=pump, **options)
    one_line(raised)


def in_capitals(frame: Any) -> Any:
    return frame.rename(columns=lambda name: f" {name.upper()} ")


def dated(frame: Any, zone: str | None = None) -> Any:
    return frame.set_index(pd.date_range("2026-11-27", periods=len(frame), freq="2s", tz=zone))


TAKEN: dict[str, Callable[[Any], Any]] = {
    "names in capitals with spaces": in_capitals,
    "missing values of pandas": lambda frame: frame.astype("Float64"),
    "numbers as text": lambda frame: frame.astype(str),
    "the speed as index": lambda frame: frame.set_index("speed_rpm"),
    "dates as index": dated,
    "dates with a zone": lambda frame: dated(frame, "Europe/Berlin"),
    "dates as a column": lambda frame: dated(frame).rename_axis("time").reset_index(),
    "durations as index": lambda frame: frame.set_index(pd.timedelta_range(0, periods=len(frame), freq="2s")),
    "the time as index": lambda frame: frame.set_index(pd.Index(2.0 * np.arange(len(frame)), name="time_s")),
}


@pytest.mark.parametrize("name", TAKEN)
def test_a_frame_is_taken_as_people_have_it(pump: Machine, run: rd.MachineRun, name: str) -> None:
    read = rd.read_run(TAKEN[name](untimed(run)), machine=pump)
    assert read.speed_rpm == pytest.approx(run.speed_rpm, rel=1e-4)
    assert read.amplitude_um_pp == pytest.approx(run.amplitude_um_pp, rel=2e-3)
    assert (read.recorded.time is not None) is any(word in name for word in ("dates", "durations", "time"))
    if read.recorded.time is not None:
        assert read.interval_s == pytest.approx(2.0)


def test_a_missing_value_of_pandas_is_none(pump: Machine, run: rd.MachineRun) -> None:
    frame = run.to_frame().astype("Float64")
    frame.loc[3, "B1L_um_pp"] = pd.NA
    assert np.argwhere(np.isnan(rd.read_run(frame, machine=pump).amplitude_um_pp)).tolist() == [[3, 0]]


def test_phases_without_amplitudes_are_named(pump: Machine, run: rd.MachineRun) -> None:
    (said,) = rd.read_run(run.to_frame().drop(columns="B1L_um_pp"), machine=pump).left_out
    assert said.startswith("run, column 'B1L_lag_deg' left out: no column holds the amplitude, B1L_amplitude or B1L_um_pp")
