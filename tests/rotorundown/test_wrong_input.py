"""Wrong input is named in one line that says what would be right, in Python and by command."""

import re
import shutil
from collections.abc import Callable
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import rotorundown as rd
from estimator.machine.document import DocumentError, Machine
from rotorundown.identification import NothingToIdentify
from rotorundown.machine_files import WrongMachine
from rotorundown.run_columns import WrongRun
from service.commands.app import app
from tests.paths import EXAMPLES

PUMP = EXAMPLES / "motor-pump.yaml"


def one_line(raised: pytest.ExceptionInfo[Any]) -> str:
    """The message of an error, which is one line."""
    assert "\n" not in str(raised.value)
    return str(raised.value)


def test_what_was_not_read_is_told_how_to_read_it(pump: Machine, run: rd.MachineRun) -> None:
    wrong: Any
    for wrong in (run.to_frame(), "run.csv", [run.to_frame()]):
        with pytest.raises(NothingToIdentify, match=r"read it first, with read_run\(…, machine=…\)") as raised:
            rd.identify(pump, wrong)
        one_line(raised)
    swapped: tuple[Any, Any] = (run, pump)
    with pytest.raises(NothingToIdentify, match=r"the machine comes first, identify\(machine, run\)") as raised:
        rd.identify(*swapped)
    one_line(raised)
    unread: Any = str(PUMP)
    with pytest.raises(NothingToIdentify, match=r"the machine is a str: read it first, with read_machine\(…\)"):
        rd.identify(unread, run)
    with pytest.raises(WrongRun, match=r"machine is a str: read it first, with read_machine\(…\)"):
        rd.read_run(run.to_frame(), machine=unread)


def test_a_run_of_another_machine_is_refused(run: rd.MachineRun) -> None:
    with pytest.raises(NothingToIdentify, match=r"has the channels B1L.* 'thesis-chapter-3' has B1X") as raised:
        rd.identify(rd.read_machine(EXAMPLES / "thesis-chapter-3.yaml"), run)
    one_line(raised)


def test_a_column_of_no_channel_is_left_out_and_named(pump: Machine, run: rd.MachineRun) -> None:
    frame = run.to_frame()
    read = rd.read_run(frame.assign(B9L_um_pp=frame["B1L_um_pp"]), machine=pump)
    (said,) = read.left_out
    assert "column 'B9L_um_pp' left out: 'B9L' is no channel of 'motor-pump'; did you mean" in said


def test_a_contradiction_of_a_machine_is_one_line(pump: Machine) -> None:
    said = pump.model_dump()
    said["couplings"] = [{**one, "driven": "nobody"} for one in said["couplings"]]
    with pytest.raises(WrongMachine, match=r"couplings\[0\].driven: 'nobody' is not one of the shafts: motor, pump") as raised:
        rd.read_machine(said)
    one_line(raised)
    with pytest.raises(DocumentError, match=r"^couplings\[0\].driven: 'nobody' is not one of the shafts: motor") as directly:
        rd.Machine(**said)
    one_line(directly)


def test_a_machine_is_not_made_of_a_document_in_its_place(pump: Machine) -> None:
    made: Any = rd.Machine
    for given in ({}, pump.model_dump(), "pump.yaml"):
        with pytest.raises(DocumentError, match=r"takes fields by name; documents are read by read_machine") as raised:
            made(given)
        one_line(raised)


WRONG_FIELDS: dict[str, tuple[Callable[[Any], Any], str]] = {
    "of the document": (
        lambda said: said.update(rotatoin="positive"),
        "rotatoin: there is no such field; did you mean 'rotation'",
    ),
    "of a part": (
        lambda said: said["shafts"][0]["sections"][0].update(lenght=1.0),
        "shafts[0].sections[0].lenght: there is no such field; did you mean 'length'?",
    ),
    "of a named part": (lambda said: said["materials"]["steel"].update(densty=1.0), "did you mean 'density'"),
    "that is no list": (lambda said: said.update(shafts=3), "shafts: should be a list"),
    "that has no names": (lambda said: said.update(materials=["steel"]), "materials: should be fields by name"),
    "like none": (lambda said: said["speed_range"].update(z=1), "there is no such field: there are maximum_rpm, minimum_rpm"),
}


@pytest.mark.parametrize("name", WRONG_FIELDS)
def test_an_unknown_field_gets_its_close_matches(pump: Machine, name: str) -> None:
    change, words = WRONG_FIELDS[name]
    said = pump.model_dump(mode="json", exclude_none=True)
    change(said)
    for make in (rd.read_machine, lambda document: rd.Machine(**document)):
        with pytest.raises(ValueError, match=re.escape(words)) as raised:
            make(said)
        one_line(raised)


def doubled(frame: Any) -> Any:
    return frame.set_axis([*frame.columns[:-1], frame.columns[-2]], axis=1)


MISREAD: dict[str, tuple[Callable[[Any, Path], Any], dict[str, Any], str]] = {
    "degrees said to be radians": (
        lambda frame, _: frame,
        {"phase_unit": "rad"},
        "degrees and not radians: say phase_unit='deg'",
    ),
    "a unit that there is not": (
        lambda frame, _: frame.rename(columns={"speed_rpm": "speed"}),
        {"speed_unit": "hz"},
        "speed_unit 'hz' is not one of rpm, rad/s, Hz",
    ),
    "a kind that there is not": (lambda frame, _: frame, {"amplitude_kind": "pp"}, "amplitude_kind 'pp' is not one of peak"),
    "columns of other machines, and many of them": (
        lambda frame, _: frame.rename(columns=lambda name: name.replace("B", "X")),
        {},
        "X2R_lag_deg, X3L_um_pp, X3L_lag_deg, X3R_um_pp and 5 more",
    ),
    "a column twice": (lambda frame, _: doubled(frame), {}, "column 'B4R_um_pp' stands twice"),
    "a column twice in a file": (lambda frame, file: written(file, doubled(frame)), {}, "column 'B4R_um_pp' stands twice"),
    "tabs": (
        lambda frame, file: frame.to_csv(file, sep="\t", index=False) or file,
        {},
        "is separated by tabs: write it with commas",
    ),
    "a folder": (lambda _, file: file.parent, {}, "is a folder: name a file of it"),
    "no text": (
        lambda _, file: file.write_bytes(bytes(range(256))) and file,
        {},
        "is no text in UTF-8: save it as CSV in UTF-8",
    ),
    "an array": (lambda frame, _: frame.to_numpy(), {}, "a data frame or a mapping of columns, not ndarray"),
    "an opened file": (lambda _f, _: StringIO(), {}, "a run is a file's path, not an opened file (StringIO): give its path"),
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
    "revolutions a minute said to be radians": (
        lambda frame, _: frame.rename(columns={"speed_rpm": "speed"}),
        {"speed_unit": "rad/s"},
        "most speeds lie far beyond the range of 'motor-pump' when read in rad/s: are these in rpm? Say so with speed_unit",
    ),
    "metres": (
        lambda frame, _: frame.apply(lambda one: one * 1e-6 if one.name.endswith("_um_pp") else one),
        {},
        "less than any probe resolves: are these in m? Say so with amplitude_unit",
    ),
    "a document": (lambda _f, _: str(PUMP), {}, "is no recording: name the table of the run, such as a CSV file"),
    "a document of its name beside it": (
        lambda frame, file: shutil.copy(PUMP, file.with_suffix(".yaml")) and written(file, frame),
        {},
        "run.yaml is a machine document and not the recording's sidecar: give one of the two another name",
    ),
    "an empty sidecar": (
        lambda frame, file: file.with_suffix(".yaml").write_text("") or written(file, frame),
        {},
        "run.yaml is not a recording's sidecar: it should be fields by name, each with its value",
    ),
    "a spreadsheet": (
        lambda _f, file: file.with_suffix(".xlsx").write_bytes(b"PK") and file.with_suffix(".xlsx"),
        {},
        "run.xlsx is a spreadsheet: save its table as CSV",
    ),
}


@pytest.mark.parametrize("name", MISREAD)
def test_what_cannot_be_a_run_is_one_line(pump: Machine, run: rd.MachineRun, tmp_path: Path, name: str) -> None:
    make, options, words = MISREAD[name]
    with pytest.raises(WrongRun, match=re.escape(words)) as raised:
        rd.read_run(make(run.to_frame(), tmp_path / "run.csv"), machine=pump, **options)
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
    read = rd.read_run(TAKEN[name](run.to_frame()), machine=pump)
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


def test_a_file_that_ends_in_capitals_is_a_table(pump: Machine, run: rd.MachineRun, tmp_path: Path) -> None:
    assert len(rd.read_run(written(tmp_path / "RUN.CSV", run.to_frame()), machine=pump)) == len(run)


def test_a_machine_is_printed_in_a_line(pump: Machine) -> None:
    assert str(pump) == repr(pump) == "motor-pump: 2 shafts, 4 discs, 4 bearings, 1 coupling, 8 probes; 300 to 3600 r/min"


CONTRADICTIONS: dict[str, tuple[Callable[[Machine], dict[str, Any]], str]] = {
    "no bearings": (lambda _: {"bearings": ()}, "bearings: Tuple should have at least 1 item"),
    "an empty range": (
        lambda pump: {"speed_range": pump.speed_range.model_copy(update={"minimum_rpm": 4000.0})},
        "speed_range: minimum_rpm 4000.0 must be below maximum_rpm 3600.0",
    ),
    "a disc on no shaft": (
        lambda pump: {"discs": (pump.discs[0].model_copy(update={"shaft": "moter"}), *pump.discs[1:])},
        "discs[0].shaft: 'moter' is not one of the shafts",
    ),
    "a mass in words": (
        lambda pump: {"discs": (pump.discs[0].model_copy(update={"mass": "heavy"}), *pump.discs[1:])},
        "discs[0].mass: Input should be a valid number",
    ),
}


@pytest.mark.parametrize("name", CONTRADICTIONS)
def test_a_copy_of_a_machine_that_contradicts_itself_is_refused(pump: Machine, run: rd.MachineRun, name: str) -> None:
    change, words = CONTRADICTIONS[name]
    wrong = pump.model_copy(update=change(pump))
    for use in (rd.read_machine, rd.simulate, rd.model, lambda machine: rd.identify(machine, run)):
        with pytest.raises(WrongMachine, match=f"^this is no machine: {re.escape(words)}") as raised:
            use(wrong)
        one_line(raised)


def test_a_decimal_comma_in_a_document_is_named(pump: Machine) -> None:
    said = pump.model_dump()
    said["discs"][0]["mass"] = "220,5"
    with pytest.raises(WrongMachine, match=r"discs\[0\].mass: '220,5' is no number: write it with a decimal point") as raised:
        rd.read_machine(said)
    one_line(raised)


def test_what_is_no_machine_is_one_line(tmp_path: Path) -> None:
    wrong: Any
    for wrong, words in (
        (PUMP.read_text(), "this is the text of a document: give the path of its file"),
        (StringIO(), "not an opened file (StringIO): give its path"),
    ):
        with pytest.raises(WrongMachine, match=re.escape(words)) as raised:
            rd.read_machine(wrong)
        one_line(raised)
    (tmp_path / "tabs.yaml").write_text("id: pump\n\tplant: plant-1\n")
    with pytest.raises(
        WrongMachine, match=r"tabs.yaml, line 2 is neither YAML nor JSON: .* indent with spaces, not with tabs"
    ):
        rd.read_machine(tmp_path / "tabs.yaml")
    for wrong in (None, [1]):
        with pytest.raises(WrongMachine, match="a document's path or its fields by name, not") as raised:
            rd.read_machine(wrong)
        one_line(raised)
    for text in ("", "- 1"):
        (tmp_path / "wrong.yaml").write_text(text)
        with pytest.raises(WrongMachine, match="should be fields by name, each with its value") as raised:
            rd.read_machine(tmp_path / "wrong.yaml")
        one_line(raised)


def test_what_was_not_identified_is_told_so(pump: Machine, run: rd.MachineRun, result: rd.Result) -> None:
    made: Any = rd
    calls: list[tuple[Callable[[], Any], str]] = [
        (lambda: made.compare(pump, run, coupling="C1"), "the baseline is a Machine: identify first"),
        (lambda: made.diagnose(result, [result]), "baseline is one result: give a list of them"),
        (lambda: made.diagnose([result], [run]), "what is in later is a MachineRun: identify first"),
        (lambda: made.diagnose(run, run), "baseline is a MachineRun: give a list of results"),
        (lambda: made.calibrate(pump, [run]), "a recording is a MachineRun: give paths of files"),
        (lambda: made.calibrate(pump, run), "files is a MachineRun: give a list of the recordings"),
        (lambda: made.calibrate(pump, [None]), "a recording is a NoneType: give paths of files"),
        (lambda: made.calibrate(pump, (one for one in ["none.csv"])), "none.csv"),
        (lambda: made.model(None), "the source is a NoneType: identify first"),
        (lambda: made.calibrate(pump, "run.csv"), "files is one path, run.csv: give a list"),
        (lambda: made.simulate(str(PUMP)), "read it first, with read_machine(…)"),
        (
            lambda: made.simulate(pump, scenario="misaligned"),
            "there are healthy, misalignment, unbalance; did you mean 'misalignment'",
        ),
        (lambda: made.simulate(pump, progress=7), "progress 7 is not from 0 to 1"),
        (lambda: made.simulate(pump, samples=0), "a run has 2 samples at least, not 0"),
        (lambda: made.simulate(pump, duration_s=float("nan")), "a run takes some time"),
    ]
    for call, words in calls:
        with pytest.raises(ValueError, match=re.escape(words)) as raised:
            call()
        one_line(raised)
    with pytest.raises(KeyError, match="'3' is not estimated"):
        made.Result.__getitem__(result, 3)


def test_what_cannot_be_simulated_or_drawn_is_one_line(pump: Machine, run: rd.MachineRun, result: rd.Result) -> None:
    made: Any = rd
    calls: list[tuple[Callable[[], Any], str]] = [
        (lambda: made.simulate(pump, samples=2.5), "samples is a whole number, not 2.5"),
        (lambda: made.simulate(pump, seed=-1), "seed is a whole number from 0 up, not -1"),
        (lambda: made.simulate(pump, run_seed="a"), "run_seed is a whole number from 0 up, not 'a'"),
        (lambda: made.simulate(pump, weights={"core-1": 5}), "an amount [g mm] and an angle [°] by disc, such as {'core-1'"),
        (lambda: made.simulate(pump, weights=[("core-1", 5)]), "weights are an amount [g mm] and an angle [°] by disc"),
        (lambda: made.simulate(pump, weights={"core": (5, 0)}), "there is no disc 'core' for a trial weight; did you mean"),
        (lambda: made.plot_trend([], "coupling.C1.kxx"), "a trend is drawn of a list of results of identify"),
        (lambda: made.plot_trend(result, "coupling.C1.kxx"), "a trend is drawn of a list of results of identify"),
        (lambda: made.plot_trend([run], "coupling.C1.kxx"), "a trend is drawn of a list of results of identify"),
        (lambda: result.plot_bode("B1X"), "'B1X' is no channel"),
        (lambda: made.Result.plot_orbit(result, "2980"), "an orbit is drawn at one speed [r/min], such as 2980.0, not '2980'"),
        (lambda: result.plot_orbit(0.0), "an orbit is drawn at one speed [r/min], such as 2980.0, not 0.0"),
        (lambda: made.Service(8080), "'8080' is no address of a service: it is written as http://localhost:8080"),
        (
            lambda: made.identify(pump, run, accepted_rpm=3),
            "accepted_rpm is 3: give the lowest and the highest speed",
        ),
        (lambda: made.identify(pump, run, half_power="x"), "half_power is 'x': "),
    ]
    for call, words in calls:
        with pytest.raises((ValueError, KeyError), match=re.escape(words)) as raised:
            call()
        one_line(raised)


def test_one_channel_may_be_named_without_a_list(result: rd.Result) -> None:
    assert [one.get_title() for one in result.plot_bode("B1L").axes if one.get_title()] == ["B1L"]


def test_a_model_is_printed_in_a_line(pump: Machine) -> None:
    assert str(rd.model(pump)) == repr(rd.model(pump))
    assert str(rd.model(pump)).startswith("motor-pump: model with critical_speeds(), campbell(), plot_campbell()")
    assert all(hasattr(rd.Model, name) for name in re.findall(r"(\w+)\(\)", str(rd.model(pump))))


def invoked(*arguments: str, **environment: str) -> Any:
    """A command's end, in a terminal without colours."""
    return CliRunner().invoke(app, arguments, env={"NO_COLOR": "1", "TERM": "dumb", **environment})


def written(file: Path, frame: Any) -> str:
    """A table as a file without a sidecar."""
    frame.to_csv(file, index=False)
    return str(file)


def test_a_command_reads_a_table_as_the_library_does_and_says_its_units(run: rd.MachineRun, tmp_path: Path) -> None:
    ended = invoked("identify", str(PUMP), written(tmp_path / "plain.csv", run.to_frame()))
    assert ended.exit_code == 0, ended.output
    assert "plain.csv: read as rpm, um peak-to-peak, phase lag in deg" in ended.stderr
    assert "accepted: χ²/dof" in ended.stdout


def in_radians(frame: Any) -> Any:
    return frame.apply(lambda one: np.radians(one) if one.name.endswith("_lag_deg") else one)


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
    assert line.endswith("(to a command: in a sidecar, run.yaml)") is ("_unit" in line)


def test_small_phases_of_a_single_channel_are_degrees_where_somebody_says_so(run: rd.MachineRun, pump: Machine) -> None:
    """A stiff place may turn by a few degrees only; four of them that do are rather in radians."""
    frame = in_radians(run.to_frame())
    one = frame[["speed_rpm", "B2L_um_pp", "B2L_lag_deg"]]
    with pytest.raises(WrongRun, match="looks like radians: say phase_unit='rad', or phase_unit='deg' where they are"):
        rd.read_run(one, machine=pump)
    (line,) = rd.read_run(one, machine=pump, phase_unit="deg").left_out
    assert line.endswith("which looks like radians: taken as degrees, as phase_unit says")
    with pytest.raises(WrongRun, match="which looks like radians: say phase_unit='rad'"):
        rd.read_run(frame, machine=pump, phase_unit="deg")


def test_one_channel_in_radians_among_others_in_degrees_is_named(run: rd.MachineRun, pump: Machine) -> None:
    frame = run.to_frame()
    assert rd.read_run(frame, machine=pump).left_out == ()
    (line,) = rd.read_run(frame.assign(B2L_lag_deg=np.radians(frame["B2L_lag_deg"])), machine=pump).left_out
    assert line.startswith("run, B2L: its phases lie within 4.89, those of others do not")
    assert line.endswith("are they in radians? Write degrees")


def test_an_empty_file_and_one_with_semicolons(run: rd.MachineRun, tmp_path: Path) -> None:
    empty, other = tmp_path / "empty.csv", tmp_path / "semicolons.csv"
    empty.touch()
    run.to_frame().to_csv(other, index=False, sep=";", decimal=",")
    for file, words in (
        (empty, "is empty: the first line names the columns"),
        (other, "write it with commas, and numbers with a decimal point"),
    ):
        ended = invoked("identify", str(PUMP), str(file))
        assert (ended.exit_code, len(ended.stderr.splitlines())) == (1, 1)
        assert words in ended.stderr


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


@pytest.mark.parametrize(
    ("said", "instead", "words"),
    [
        ("phase_unit: deg", "phase_unit: rad", "are degrees and not radians: its sidecar should say phase_unit: deg"),
        ("speed_unit: rpm", "speed_unit: herz", "run.csv: speed_unit 'herz' is not one of rpm, rad/s, Hz"),
    ],
)
def test_a_wrong_unit_of_a_sidecar_is_named_with_its_file(
    pump: Machine, tmp_path: Path, said: str, instead: str, words: str
) -> None:
    run = tmp_path / "run.csv"
    assert CliRunner().invoke(app, ["sample", str(PUMP), str(run)]).exit_code == 0
    sidecar = run.with_suffix(".yaml")
    sidecar.write_text(sidecar.read_text().replace(said, instead))
    with pytest.raises(WrongRun, match=re.escape(words)) as raised:
        rd.read_run(run, machine=pump)
    one_line(raised)
    told = CliRunner().invoke(app, ["identify", str(PUMP), str(run)])
    assert told.exit_code == 1
    (line,) = told.output.splitlines()
    assert words in line
