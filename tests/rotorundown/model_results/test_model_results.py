"""Results of a model: in the units of plants, for one speed or several, as tables, as data frames, and in notebooks."""

import functools
import re
from collections.abc import Callable
from decimal import Decimal
from typing import Any

import numpy as np
import pandas
import pytest

import rotorundown as rd
from estimator.balancing.model_balancing import balance
from estimator.machine.document import Machine
from estimator.updated_model.coupling_loads import coupling_forces
from estimator.updated_model.forced_response import forced_response
from estimator.updated_model.modal_uncertainty import modes_at, natural_frequency_errors
from rotorundown.model_results.residual_unbalance import WrongGrade
from rotorundown.model_results.result_tables import ResultTable, figure
from rotorundown.model_results.speeds import WrongSpeed, speeds_in_rpm
from tests.rotorundown.wrong_input import one_line

SCREEN_LINES, SCREEN_COLUMNS = 40, 100
RAD_PER_S = np.pi / 30
AT_SPEEDS: dict[str, Callable[[rd.Model, Any], ResultTable]] = {
    "modes": rd.Model.modes,
    "response": rd.Model.response,
    "coupling_loads": rd.Model.coupling_loads,
    "balance_grades": rd.Model.balance_grades,
    "balance": rd.Model.balance,
}


@pytest.fixture(scope="module")
def model(result: rd.Result) -> rd.Model:
    return rd.model(result)


def with_unbalances(machine: Machine) -> Machine:
    """Return the machine with an unbalance that its document states for each disc."""
    said = machine.model_dump()
    for disc in said["discs"]:
        disc["unbalance"] = {"magnitude": 1e-5, "angle_deg": 30.0}
    return rd.read_machine(said)


def test_stated_unbalances_move_the_model_of_a_document(pump: Machine) -> None:
    found = rd.model(with_unbalances(pump)).balance(2980)
    assert [one.g_mm for one in found] == pytest.approx([10.0] * len(pump.discs), rel=1e-6)
    assert [one.angle_deg for one in found] == pytest.approx([210.0] * len(pump.discs), abs=1e-3)


@functools.cache
def tables(model: rd.Model, speed: Any) -> list[ResultTable]:
    return [model.critical_speeds(), model.campbell(), *(compute(model, speed) for compute in AT_SPEEDS.values())]


def test_critical_speeds_are_where_the_diagram_crosses(model: rd.Model) -> None:
    found = model.critical_speeds()
    speeds = [one.speed_rpm for one in found]
    assert speeds == sorted(speeds)
    assert model.campbell().critical_speed_rpm == pytest.approx(speeds)
    for speed in speeds:
        assert min(abs(one.frequency_cpm - speed) for one in model.modes(speed)) < 1e-6 * speed
    assert [one.speed for one in found.si] == pytest.approx([one * RAD_PER_S for one in speeds])
    assert all(0.0 < one.standard_error_rpm < 50.0 for one in found)
    assert found[0].damping_ratio == found.si[0].damping_ratio


def test_the_campbell_diagram_is_in_cycles_per_minute(model: rd.Model) -> None:
    found = model.campbell()
    frame = found.to_frame()
    first = frame[frame["mode"] == 1]
    assert list(first["speed_rpm"]) == list(found.speed_rpm)
    assert found.speed_rpm[-1] == pytest.approx(1.25 * 3600.0)
    assert list(first["frequency_cpm"] * RAD_PER_S) == pytest.approx(list(found.si.frequency[:, 0]))
    assert list(frame.columns) == ["mode", "speed_rpm", "frequency_cpm", "damping_ratio", "log_decrement", "whirl"]


def test_modes_are_those_at_the_speed(model: rd.Model) -> None:
    found = model.modes([0, 2980])
    (standstill, turning), speed = found.si, 2980 * RAD_PER_S
    own = [one for one in found if one.speed_rpm == 2980.0]
    assert len(own) == turning.eigenvalue.size
    assert len(found) == len(own) + standstill.eigenvalue.size
    own_modes = modes_at(model.updated, speed=speed)
    assert own[2].frequency_cpm * RAD_PER_S == pytest.approx(own_modes.eigenvalue[2].imag)
    error = natural_frequency_errors(model.updated, own_modes, speed=speed)[2]
    assert own[2].standard_error_cpm * RAD_PER_S == pytest.approx(error)
    diagram = {one.mode: one for one in own}
    at_last = rd.Model.modes(model, model.campbell().speed_rpm[-1])
    assert [one.whirl for one in at_last[:4]] == pytest.approx(list(model.campbell().si.whirl[-1, :4]), abs=1e-6)
    assert diagram[1].mode == 1


def test_the_response_is_as_runs_have_it(model: rd.Model, run: rd.MachineRun) -> None:
    found = model.response(run.speed_rpm)
    assert found.amplitude_um_pp.shape == run.amplitude_um_pp.shape
    high = run.amplitude_um_pp > 5.0
    assert found.amplitude_um_pp[high] == pytest.approx(run.amplitude_um_pp[high], rel=0.3)
    late = (found.phase_lag_deg - run.phase_lag_deg + 180.0) % 360.0 - 180.0
    assert np.median(np.abs(late[high])) < 3.0
    assert np.all(found.lower_um_pp <= found.upper_um_pp)
    frame, given = found.to_frame(), run.to_frame()
    assert {name for name in given.columns if name.endswith(("_um_pp", "_lag_deg"))} <= set(frame.columns)
    assert list(frame["speed_rpm"]) == list(run.speed_rpm)
    assert list(frame["B1L_upper_um_pp"]) == list(found.upper_um_pp[:, 0])


def test_loads_are_the_estimators(model: rd.Model) -> None:
    found = model.coupling_loads(2980)
    (own,) = coupling_forces(model.updated, speed=np.array([2980 * RAD_PER_S]))
    force_x = found[0]
    assert (force_x.coupling, force_x.load, force_x.unit) == ("C1", "force_x", "N")
    assert force_x.amplitude == own.force_x.amplitude[0]
    assert force_x.lag_deg == pytest.approx(-np.degrees(own.force_x.phase[0]) % 360.0)
    assert [one.unit for one in found] == ["N", "N", "N m", "N m", "N", "N m"]


def test_residual_unbalance_is_in_gram_millimetres(model: rd.Model, pump: Machine) -> None:
    found = model.balance_grades([1490, 2980], grade=6.3)
    assert len(found) == 2 * 2 * len(pump.shafts)
    first, plane = found[0], found.si[0][0].planes[0]
    assert (first.speed_rpm, first.shaft, first.bearing) == (1490.0, "motor", "B1")
    assert first.g_mm == pytest.approx(1e6 * abs(plane.unbalance))
    assert first.angle_deg == pytest.approx(np.degrees(np.angle(plane.unbalance)) % 360.0)
    assert found[4].iso_permissible_g_mm == pytest.approx(first.iso_permissible_g_mm / 2)
    assert {one.iso_21940_11 for one in found} <= {"met", "not met", "open"}


def test_a_correction_leaves_less(model: rd.Model, pump: Machine) -> None:
    found = model.balance([1500, 2980])
    own = balance(model.updated, planes=[one.id for one in pump.discs], speed=np.array([1500, 2980]) * RAD_PER_S)
    assert [one.g_mm for one in found] == pytest.approx(list(1e6 * np.abs(own.unbalance)))
    assert [one.angle_deg for one in found] == pytest.approx(list(np.degrees(np.angle(own.unbalance)) % 360.0))
    assert np.max(found.after.amplitude_um_pp) < np.max(found.before.amplitude_um_pp)
    before = forced_response(model.updated, speed=np.array([2980 * RAD_PER_S])).phasor[0]
    assert found.before.amplitude_um_pp[1] == pytest.approx(2e6 * np.abs(before))
    assert [one.disc for one in model.balance(2980, planes="core-1")] == ["core-1"]


@pytest.mark.parametrize("speed", [pytest.param(2980, marks=pytest.mark.long), range(300, 3600, 100)])
def test_each_fits_a_screen(model: rd.Model, speed: Any) -> None:
    for table in tables(model, speed):
        lines = str(table).splitlines()
        assert len(lines) <= SCREEN_LINES
        assert max(map(len, lines)) <= SCREEN_COLUMNS
        assert lines[0].startswith("motor-pump: ")
        assert repr(table) == str(table)
        assert not re.search(r"\de[+-]\d", str(table)), "no power of ten"


def test_what_is_not_printed_is_in_the_frame(model: rd.Model) -> None:
    loads = model.coupling_loads(range(300, 3600, 100))
    assert str(loads).endswith(f"and {len(loads) - 30} more: to_frame()")
    assert len(loads.to_frame()) == len(loads)
    assert len(str(model.modes(2980)).splitlines()) < len(model.modes(2980))
    assert figure(1e-9) == "<0.001"
    assert figure(123456.0) == "123000"


def test_rows_are_a_sequence(model: rd.Model) -> None:
    found = model.critical_speeds()
    assert list(found) == [found[place] for place in range(len(found))]
    assert found[:2] == found.rows[:2]
    assert list(found.to_frame().columns)[:2] == ["speed_rpm", "standard_error_rpm"]


def test_a_notebook_shows_each_escaped(model: rd.Model) -> None:
    for table in [model, *tables(model, 2980)]:
        shown = table._repr_html_()  # type: ignore[attr-defined]
        assert shown.startswith("<pre>motor-pump: ")
    assert "&lt;0.001" in model.balance(2980)._repr_html_()


def test_of_a_document_alone_each_says_that_it_is_nominal(pump: Machine) -> None:
    for table in tables(rd.model(with_unbalances(pump)), 2980):
        assert "Nominal: as the document alone expects, without intervals" in str(table)
    alone = rd.model(rd.read_machine(pump.model_dump(exclude={"discs": {"__all__": {"unbalance"}}})))
    for ask in (alone.response, alone.coupling_loads, alone.balance_grades, alone.balance):
        with pytest.raises(rd.Invalid, match=r"of 'motor-pump' no unbalance is known: identify a run first, or state"):
            ask(2980)
    assert len(alone.critical_speeds()) > 0
    assert {one.standard_error_rpm for one in rd.model(pump).critical_speeds()} == {0.0}


def test_of_an_identified_machine_none_is_nominal(model: rd.Model) -> None:
    assert all("Nominal" not in str(table) for table in tables(model, 2980))


def test_a_train_without_couplings_says_so() -> None:
    rotor = with_unbalances(rd.read_machine("examples/rk4-rotor-kit-four-probes.yaml"))
    assert str(rd.model(rotor).coupling_loads(1000)).endswith("  none")


def test_speeds_are_taken_as_people_have_them() -> None:
    several = (
        [1500, 2980.0],
        (1500.0, 2980.0),
        np.array([1500, 2980]),
        pandas.Series([1500.0, 2980.0]),
        (one for one in [1500, 2980]),
    )
    for given in several:
        assert list(speeds_in_rpm(given, "modes")) == [1500.0, 2980.0]
    for single in (2980, 2980.0, np.float64(2980), np.array(2980.0), Decimal(2980)):
        assert list(speeds_in_rpm(single, "modes")) == [2980.0]  # type: ignore[arg-type]


@pytest.mark.parametrize("name", AT_SPEEDS)
@pytest.mark.parametrize(
    "wrong", ["2980", -5, float("nan"), float("inf"), [], [1500, "a"], None, True, {"speed": 1}, [[1.0]], 3j, [1500, -1]]
)
def test_wrong_speeds_are_told_what_is_right(pump: Machine, name: str, wrong: Any) -> None:
    with pytest.raises(WrongSpeed, match=r"need speeds (above 0|from 0 up) in r/min, such as 2980\.0 or \[1500") as raised:
        AT_SPEEDS[name](rd.model(pump), wrong)
    one_line(raised)


@pytest.mark.parametrize("name", AT_SPEEDS)
def test_only_modes_are_known_of_standstill(pump: Machine, name: str) -> None:
    if name == "modes":
        assert len(AT_SPEEDS[name](rd.model(pump), 0).to_frame())
        return
    with pytest.raises(WrongSpeed, match="above 0 in r/min"):
        AT_SPEEDS[name](rd.model(pump), [0.0, 1500.0])


@pytest.mark.parametrize(
    ("planes", "words"),
    [
        (["core"], "'core' is no disc of 'motor-pump'; there are core-1, .*; did you mean 'core-"),
        ([], "no plane is named; there are core-1"),
        (["core-1", "core-1"], "plane 'core-1' is named twice"),
        (7, "planes are ids of discs, not 7; there are core-1"),
        ([7], "'7' is no disc of 'motor-pump'"),
    ],
)
def test_wrong_planes_are_told_what_is_right(pump: Machine, planes: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words) as raised:
        rd.model(pump).balance(2980, planes=planes)
    one_line(raised)


@pytest.mark.parametrize("grade", [0, -2.5, "2.5", None, float("nan"), True])
def test_wrong_grades_are_told_what_is_right(pump: Machine, grade: Any) -> None:
    with pytest.raises(WrongGrade, match=r"grade is a balance quality grade G above 0 \[mm/s\], such as 2\.5, not") as raised:
        rd.model(pump).balance_grades(2980, grade=grade)
    one_line(raised)
