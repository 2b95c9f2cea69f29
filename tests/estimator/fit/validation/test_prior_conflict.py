"""Documents that are wrong alike at all bearings: it is told, and intervals widen until they hold; right ones are untold."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from estimator.fit.identification import Options
from estimator.fit.identify import identify
from estimator.machine.document import parse_machine
from estimator.machine.film_speeds import reported_rpm
from estimator.updated_model.derived_quantities import derived_quantities
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, measured, with_pedestals
from tests.film_plant.plants import random_plant
from tests.film_plant.proportions import Design
from tests.film_plant.scores import film_result_truths, film_truths, score, score_derived
from tests.film_plant.wrong_documents import (
    diametral_clearances,
    oils_of_the_next_grade,
    overdamped_pedestals,
    shorter_bearings,
)

OPTIONS = Options(starts=2)
WORDS = "contradict the document"
MISTAKES: dict[str, tuple[Callable[[dict[str, Any]], dict[str, Any]], str]] = {
    "pedestals": (overdamped_pedestals, "dampings of pedestals contradict the document, pedestal.P"),
    "oils": (oils_of_the_next_grade, "viscosities contradict the document, bearing.B"),
    "clearances": (diametral_clearances, "are the clearances radial ones, and is the bearings' geometry right?"),
    "lengths": (shorter_bearings, "viscosities contradict the document, bearing.B"),
}


def judged(mistake: Callable[[dict[str, Any]], dict[str, Any]], seed: int, *, pedestals: bool) -> tuple[str, list[bool]]:
    """The verdict on a plant whose document has a mistake, and which intervals hold, none where it is refused."""
    plant = random_plant(seed, design=Design(pedestals=pedestals), discrepancy=DiscrepancySize())
    said = film_document(plant)
    machine = parse_machine(mistake(with_pedestals(said, plant, spread=0.2, seed=seed) if pedestals else said))
    found = identify(machine, measured(plant, seed=seed), OPTIONS)
    if not found.accepted:
        return found.verdict, []
    derived = score_derived(derived_quantities(machine, found), film_result_truths(plant, reported_rpm(machine)))
    return found.verdict, [*score(found, film_truths(plant)).inside, *derived.inside]


FIRST, *OTHERS = MISTAKES


@pytest.mark.parametrize("what", [FIRST, *(pytest.param(one, marks=pytest.mark.long) for one in OTHERS)])
def test_what_is_wrong_alike_at_all_bearings_is_told_and_intervals_hold(what: str) -> None:
    mistake, words = MISTAKES[what]
    found = [
        judged(mistake, seed, pedestals=what == "pedestals") for seed in range(7120, 7123 if what == "pedestals" else 7126)
    ]
    accepted = [verdict for verdict, inside in found if inside]
    assert len(accepted) >= 3
    assert sum(words in one and "intervals are widened" in one for one in accepted) >= len(accepted) - 1
    every = [one for _, inside in found for one in inside]
    assert np.mean(every) >= 0.9  # without: 73 to 92 %


@pytest.mark.parametrize("pedestals", [pytest.param(False, marks=pytest.mark.long), True])
def test_a_right_document_is_not_told_to_be_contradicted(pedestals: bool) -> None:
    found = [judged(lambda said: said, seed, pedestals=pedestals) for seed in range(7120, 7122)]
    assert not any(WORDS in verdict for verdict, _ in found)
    assert np.mean([one for _, inside in found for one in inside]) >= 0.9


def test_a_viscosity_that_may_stand_for_a_wrong_length_is_told_as_uncertain_as_that() -> None:
    plant = random_plant(7121, design=Design(), discrepancy=DiscrepancySize())
    said = film_document(plant)
    found = identify(parse_machine(shorter_bearings(said)), measured(plant, seed=7121), OPTIONS)
    assert found.accepted, found.verdict
    assert "viscosities contradict the document" in found.verdict
    documented = {f"bearing.{one['id']}.viscosity": one["film"]["oil"]["viscosity"] for one in said["bearings"]}
    for name, value in documented.items():
        told = found.estimate(name)
        if told.value is None:
            assert "uncertain by" in (told.reason or "")
            continue
        assert told.standard_error is not None
        assert told.standard_error / told.value >= abs(np.log(told.value / value)) / np.sqrt(2.0)
        place = found.coordinates.index(name)
        assert (
            np.sqrt(found.covariance[place, place]) < told.standard_error / told.value
        )  # changes from run to run are known better
