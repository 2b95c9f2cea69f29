"""Trains on pedestals with resonances in the range: statics and response of another make, fits with unknown pedestals."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.fit.identification import Options
from estimator.fit.identify import identify
from estimator.machine.document import parse_machine
from estimator.rotor.condensation import condense
from estimator.rotor.response import response
from estimator.statics.equilibrium import film_train
from tests.film_plant.arrays import Floats
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import DAMPING, STIFFNESS, film_document, measured, with_pedestals
from tests.film_plant.plant import Plant
from tests.film_plant.plants import Priors, random_plant
from tests.film_plant.proportions import Design
from tests.film_plant.scores import film_truths, score

PEDESTALS = Design(pedestals=True)
EXACT = Priors(clearance=0.0, viscosity=0.0)


def on_true_films(plant: Plant, names: list[str], speed: Floats) -> Floats:
    """The plant's own coefficients in a machine's order (S, K); zero where it has none [SI]."""
    films, found = plant.films(speed), np.zeros((speed.size, len(names)))
    for number in range(len(plant.train.bearings)):
        both = (
            *films.stiffness.reshape(speed.size, -1, 4)[:, number].T,
            *films.damping.reshape(speed.size, -1, 4)[:, number].T,
        )
        for term, values in zip(STIFFNESS + DAMPING, both, strict=True):
            found[:, names.index(f"bearing.B{number + 1}.{term}")] = values
    return found


@pytest.mark.parametrize("absolute", [False, True])
def test_the_response_is_that_of_the_plant(absolute: bool) -> None:
    plant = replace(random_plant(1, design=PEDESTALS), absolute=absolute)
    machine = parse_machine(with_pedestals(film_document(plant), plant, spread=0.0))
    speed = np.sort(plant.speeds(30))
    train = condense(machine, speed=speed, direction=np.ones(speed.size))
    coefficients = train.unknowns.coefficients
    values = on_true_films(plant, [one.name for one in coefficients], speed)
    ours = ~np.array([one.name.startswith("bearing.") for one in coefficients])
    values[:, ours] = np.array([one.expected for one in coefficients])[ours]
    found = response(train, coefficients=values, excitations=np.array([one.unbalance for one in plant.train.discs]))
    due = plant.phasors(plant.films(speed))
    assert np.abs(found - due).max() < 1e-4 * np.abs(due).max()


def test_loads_are_those_of_the_plant_whose_pedestals_give_way() -> None:
    plant = random_plant(2, design=PEDESTALS, priors=EXACT)
    said = with_pedestals(film_document(plant), plant, spread=0.0)
    for bearing, true, believed in zip(said["bearings"], plant.train.bearings, plant.believed.bearings, strict=True):
        moved = np.subtract(true.elevation, believed.elevation)
        bearing["film"] |= {"elevation_x": float(moved[0]), "elevation_y": float(moved[1])}
    speed = np.sort(plant.speeds(5))
    due = plant.films(speed)
    found = [one for one in film_train(parse_machine(said)).follow(speed) if one is not None]
    loads = np.stack([one.force for one in found])
    assert np.abs(loads - due.load).max() < 1e-3 * np.abs(due.load).max()
    rigid = [
        one for one in film_train(parse_machine(said | {"pedestals": [], "parameters": []})).follow(speed) if one is not None
    ]
    assert np.abs(np.stack([one.force for one in rigid]) - due.load).max() > 3e-3 * np.abs(due.load).max()


def test_unknown_pedestals_with_resonances_in_the_range_are_found() -> None:
    plant = random_plant(4, design=PEDESTALS, discrepancy=DiscrepancySize())
    machine = parse_machine(with_pedestals(film_document(plant), plant, spread=0.2, seed=4))
    found = identify(machine, measured(plant, seed=4), Options(starts=2))
    assert found.accepted, found.verdict
    told = score(found, film_truths(plant))
    assert len(told.inside) > 36
    assert told.coverage > 0.85
    stiffness = found.estimate("pedestal.P1.kxx")
    assert stiffness.unit == "N/m"
    assert stiffness.value == pytest.approx(plant.train.bearings[0].pedestal.stiffness[0], rel=0.1)  # type: ignore[union-attr]
