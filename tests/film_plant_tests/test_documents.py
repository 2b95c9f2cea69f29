"""Documents of film plants: they describe the same train, with the forms and errors that are asked for."""

import ast
from dataclasses import replace
from typing import get_args

import numpy as np
import pytest

from estimator.bearings.knots import SpeedDependence
from estimator.machine.document import parse_machine
from estimator.rotor.condensation import condense
from estimator.rotor.response import response as estimated_response
from tests.film_plant.documents import DIRECT, Form, linear_document, linear_machine, measured
from tests.film_plant.plant import Plant
from tests.film_plant.plants import motor_compressor_plant, random_plant
from tests.film_plant.response import response
from tests.paths import PACKAGES, ROOT


@pytest.fixture(scope="module")
def plant() -> Plant:
    """A random one, of which several are drawn until one is stable."""
    return random_plant(3)


def test_a_document_without_errors_answers_as_the_plant_with_constant_films() -> None:
    plant = motor_compressor_plant(0)
    plant = replace(plant, train=replace(plant.train, refinement=1))
    machine = linear_machine(plant, perturbation=0.0, element_length=1.0)
    speed = plant.speeds(20)
    train = condense(machine, speed=speed, direction=np.ones(speed.size))
    nominal = np.array([one.nominal for one in train.unknowns.unbalances], dtype=complex)
    found = estimated_response(
        train, coefficients=np.array([one.expected for one in train.unknowns.coefficients]), excitations=nominal
    )
    films = plant.films(np.array([(plant.slowest + plant.fastest) / 2]))
    stiffness, damping = (np.repeat(one, speed.size, axis=0) for one in (films.stiffness, films.damping))
    due = response(plant.matrices, speed=speed, stiffness=stiffness, damping=damping)
    assert np.abs(found - due).max() < 1e-8 * np.abs(due).max()


@pytest.mark.parametrize("form", get_args(Form)[1:])
def test_forms_are_written_as_they_are_asked_for(plant: Plant, form: Form) -> None:
    some = linear_machine(plant, form=form, knots_rpm=(1000, 2000, 3000))
    every = linear_machine(plant, form=form, knots_rpm=(1000, 2000), terms="all")
    for bearing in some.bearings:
        assert isinstance(bearing.speed_dependence, SpeedDependence)
        assert bearing.speed_dependence.form == form
        assert bearing.speed_dependence.coefficients == DIRECT
    for bearing in every.bearings:
        assert isinstance(bearing.speed_dependence, SpeedDependence)
        assert bearing.speed_dependence.coefficients is None


def test_nominal_values_are_off_by_what_is_asked_for(plant: Plant) -> None:
    exact, *off = (
        linear_document(plant, perturbation=size, seed=seed) for size, seed in [(0.0, 0), *((0.1, k) for k in range(20))]
    )
    ratio = np.log([one["bearings"][k][name] / exact["bearings"][k][name] for one in off for k in range(4) for name in DIRECT])
    assert ratio.std() == pytest.approx(0.1, rel=0.15)
    assert "unbalance" not in linear_document(plant, unbalances_given=False)["discs"][0]
    parse_machine(linear_document(plant, unbalances_given=False))


def test_measurements_are_noisy_and_begin_at_the_highest_speed(plant: Plant) -> None:
    one, other = measured(plant, samples=10, seed=0), measured(plant, samples=10, seed=1)
    assert one.speed[0] == plant.fastest
    clean = plant.phasors(plant.films(one.speed))
    off = np.abs(one.phasor - clean) / np.hypot(0.01 * np.abs(clean), 1e-7)
    assert 0.7 < np.sqrt(np.mean(off**2)) < 1.3
    assert not np.array_equal(one.phasor, other.phasor)


def test_only_the_documents_know_the_estimator() -> None:
    knowing = []
    for path in sorted((ROOT / "tests" / "film_plant").glob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            names = [one.name for one in node.names] if isinstance(node, ast.Import) else []
            names += [str(node.module)] if isinstance(node, ast.ImportFrom) else []
            if any(name.split(".")[0] in PACKAGES for name in names):
                knowing.append(path.name)
    assert set(knowing) == {"documents.py", "scores.py"}
