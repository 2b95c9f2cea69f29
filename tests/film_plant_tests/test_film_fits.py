"""Identification by films on plants of other make: it is accepted, its intervals hold, a wrong bore is refused."""

import numpy as np
import pytest

from estimator.fit.identify import Options, identify
from estimator.machine.document import parse_machine
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, measured
from tests.film_plant.plants import random_plant
from tests.film_plant.scores import film_truths, score

OPTIONS = Options(starts=2)


def test_right_documents_are_accepted_and_most_intervals_hold() -> None:
    inside: list[bool] = []
    for seed in range(3):
        plant = random_plant(seed, discrepancy=DiscrepancySize())
        found = identify(parse_machine(film_document(plant)), measured(plant, seed=seed), OPTIONS)
        assert found.accepted, found.verdict
        told = score(found, film_truths(plant))
        assert len(told.inside) >= 16
        inside += told.inside
    assert np.mean(inside) > 0.85


def test_what_is_told_has_names_elements_and_units() -> None:
    plant = random_plant(3)
    found = identify(parse_machine(film_document(plant)), measured(plant, seed=3), OPTIONS)
    clearance = found.estimate("bearing.B2.clearance")
    assert (clearance.element, clearance.unit, clearance.quantity) == ("bearing.B2", "m", "clearance")
    assert clearance.value == pytest.approx(plant.train.clearances[1], rel=0.3)
    assert found.estimate("bearing.B4.viscosity").unit == "Pa s"
    assert not any("deviation" in one.name for one in found.estimates)


def test_films_that_are_said_to_be_exact_and_are_not_are_refused() -> None:
    plant = random_plant(1, discrepancy=DiscrepancySize(spread=0.08))
    found = identify(parse_machine(film_document(plant, discrepancy=0.002)), measured(plant, seed=1), OPTIONS)
    assert not found.accepted
