"""Tables of runs are taken as people have them; what cannot be a run is named in one line that says what would be right."""

import re
from collections.abc import Callable
from datetime import datetime
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


def dates(count: int) -> list[str]:
    """Return moments two seconds apart in ISO 8601."""
    return [one.isoformat() for one in pd.date_range("2026-11-27 04:00:00", periods=count, freq="2s")]


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
        lambda frame, _: frame.rename(columns={"speed_rpm": "Speed [x]"}),
        {},
        "column 'Speed [x]': its unit 'x' is not known: write one of rpm, rad/s, Hz",
    ),
    "another kind in brackets": (
        lambda frame, _: frame.rename(columns={"B1L_um_pp": "B1L Amplitude (µm rms)"}),
        {},
        "its unit 'µm rms' is not known: write one of m, mm, um, mil and one of peak, peak-to-peak",
    ),
    "a unit twice in brackets": (
        lambda frame, _: frame.rename(columns={"B1L_um_pp": "B1L Amplitude (µm mil)"}),
        {},
        "its unit 'µm mil' is not known",
    ),
    "a speed under another name": (
        lambda frame, _: frame.rename(columns={"speed_rpm": "Speeds"}),
        {},
        "name it speed or speed_rpm or rpm; there are Speeds, B1L_um_pp",
    ),
    "a speed under a name like it": (
        lambda frame, _: frame.rename(columns={"speed_rpm": "Speeds"}),
        {},
        "does 'Speeds' hold it?",
    ),
    "one column alone": (lambda frame, _: frame["speed_rpm"], {}, "a data frame or a mapping of columns, not Series"),
    "numbers for columns": (lambda _f, _: {"speed_rpm": 1.0}, {}, "column 'speed_rpm' is a float: give a list of numbers"),
    "several numbers a row": (
        lambda frame, _: {**frame, "B1L_um_pp": np.ones((len(frame), 2))},
        {},
        "column 'B1L_um_pp', row 1: '[1. 1.]' is not a number",
    ),
    "truth values": (lambda frame, _: frame.assign(B1L_um_pp=True), {}, "column 'B1L_um_pp', row 1: 'True' is not a number"),
    "times of day": (
        lambda frame, _: frame.assign(time="04:00:00 PM"),
        {},
        "row 1: '04:00:00 PM' is not a number: write seconds since the start, or dates and times such as 2025-01-01 00:00:00",
    ),
    "a date among others that is none": (
        lambda frame, _: frame.assign(time=["2026-11-27 04:00:00", "soon", *dates(len(frame))[2:]]),
        {},
        "column 'time', row 2: 'soon' is no date and time such as 2025-01-01 00:00:00",
    ),
    "a time zone in some rows": (
        lambda frame, _: frame.assign(time=["2026-11-27 04:00:00Z", *dates(len(frame))[1:]]),
        {},
        "column 'time': '2026-11-27 04:00:00+00:00' has a time zone and '2026-11-27 04:00:02' has none: write it in all",
    ),
    "one time throughout": (
        lambda frame, _: frame.assign(time="2026-11-27 04:00:00"),
        {},
        "all times are the same, 0 s: give those of the samples, or leave the column out",
    ),
    "times that go backwards": (
        lambda frame, _: frame.assign(time=3.0 * np.arange(len(frame))[::-1]),
        {},
        "s in row 2: put the rows in order of time, or leave the column out",
    ),
    "another unit in brackets": (
        lambda frame, _: frame.rename(columns={"B1L_um_pp": "B1L Amplitude (mil pp)"}),
        {},
        "column 'B1L Amplitude (mil pp)' is in mil, but amplitude_unit says um",
    ),
    "one column in two letter cases": (
        lambda frame, _: frame.assign(b1l_um_pp=1.0),
        {},
        "columns 'B1L_um_pp' and 'b1l_um_pp' are both 'B1L_um_pp': which one counts?",
    ),
    "amplitudes under other names": (
        lambda frame, _: frame.rename(columns=lambda name: name.replace("_um_pp", " displ")),
        {},
        "; does 'B1L displ' or 'B1R displ' or 'B2L displ' hold one?",
    ),
    "words among a channel's numbers": (
        lambda frame, _: frame.assign(B1L_um_pp="low"),
        {},
        "column 'B1L_um_pp', row 1: 'low' is not a number",
    ),
    "two names of one column": (
        lambda frame, _: frame.assign(B1L_amplitude=frame["B1L_um_pp"]),
        {},
        "columns 'B1L_amplitude' and 'B1L_um_pp' hold the amplitude of B1L: which one counts?",
    ),
    "two times": (
        lambda frame, _: frame.assign(time=dates(len(frame)), time_s=2.0 * np.arange(len(frame))),
        {},
        "columns 'time' and 'time_s' hold the time: which one counts?",
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


def spoken(name: str) -> str:
    """Return a column's name as instruments write it."""
    if name == "speed_rpm":
        return "Speed [RPM]"
    ends = {"_um_pp": " Amplitude (µm pk-pk)", "_lag_deg": " Phase [° lag]"}
    return next(name.replace(end, words) for end, words in ends.items() if name.endswith(end))


TAKEN: dict[str, Callable[[Any], Any]] = {
    "names in capitals with spaces": in_capitals,
    "missing values of pandas": lambda frame: frame.astype("Float64"),
    "numbers as text": lambda frame: frame.astype(str),
    "the speed with its unit as index": lambda frame: frame.set_index("speed_rpm").rename_axis("Speed [rpm]"),
    "dates in a column without a name": lambda frame: dated(frame).rename_axis("Unnamed: 0").reset_index(),
    "dates as texts in a column without a name": lambda frame: frame.assign(**{"Unnamed: 0": dates(len(frame))}),
    "row numbers in a column without a name": lambda frame: frame.assign(**{"Unnamed: 0": np.arange(len(frame)) + 1}),
    "rows numbered by an index of some name": lambda frame: frame.rename_axis("sample"),
    "the speed as index": lambda frame: frame.set_index("speed_rpm"),
    "dates as index": dated,
    "dates with a zone": lambda frame: dated(frame, "Europe/Berlin"),
    "dates as a column": lambda frame: dated(frame).rename_axis("time").reset_index(),
    "dates as texts of ISO 8601": lambda frame: frame.assign(time=dates(len(frame))),
    "dates as texts with spaces and zones": lambda frame: frame.assign(
        time=[f"{one.replace('T', ' ')}.000+01:00" for one in dates(len(frame))]
    ),
    "dates as objects of Python": lambda frame: frame.assign(
        Time=pd.Series([datetime.fromisoformat(f"{one}Z") for one in dates(len(frame))], dtype=object)
    ),
    "dates in a mapping": lambda frame: {**frame, "time": list(map(datetime.fromisoformat, dates(len(frame))))},
    "dates of numpy in a mapping": lambda frame: {**frame, "time": [np.datetime64(one) for one in dates(len(frame))]},
    "times with their unit in the header": lambda frame: frame.assign(**{"Time [s]": 2.0 * np.arange(len(frame))}),
    "names in small letters": lambda frame: frame.rename(columns=str.lower),
    "units in brackets": lambda frame: frame.rename(columns=spoken),
    "durations as index": lambda frame: frame.set_index(pd.timedelta_range(0, periods=len(frame), freq="2s")),
    "the time as index": lambda frame: frame.set_index(pd.Index(2.0 * np.arange(len(frame)), name="time_s")),
}


@pytest.mark.parametrize("name", TAKEN)
def test_a_frame_is_taken_as_people_have_it(pump: Machine, run: rd.MachineRun, name: str) -> None:
    read = rd.read_run(TAKEN[name](untimed(run)), machine=pump)
    assert read.speed_rpm == pytest.approx(run.speed_rpm, rel=1e-4)
    assert read.amplitude_um_pp == pytest.approx(run.amplitude_um_pp, rel=2e-3)
    assert (read.recorded.time is not None) is any(word in name for word in ("dates", "durations", "time"))
    assert read.left_out == ()
    if read.recorded.time is not None:
        assert read.interval_s == pytest.approx(2.0)


def test_a_missing_value_of_pandas_is_none(pump: Machine, run: rd.MachineRun) -> None:
    frame = run.to_frame().astype("Float64")
    frame.loc[3, "B1L_um_pp"] = pd.NA
    assert np.argwhere(np.isnan(rd.read_run(frame, machine=pump).amplitude_um_pp)).tolist() == [[3, 0]]


def test_phases_without_amplitudes_are_named(pump: Machine, run: rd.MachineRun) -> None:
    (said,) = rd.read_run(run.to_frame().drop(columns="B1L_um_pp"), machine=pump).left_out
    assert said.startswith("run, column 'B1L_lag_deg' left out: no column holds the amplitude, B1L_amplitude or B1L_um_pp")


def test_columns_without_a_name_that_do_not_number_rows_are_told(pump: Machine, run: rd.MachineRun) -> None:
    frame = untimed(run)
    unnamed = frame.assign(**{"Unnamed: 0": 3.0 * np.arange(len(frame))})
    (said,) = rd.read_run(unnamed, machine=pump).left_out
    assert said == "run, column 'Unnamed: 0' left out: of no channel of 'motor-pump'"
    seconds = pd.Index(1e3 * np.arange(len(frame)), name="Time [ms]")
    (said,) = rd.read_run(frame.set_index(seconds), machine=pump).left_out
    assert "column 'Time [ms]' left out: of no channel of 'motor-pump'; where 'Time [ms]' holds the times, name it" in said


def test_dates_of_an_index_go_through_a_file(pump: Machine, run: rd.MachineRun, tmp_path: Path) -> None:
    file = tmp_path / "run.csv"
    dated(untimed(run)).to_csv(file)
    for read in (rd.read_run(file, machine=pump), rd.read_run(pd.read_csv(file), machine=pump)):
        assert read.interval_s == pytest.approx(2.0)
        assert read.left_out == ()
    untimed(run).to_csv(file)
    read = rd.read_run(file, machine=pump)
    assert (read.recorded.time, read.left_out) == (None, ())


def test_a_column_of_another_kind_beside_that_of_a_channel_is_left_out(pump: Machine, run: rd.MachineRun) -> None:
    (said,) = rd.read_run(run.to_frame().assign(**{"B1L Amplitude (overall)": 1.0}), machine=pump).left_out
    assert said == "run, column 'B1L Amplitude (overall)' left out: of no channel of 'motor-pump'"
