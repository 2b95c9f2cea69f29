"""Tilting pads of the film plant: its tables against tilts found one by one, and an identification of such a plant."""

import numpy as np
import pytest

from estimator.fit.identification import Options
from estimator.fit.identify import identify
from estimator.machine.document import parse_machine
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, measured
from tests.film_plant.plants import random_plant
from tests.film_plant.proportions import Design
from tests.film_plant.scores import film_truths, score
from tests.film_plant.tilting import TILTING, RockerPads, tilted
from tests.film_plant.tilting_table import bearing_table


def test_pads_that_nobody_loads_carry_nothing() -> None:
    pads = RockerPads(4, float(np.radians(80.0)), 0.0, 0.5, -np.pi / 4)
    found = tilted(pads, 0.5, np.array([0.0, -0.5]), around=120)
    assert found.tilt.size == 2  # the lower two
    assert abs(found.force[0]) < 1e-6 < found.force[1]
    z = found.reduced(1.0)
    assert z == pytest.approx(z[0, 0] * np.eye(2), abs=1e-6 * abs(z[0, 0]))


def test_the_moment_on_each_pad_vanishes() -> None:
    pads = TILTING["five_pads"]
    found = tilted(pads, 0.5, np.array([0.05, -0.3]), around=120)
    assert found.tilt.size == 5
    # A slow push on the journal moves the pads so that none of them meets a moment: the reduced stiffness is symmetric.
    slow = found.reduced(0.0)
    assert slow[0, 1] == pytest.approx(slow[1, 0], abs=1e-3 * abs(slow[0, 0]))


@pytest.mark.long
def test_a_plant_on_tilting_pads_is_identified() -> None:
    place = np.array([0.05, -0.3])
    due, known = tilted(TILTING["five_pads"], 0.5, place), bearing_table("five_pads", 0.5).at(place)
    assert known.force == pytest.approx(due.force, rel=0.01)
    assert known.stiffness + 1j * known.damping == pytest.approx(due.reduced(1.0), rel=0.01, abs=0.01)
    plant = random_plant(1, design=Design(profile="five_pads", slenderness=(0.5,)), discrepancy=DiscrepancySize())
    found = identify(parse_machine(film_document(plant)), measured(plant, seed=1), Options(starts=3))
    assert found.accepted
    one = score(found, film_truths(plant))
    assert one.coverage > 0.8
    assert len(one.inside) >= 16
