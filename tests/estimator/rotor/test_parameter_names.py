"""Names and units by the document alone are those that identifications have."""

import numpy as np
import pytest

from estimator.fit.estimates import estimates
from estimator.fit.problem.coordinates import Coordinates
from estimator.machine.document import parse_machine
from estimator.rotor.condensation import condense
from estimator.rotor.parameter_names import (
    change_unit,
    derived_unit,
    derived_units,
    number_as_word,
    parameter_units,
    without_number,
)
from estimator.updated_model.derived_quantities import model_quantities
from tests.estimator.models import rich_document, rich_model


def test_of_a_train_of_everything_parameters_are_named_as_they_are_estimated() -> None:
    machine = parse_machine(rich_document())
    train = condense(machine, speed=np.ones(1), direction=np.ones(1))
    coordinates = Coordinates.of(train, unbalance_scale=1e-3)
    found = estimates(train, coordinates, coordinates.centre, np.full(coordinates.size, 1e-3), None)
    assert parameter_units(machine) == {one.name: one.unit for one in found}


def test_of_a_train_of_everything_all_changes_have_a_unit() -> None:
    machine = parse_machine(rich_document())
    train = condense(machine, speed=np.ones(1), direction=np.ones(1))
    coordinates = Coordinates.of(train, unbalance_scale=1e-3)
    units = parameter_units(machine)
    found = {name: change_unit(name, units) for name in coordinates.names}
    assert None not in found.values()
    for name, unit in found.items():
        assert unit in ("1", units.get(name.removesuffix(".real").removesuffix(".imaginary"))), name
    assert {"1", "N/m", "N s/m", "kg m", "m"} <= set(found.values())


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("bearing.B1.kxx@1500rpm", "1"),
        ("bearing.B1.kxy", "N/m"),
        ("disc.D1.unbalance.imaginary", "kg m"),
        ("probe.A.gain.real", "1"),
        ("probe.A.run_out.imaginary", "m"),
        ("bearing.B9.kxy", None),
    ],
)
def test_changes_are_reported_in(name: str, unit: str | None) -> None:
    assert change_unit(name, {"bearing.B1.kxy": "N/m", "disc.D1.unbalance": "kg m"}) == unit


def test_derived_quantities_are_named_as_they_are_stored() -> None:
    units = derived_units(rich_model().machine)
    found = model_quantities(rich_model(), speed=100.0)
    assert {one.name.partition(".")[0] for one in found} >= {"critical_speed", "damping_ratio", "coupling"}
    for one in found:
        assert units[without_number(one.name)] == one.unit


@pytest.mark.parametrize(
    ("name", "general"),
    [
        ("critical_speed.12", "critical_speed.N"),
        ("critical_speed.0", "critical_speed.0"),
        ("critical_speed.01", "critical_speed.01"),
        ("splitting.1-2", "splitting.M-N"),
        ("splitting.2-1", "splitting.2-1"),
        ("splitting.9-10", "splitting.M-N"),
        ("coupling.C1.misalignment_force", "coupling.C1.misalignment_force"),
    ],
)
def test_numbers_of_critical_speeds_may_be_any(name: str, general: str) -> None:
    assert without_number(name) == general


@pytest.mark.parametrize("name", ["critical_speed.N", "splitting.M-N", "probe.B1X.amplification_factor.N", "coupling.C1.kxx"])
def test_what_stands_for_numbers_is_no_name_of_a_derived_quantity(name: str) -> None:
    assert derived_unit(rich_model().machine, name) is None


def test_every_derived_quantity_is_said_by_a_name_that_it_can_have() -> None:
    machine = rich_model().machine
    for name, unit in derived_units(machine).items():
        assert derived_unit(machine, number_as_word(name).removesuffix(" …")) == unit
    assert number_as_word("critical_speed.N") == "critical_speed.1 …"
