"""Machines under operating conditions: warmer oil, and forces that grow with the power."""

from typing import Any

import pytest
import yaml

from estimator.machine.document import DocumentError, Machine, parse_machine
from estimator.machine.under_conditions import ConditionImpossible, require_celsius, under_conditions
from estimator.statics.equilibrium import film_train
from estimator.units import rpm_to_rad_per_s
from tests.paths import EXAMPLES

SPEED = rpm_to_rad_per_s(3000.0)


def document(**oil: Any) -> dict[str, Any]:
    """Return the motor and compressor with a gear force, and oil that follows a measured temperature."""
    said: dict[str, Any] = yaml.safe_load((EXAMPLES / "motor-compressor.yaml").read_text(encoding="utf-8"))
    said["conditions"] = [{"name": "oil", "unit": "degC"}, {"name": "power", "unit": "MW"}]
    shaft = said["shafts"][0]["id"]
    said["static_loads"] = [
        {
            "id": "gear",
            "shaft": shaft,
            "station": 0.3,
            "force_x": 100.0,
            "force_y": -400.0,
            "scaled_by": "power",
            "stated_at": 8,
        }
    ]
    for bearing in said["bearings"]:
        bearing["film"]["oil"] = {"iso_vg": 46, "temperature_c": 50.0, "temperature_from": "oil"} | oil
    return said


@pytest.fixture(scope="module")
def machine() -> Machine:
    """The machine of the document."""
    return parse_machine(document())


def test_oil_and_forces_follow_what_was_measured(machine: Machine) -> None:
    found = under_conditions(machine, {"oil": 62.5, "power": 4.0})
    assert [one.film.oil.temperature_c for one in found.bearings if one.film] == [62.5] * 4
    (gear,) = found.static_loads
    assert (gear.force_x, gear.force_y) == (50.0, -200.0)
    written = document(temperature_c=62.5)
    written["static_loads"][0] |= {"force_x": 50.0, "force_y": -200.0}
    assert found.bearings == parse_machine(written).bearings


def test_oil_that_comes_at_a_temperature_follows_it_too() -> None:
    comes = parse_machine(document(temperature_c=None, inlet_c=40.0))
    found = under_conditions(comes, {"oil": 45.0, "power": None})
    assert [one.film.oil.inlet_c for one in found.bearings if one.film] == [45.0] * 4
    assert [one.film.oil.temperature_c for one in found.bearings if one.film] == [None] * 4
    assert found.static_loads == comes.static_loads


def test_the_same_machine_under_the_same_conditions_is_one_object(machine: Machine) -> None:
    found = under_conditions(machine, {"oil": 62.5, "power": 4.0})
    assert under_conditions(machine, {"power": 4.0, "oil": 62.5, "ambient": 20.0}) is found
    assert under_conditions(machine, {"oil": 62.5}) is not found
    assert under_conditions(parse_machine(document()), {"oil": 62.5, "power": 4.0}) is not found


def test_what_was_not_measured_is_as_the_document_says(machine: Machine) -> None:
    assert under_conditions(machine, {}) is machine
    assert under_conditions(machine, {"oil": None, "power": None}) is machine
    assert under_conditions(machine, {"oil": 50.0, "power": 8.0}) is machine


def test_loads_and_positions_are_those_of_a_document_that_states_the_values(machine: Machine) -> None:
    written = document(temperature_c=62.5)
    del written["static_loads"][0]["scaled_by"], written["static_loads"][0]["stated_at"]
    written["static_loads"][0] |= {"force_x": 50.0, "force_y": -200.0}
    found = film_train(under_conditions(machine, {"oil": 62.5, "power": 4.0})).equilibrium(SPEED)
    expected = film_train(parse_machine(written)).equilibrium(SPEED)
    cold = film_train(machine).equilibrium(SPEED)
    assert found is not None
    assert expected is not None
    assert cold is not None
    assert found.force == pytest.approx(expected.force, rel=1e-12)
    assert found.force != pytest.approx(cold.force, rel=1e-3)


def test_a_temperature_that_no_oil_has_is_refused(machine: Machine) -> None:
    with pytest.raises(ConditionImpossible, match="operating condition 'oil' is 850 °C, from which the oil of bearing B1"):
        under_conditions(machine, {"oil": 850.0})


@pytest.mark.parametrize("sent", [95.0, 107.0, 122.0, 140.0])  # 35, 42, 50 and 60 °C
def test_an_oil_temperature_in_fahrenheit_is_named(machine: Machine, sent: float) -> None:
    with pytest.raises(ConditionImpossible, match=r"'oil' is .* where the document states 50 °C .*were °F sent"):
        require_celsius(machine, {"oil": sent})


def test_fahrenheit_is_named_where_the_oil_is_much_colder_than_stated() -> None:
    """53 °C sent as 127 °F, where the document states 78 °C: a standstill in winter, say."""
    with pytest.raises(ConditionImpossible, match=r"were °F sent \(53 °C\)"):
        require_celsius(parse_machine(document(temperature_c=78.0)), {"oil": 127.0})


@pytest.mark.parametrize("sent", [None, 15.0, 40.0, 60.0, 85.0, 150.0, 180.0])
def test_oil_that_is_cold_or_hot_is_not_called_fahrenheit(machine: Machine, sent: float | None) -> None:
    require_celsius(machine, {"oil": sent, "power": 122.0})


@pytest.mark.parametrize(
    ("where", "change", "said"),
    [
        ("oil", {"temperature_from": "air"}, "'air' is not one of the operating conditions: oil, power"),
        ("oil", {"temperature_from": "power"}, "'power' comes in MW; the temperature of an oil must come in degC"),
        ("oil", {"iso_vg": None, "temperature_c": None, "viscosity": 0.02}, "temperature_from needs iso_vg"),
        ("load", {"scaled_by": "torque"}, "'torque' is not one of the operating conditions: oil, power"),
        (
            "load",
            {"stated_at": None},
            "scaled_by, an operating condition, and stated_at, its value for this force, go",
        ),
        ("load", {"stated_at": 0.0}, "stated_at must not be 0"),
    ],
)
def test_what_cannot_be_followed_is_named(where: str, change: dict[str, Any], said: str) -> None:
    written = document()
    changed = written["bearings"][0]["film"]["oil"] if where == "oil" else written["static_loads"][0]
    changed |= change
    with pytest.raises(DocumentError, match=said):
        parse_machine(written)
