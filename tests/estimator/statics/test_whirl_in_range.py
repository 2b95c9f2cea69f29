"""Documents of trains that would whirl or touch within their own speed range: said with the speed, and what to look at."""

from typing import Any

import pytest
import yaml

from estimator.machine.document import parse_machine
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.modal_reduction import SMALL
from estimator.statics.whirl_in_range import touching_words, whirl_words
from tests.paths import EXAMPLES


def document(name: str) -> dict[str, Any]:
    """An example of a machine document."""
    said: dict[str, Any] = yaml.safe_load((EXAMPLES / f"{name}.yaml").read_text(encoding="utf-8"))
    return said


def test_a_train_that_is_run_too_fast_for_its_films_would_whirl() -> None:
    said = document("motor-compressor")
    assert whirl_words(parse_machine(said)) == ""
    said["speed_range"]["maximum_rpm"] = 6000
    words = whirl_words(parse_machine(said))
    rpm = float(words.partition("whirl from ")[2].partition(" r/min")[0])
    assert 4600.0 < rpm < 5600.0
    assert "within its speed range up to 6000 r/min" in words


@pytest.mark.parametrize("parts", [2, 3])
def test_a_finer_mesh_whirls_from_the_same_speed(parts: int) -> None:
    """Of many elements only the modes are kept, which plain films have no pads beside."""
    said = document("motor-compressor")
    said["speed_range"]["maximum_rpm"] = 6000
    coarse = whirl_words(parse_machine(said))
    for shaft in said["shafts"]:
        whole = shaft["sections"]
        shaft["sections"] = [{**one, "length": one["length"] / parts} for one in whole for _ in range(parts)]
    fine = parse_machine(said)
    assert (assemble_rotor(fine).size > SMALL) is (parts == 3)
    assert whirl_words(fine) == coarse


def test_a_mode_that_grows_by_cross_coupled_stiffness_is_said() -> None:
    said = document("thesis-chapter-3")
    assert whirl_words(parse_machine(said)) == ""
    for bearing in said["bearings"]:
        bearing["kxy"], bearing["kyx"] = 3.0 * bearing["kxx"], -3.0 * bearing["kxx"]
    assert "a mode would grow (damping ratio -" in whirl_words(parse_machine(said))


@pytest.mark.parametrize("linear", [1, 4])
@pytest.mark.parametrize("factor", [1.0, 4.0, 10.0])
def test_cross_coupled_stiffness_far_above_the_direct_is_said_however_large(factor: float, linear: int) -> None:
    """The larger it is, the higher the frequency of the mode that grows: beyond ten times the speed in the end."""
    said = document("motor-compressor")
    for bearing in said["bearings"][:linear]:
        del bearing["film"], bearing["speed_dependence"]
        bearing |= {
            "kxx": 5e7,
            "kyy": 5e7,
            "kxy": factor * 5e7,
            "kyx": -factor * 5e7,
            "cxx": 3e4,
            "cyy": 3e4,
            "cxy": 0,
            "cyx": 0,
        }
    words = whirl_words(parse_machine(said))
    assert "would grow (damping ratio -0." in words or "would whirl from" in words


def test_a_makers_table_is_judged_by_its_values_at_the_highest_speed() -> None:
    said = document("thesis-chapter-3")
    speeds = [300.0, 1200.0, 2100.0, 3000.0, 3600.0]
    for bearing in said["bearings"]:
        direct = bearing["kxx"]
        grows = [0.0, 0.0, 0.0, 0.0, 3.0 * direct]
        bearing["speed_dependence"] = {"form": "table", "speed_rpm": speeds, "kxy": grows, "kyx": [-one for one in grows]}
        del bearing["kxy"], bearing["kyx"]
    assert "a mode would grow (damping ratio -" in whirl_words(parse_machine(said))
    for bearing in said["bearings"]:
        bearing["speed_dependence"] |= {"kxy": [0.0] * 5, "kyx": [0.0] * 5}
    assert whirl_words(parse_machine(said)) == ""


@pytest.mark.parametrize("name", ["motor-pump", "sealed-pump", "rk4-rotor-kit", "turbine-compressor-generator"])
def test_examples_would_not(name: str) -> None:
    assert whirl_words(parse_machine(document(name))) == ""


def test_films_that_do_not_carry_are_said_with_the_bearing_that_carries_most() -> None:
    said = document("motor-compressor")
    assert touching_words(parse_machine(said)) == ""
    said["static_loads"] = [{"id": "gear", "shaft": "S2", "station": 1.46, "force_y": -2.0e6}]
    words = touching_words(parse_machine(said))
    assert "r/min a journal would be within a twentieth of the clearance" in words
    assert "on bearing 'B4', whose journal touches first, at rest are" in words
    assert touching_words(parse_machine(document("thesis-chapter-3"))) == ""


def test_the_bearing_that_touches_first_is_named_and_not_that_of_the_highest_pressure() -> None:
    """A thin oil lets the less loaded journal down."""
    said = document("motor-compressor")
    said["speed_range"]["minimum_rpm"] = 100
    said["bearings"][2]["film"]["oil"]["viscosity"] = 0.001
    words = touching_words(parse_machine(said))
    assert "on bearing 'B3', whose journal touches first, at rest are" in words


@pytest.mark.parametrize("rpm", [4600.0, 5000.0])
def test_films_that_carry_at_no_speed_of_the_range_are_said(rpm: float) -> None:
    said = document("motor-compressor")
    said["bearings"][1]["film"]["valid_above_rpm"] = rpm
    assert touching_words(parse_machine(said)).startswith(f"valid_above_rpm of a film is {rpm:.0f} r/min")
