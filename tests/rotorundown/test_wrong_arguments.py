"""Wrong arguments of the library's functions are named in one line that says what would be right."""

import re
from collections.abc import Callable
from typing import Any

import pytest

import rotorundown as rd
from estimator.machine.document import Machine
from rotorundown.comparison import compared_coupling
from rotorundown.identification import NothingToIdentify
from rotorundown.run_columns import WrongRun
from tests.paths import EXAMPLES
from tests.rotorundown.wrong_input import PUMP, one_line


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


def test_what_was_not_identified_is_told_so(pump: Machine, run: rd.MachineRun, result: rd.Result) -> None:
    made: Any = rd
    calls: list[tuple[Callable[[], Any], str]] = [
        (lambda: made.compare(pump, run, coupling="C1"), "the baseline is a Machine: identify first"),
        (lambda: made.compare(result, "later.csv"), "a later run is a str: read it first, with read_run(…, machine=…)"),
        (lambda: made.compare(result, [run, "later.csv"]), "a later run is a str: read it first"),
        (lambda: made.compare(result, run.to_frame()), "a later run is a DataFrame: read it first"),
        (
            lambda: made.compare(result, result),
            "a later run is a Result: give the runs that it was identified from",
        ),
        (lambda: made.compare(result, []), "no later run is given: compare needs one at least"),
        (lambda: made.compare(result, None), "a later run is a NoneType: read it first"),
        (lambda: made.compare(result, run, coupling=7), "'7' is no coupling of 'motor-pump'; there are C1"),
        (
            lambda: made.diagnose([result], [result], runs_that_agree="a"),
            "runs_that_agree is a whole number from 1",
        ),
        (lambda: made.diagnose([result], [result], runs_that_agree=0), "runs_that_agree is a whole number from 1 up, not 0"),
        (lambda: made.calibrate(str(PUMP), ["run.csv"]), "the machine is a str: read it first, with read_machine(…)"),
        (lambda: made.calibrate(pump, []), "a calibration needs runs"),
        (lambda: made.calibrate(pump, ["run.csv"], seed=-1), "seed is a whole number from 0 up, not -1"),
        (lambda: made.calibrate(pump, ["run.csv"], gain_drift="2"), "gain_drift is a number from 0 up, such as 0.02 for 2 %"),
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
    with pytest.raises(KeyError, match=r"'3' is not estimated; list\(result\) has all names, such as bearing\.B1\.kxx"):
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
        (lambda: made.Result.plot_bode(result, 7), "channels are named by their ids, not by 7; there are B1L, B1R"),
        (lambda: made.Result.plot_polar(result, [7]), "'7' is no channel; there are B1L, B1R"),
        (lambda: made.Result.plot_orbit(result, "2980"), "an orbit is drawn at one speed [r/min], such as 2980.0, not '2980'"),
        (lambda: result.plot_orbit(0.0), "an orbit is drawn at one speed [r/min], such as 2980.0, not 0.0"),
        (lambda: result.plot_orbit(9e4), "90000 r/min lies outside the range of 'motor-pump', 300 to 3600 r/min"),
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


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (
            {"speed_range_rpm": (300,)},
            "the lowest and the highest speed [r/min], such as (300, 3000), not (300,)",
        ),
        ({"speed_range_rpm": 300}, "such as (300, 3000), not 300"),
        ({"speed_range_rpm": ("300", "3000")}, "such as (300, 3000), not ('300', '3000')"),
        ({"probes": "P1"}, 'probes are a list such as [{"id": "B1X", "station": 0.1, "angle_deg": 45}]'),
        ({"probes": [7]}, "probes are a list such as"),
        ({"probes": None}, "probes are a list such as"),
        ({"file": 7}, "file is a int: give the path of what ROSS's Rotor.save wrote"),
    ],
)
def test_a_ross_model_is_read_with_two_speeds_and_a_list_of_probes(wrong: dict[str, Any], words: str) -> None:
    made: Any = rd
    right = {
        "file": "tests/data/ross-rotor.toml",
        "machine": "fan",
        "probes": [{"id": "P1", "station": 0.1, "angle_deg": 45}],
        "speed_range_rpm": (300, 3000),
    }
    with pytest.raises(ValueError, match=re.escape(words)) as raised:
        made.read_ross_model(**(right | wrong))
    one_line(raised)


def test_a_run_of_another_machine_is_not_compared(result: rd.Result) -> None:
    other = rd.simulate(rd.read_machine(EXAMPLES / "thesis-chapter-3.yaml"), samples=10)
    with pytest.raises(ValueError, match=r"has the channels B1X.* 'motor-pump' has B1L.*: read it with") as raised:
        rd.compare(result, other)
    one_line(raised)


def test_several_couplings_are_to_be_told_apart_and_none_has_nothing_to_compare() -> None:
    train = rd.read_machine(EXAMPLES / "turbine-compressor-generator.yaml")
    with pytest.raises(ValueError, match=r"has several couplings, C1, C2: say which one is to be compared"):
        compared_coupling(train, None)
    assert compared_coupling(train, "C2") == "C2"
    assert compared_coupling(rd.read_machine(PUMP), None) == "C1"
    with pytest.raises(ValueError, match="has no coupling to compare"):
        compared_coupling(rd.read_machine(EXAMPLES / "rk4-rotor-kit-four-probes.yaml"), None)


def test_what_is_given_twice_is_named(run: rd.MachineRun, result: rd.Result) -> None:
    with pytest.raises(rd.Invalid, match=r"runs '.+' and '.+' hold the same samples: one is a copy"):
        rd.identify(result.machine, [run, run])
    later = rd.identify(result.machine, rd.simulate(result.machine, run_seed=7))
    with pytest.raises(rd.Invalid, match="hold the same samples"):
        rd.diagnose([result, later], [result])
    with pytest.raises(rd.Invalid, match="baseline has one result: at least two"):
        rd.diagnose([result], [later])


def test_what_leads_nowhere_is_an_invalid(pump: Machine, result: rd.Result, run: rd.MachineRun) -> None:
    other = rd.read_machine(EXAMPLES / "rk4-rotor-kit-four-probes.yaml")
    made: Any = rd
    drawn: Any = result
    for wrong, words in (
        (lambda: made.check("pump.yaml"), "the machine is a str: read it first"),
        (lambda: made.check(pump, None), "one of runs is a NoneType: read it first"),
        (lambda: rd.check(other, run), "has the channels B1L"),
        (lambda: rd.compare(result, result.runs), "hold the same samples: one is a copy"),
        (lambda: drawn.plot_orbit("2980"), "speed"),
        (lambda: result.plot_centreline(), "film"),
        (lambda: rd.plot_trend([result], "coupling.C1.kxx", when=["a", "b"]), "when has 2 times for 1 results"),
        (lambda: rd.Service("x"), "'x' is no address of a service"),
    ):
        with pytest.raises(rd.Invalid, match=words):
            wrong()
