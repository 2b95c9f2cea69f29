"""Static loads in couplings: against the deformation of the coupling's springs, the reference arrays, and differences."""

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.machine.document import parse_machine
from estimator.rotor.parameter_names import derived_unit
from estimator.statics.coupling_balance import coupling_balances
from estimator.units import GRAVITY
from estimator.updated_model.film_results import film_results
from estimator.updated_model.model import expected_model
from estimator.updated_model.static_coupling_loads import static_coupling_loads
from tests.estimator.models import rich_model
from tests.estimator.statics.films import motor_compressor_document
from tests.estimator.updated_model.propagation import propagated
from tests.estimator.updated_model.test_alignment_results import before, machine_of
from tests.film_plant.motor_compressor import PARALLEL, CouplingKind, motor_compressor
from tests.paths import DATA

STIFFNESS = 1.2e6
"""Lateral stiffness of the flexible coupling [N/m]."""


@pytest.mark.parametrize("kind", ["flexible", "rigid"])
@pytest.mark.parametrize("case", ["aligned", "parallel_down", "parallel_up", "angle_100urad"])
def test_shear_is_what_the_bearings_of_the_reference_arrays_leave(kind: CouplingKind, case: str) -> None:
    """Running speed is 4600 r/min. The loads of another program, and the weight of the second shaft by hand."""
    found = {one.name: one for one in static_coupling_loads(expected_model(machine_of(kind, case)))}
    train = motor_compressor(kind)
    steel = sum(length * np.pi / 4 * diameter**2 for length, diameter in train.shafts[1].pieces) * train.material.density
    discs = sum(one.mass for one in train.discs if one.shaft == 1)
    weight = GRAVITY * (steel + discs + train.couplings[0].half[0])
    with np.load(DATA / "motor-compressor" / "arrays.npz") as arrays:
        place = int(np.argmax(arrays["speed"]))
        load = arrays[f"{kind}.{case}.load"][place]
    size = 0.01 * load[2:, 1].sum()
    assert found["coupling.C1.static_shear_vertical"].value == pytest.approx(weight - load[2:, 1].sum(), abs=size)
    assert found["coupling.C1.static_shear_horizontal"].value == pytest.approx(-load[2:, 0].sum(), abs=size)


def test_a_raised_shaft_is_pulled_down_by_the_springs_of_a_flexible_coupling() -> None:
    """100 µm of offset pull with what the springs allow: less than they would with all else held."""
    shear = {
        case: static_coupling_loads(expected_model(machine_of("flexible", case)))[1].value
        for case in ("aligned", "parallel_up")
    }
    pull = shear["aligned"] - shear["parallel_up"]
    assert 0.8 * STIFFNESS * PARALLEL["flexible"] < pull < STIFFNESS * PARALLEL["flexible"]


def test_moments_are_about_the_coupling_and_turn_as_angles_do() -> None:
    (one,) = coupling_balances(parse_machine(motor_compressor_document("flexible")))
    assert one.carried.tolist() == [0.0, 0.0, 1.0, 1.0]
    assert one.arm.tolist() == pytest.approx([0.0, 0.0, 0.1, 1.46])
    assert one.weight[0] == one.moment[0] == 0.0
    centre = one.moment[1] / one.weight[1]
    assert 0.6 < centre < 0.95  # the shaft's middle is at 0.78 m, its discs at 0.58 and 0.98 m
    model = expected_model(machine_of("rigid"))
    loads = {found.name: found.value for found in film_results(model)}
    found = {each.name: each.value for each in static_coupling_loads(model)}
    about = 0.1 * loads["bearing.B3.load_vertical"] + 1.46 * loads["bearing.B4.load_vertical"]
    (rigid,) = coupling_balances(model.machine)
    assert found["coupling.C1.static_moment_vertical"] == pytest.approx(-rigid.moment[1] - about)


@pytest.mark.long
def test_errors_are_those_of_differences_and_units_known_by_the_document_alone() -> None:
    believed = before(expected_model(machine_of("rigid")))
    model = replace(believed, covariance=0.01 * believed.covariance)
    found = static_coupling_loads(model)
    expected = np.sqrt(np.diag(propagated(lambda one: np.array([each.value for each in static_coupling_loads(one)]), model)))
    assert [one.error for one in found] == pytest.approx(expected, rel=1e-2)
    assert [derived_unit(model.machine, one.name) for one in found] == [one.unit for one in found]


def test_trains_without_films_have_none() -> None:
    assert static_coupling_loads(rich_model()) == ()
