"""Static loads that a document knows in part: derivatives, an identification on a plant of other make, units and couplings."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from msgspec import structs

from estimator.fit.identification import Options
from estimator.fit.identify import identify
from estimator.machine.document import parse_machine
from estimator.rotor.parameter_names import parameter_units
from estimator.statics.coupling_balance import coupling_balances
from estimator.statics.film_model import film_model
from estimator.updated_model.film_results import film_results
from estimator.updated_model.model import expected_model
from estimator.updated_model.static_coupling_loads import static_coupling_loads
from tests.estimator.statics.test_film_model import SPEED, document, drawn
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, measured
from tests.film_plant.plants import motor_compressor_plant, random_plant
from tests.film_plant.train import Train

FORCE_Y = "static_load.gear.force_y"


def with_force(said: dict[str, Any], **load: float) -> dict[str, Any]:
    """The document with a force on its first disc, known in part."""
    disc = said["discs"][0]
    return said | {"static_loads": [{"id": "gear", "shaft": disc["shaft"], "station": disc["station"], **load}]}


def pressed(train: Train, _: np.random.Generator, __: float) -> Train:
    """The train with half the weight of its first disc pressing on it besides."""
    first = train.discs[0]
    return replace(train, discs=(replace(first, force=(0.0, -0.5 * train.gravity * first.mass)), *train.discs[1:]))


def test_derivatives_by_a_force_are_those_of_differences() -> None:
    machine = parse_machine(with_force(document(discrepancy=0.0), force_y=-500.0, force_x_spread=800.0, force_y_spread=800.0))
    model = film_model(machine)
    curves, fitted = model.at(SPEED), drawn(model, 3)
    names = [one.name for one in model.numbers]
    found, size = curves.derivatives(fitted, slice(None)), np.abs(curves.values(fitted)).max(axis=0)
    for name in ("static_load.gear.force_x", FORCE_Y):
        step = np.zeros(fitted.size)
        step[names.index(name)] = 1e-3
        difference = (curves.values(fitted + step) - curves.values(fitted - step)) / 2e-3
        assert np.abs(difference / size).max() > 1e-2
        np.testing.assert_allclose(found[:, :, names.index(name)] / size, difference / size, atol=2e-4)


def test_a_force_acts_as_one_that_the_document_knows() -> None:
    """A bearing's place does not follow the sag under the force: elevations are told over the aligned train."""
    believed = film_model(parse_machine(with_force(document(discrepancy=0.0), force_y_spread=800.0)))
    names = [one.name for one in believed.numbers]
    fitted = np.array([one.centre for one in believed.numbers])
    fitted[names.index(FORCE_Y)] = 1.5
    changed, said = believed.own.changed(fitted).statics, believed.own.train.statics
    known = film_model(parse_machine(with_force(document(discrepancy=0.0), force_y=1200.0))).own.train.statics
    assert changed.weight - said.weight == pytest.approx(known.weight - said.weight, rel=1e-9, abs=1e-6)
    assert (changed.weight - said.weight)[1::2].sum() == pytest.approx(1200.0, rel=1e-6)


def test_a_force_that_no_document_states_is_found_on_a_plant_of_other_make() -> None:
    plant = random_plant(2, alter=pressed)
    true = -0.5 * plant.train.gravity * plant.train.discs[0].mass
    machine = parse_machine(with_force(film_document(plant), force_y_spread=abs(true)))
    found = identify(machine, measured(plant, seed=2), Options(starts=3))
    assert found.accepted, found.verdict
    force = found.estimate(FORCE_Y)
    assert force.unit == parameter_units(machine)[FORCE_Y] == "N"
    assert force.value is not None, force.reason
    assert force.standard_error is not None
    assert force.standard_error < 0.5 * abs(true)
    assert abs(force.value - true) < 3.0 * force.standard_error


def test_a_force_behind_a_coupling_is_in_its_balance() -> None:
    said = document(discrepancy=0.0)
    disc = said["discs"][-1]
    load = {"id": "gear", "shaft": disc["shaft"], "station": disc["station"], "force_y_spread": 800.0}
    model = expected_model(parse_machine(said | {"static_loads": [load]}))
    values = model.values.copy()
    values[model.coordinates.index(FORCE_Y)] = 900.0
    pushed = structs.replace(model, values=values)
    (balance,) = coupling_balances(model.machine)
    films = {one.name: one.value for one in film_results(pushed)}
    carried = films["bearing.B3.load_vertical"] + films["bearing.B4.load_vertical"]
    found = {one.name: one.value for one in static_coupling_loads(pushed)}
    assert found["coupling.C1.static_shear_vertical"] == pytest.approx(-(balance.weight[1] + 900.0 + carried), rel=1e-9)


def test_coefficients_follow_a_force_that_the_document_calls_exact_as_one_that_may_be_off() -> None:
    exact = film_model(parse_machine(with_force(document(discrepancy=0.0), force_y=-500.0)))
    free = film_model(parse_machine(with_force(document(discrepancy=0.0), force_y=-500.0, force_y_spread=800.0)))
    curves, place = free.at(SPEED), [one.name for one in free.numbers].index(FORCE_Y)
    fitted = np.array([one.centre for one in free.numbers])
    own = exact.at(SPEED).by_load(np.array([one.centre for one in exact.numbers]))
    assert own.shape == (SPEED.size, 32, 2)
    wanted = curves.derivatives(fitted, slice(None))[:, :, place] / 800.0
    np.testing.assert_allclose(own[..., 1], wanted, atol=1e-9 * np.abs(wanted).max())
    assert [name for name, _, _ in free.own.exact_forces] == ["static_load.gear.force_x"]
    assert exact.own.exact_forces[1] == (FORCE_Y, -500.0, 1)


def test_a_force_that_is_stated_exactly_and_wrong_is_refused_with_the_one_that_the_films_want() -> None:
    plant = random_plant(2, discrepancy=DiscrepancySize())
    lifted = 0.5 * plant.train.gravity * plant.train.discs[0].mass
    found = identify(
        parse_machine(with_force(film_document(plant), force_y=lifted)), measured(plant, seed=2), Options(starts=3)
    )
    assert not found.accepted
    assert found.verdict.startswith(f"the oil films want {FORCE_Y} to be about ")
    assert "state how far it may be off (force_y_spread)" in found.verdict
    wanted = float(found.verdict.split("to be about ")[1].split(" N")[0])
    assert abs(wanted) < 0.2 * lifted


def test_a_force_that_is_stated_exactly_and_right_is_accepted() -> None:
    plant = random_plant(2, alter=pressed, discrepancy=DiscrepancySize())
    force = -0.5 * plant.train.gravity * plant.train.discs[0].mass
    found = identify(
        parse_machine(with_force(film_document(plant), force_y=force)), measured(plant, seed=2), Options(starts=3)
    )
    assert found.accepted, found.verdict
    assert "the oil films want" not in found.verdict
    assert f"loads of bearings rest on {FORCE_Y}" in found.verdict
    assert not found.doubted_forces


def test_a_force_that_the_films_doubt_widens_what_follows_from_it() -> None:
    plant = motor_compressor_plant(1, "rigid", discrepancy=DiscrepancySize())
    lifted = 0.5 * plant.train.gravity * plant.train.discs[0].mass
    said = film_document(plant)
    found, right = (
        identify(parse_machine(with_force(said, force_y=force)), measured(plant, seed=901), Options(starts=3))
        for force in (lifted, 0.0)
    )
    assert right.accepted, right.verdict
    if found.accepted:
        assert "intervals are widened" in found.verdict
        assert FORCE_Y in found.verdict
        place = found.coordinates.index("bearing.B1.clearance")
        assert found.covariance[place, place] > 1.5 * right.covariance[place, place]
