"""Identification of trains on unknown pedestals with resonances in the speed range, on plants of other make."""

import time

import numpy as np

from benchmarks.fluid_film.figure import Figure
from estimator.fit.identify import Options, identify
from estimator.machine.document import parse_machine
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, measured, with_pedestals
from tests.film_plant.plants import random_plant
from tests.film_plant.proportions import Design
from tests.film_plant.scores import Score, film_truths, score

SPREAD = 0.2
"""Prior standard deviation of the logarithm of each of a pedestal's numbers, by which documents are off [-]."""
FIRST_SEED = 100


def pedestals(plants: int) -> list[Figure]:
    """Return how often documents with unknown pedestals are accepted, and how many of their intervals hold."""
    found = [_fitted(seed) for seed in range(FIRST_SEED, FIRST_SEED + plants)]
    taken = [one for one, _, _ in found if one.accepted]
    accepted = len(taken) / len(found)
    coverage = float(np.mean([held for one in taken for held in one.inside])) if taken else 1.0
    own = [held for one, of_pedestals, _ in found if one.accepted for held in of_pedestals.inside]
    return [
        Figure(f"unknown pedestals, {plants} plants: accepted", ">= 90 %", f"{accepted:.0%}", accepted >= 0.9),
        Figure("    95 % intervals hold, of the accepted", ">= 92 %", f"{coverage:.1%}", coverage >= 0.92),
        Figure(f"        of the pedestals' own {len(own)}", "", f"{np.mean(own) if own else 1.0:.1%}", True),
        Figure("    time of one identification, median [s]", "", f"{np.median([one for *_, one in found]):.1f}", True),
    ]


def _fitted(seed: int) -> tuple[Score, Score, float]:
    """Return the scores of one plant, of all parameters and of the pedestals', and the time of its identification [s]."""
    plant = random_plant(seed, design=Design(pedestals=True), discrepancy=DiscrepancySize())
    machine = parse_machine(with_pedestals(film_document(plant), plant, spread=SPREAD, seed=seed))
    data = measured(plant, seed=seed)
    began = time.perf_counter()
    found = identify(machine, data, Options(starts=3))
    took = time.perf_counter() - began
    truth = film_truths(plant)
    own = {name: value for name, value in truth.items() if name.startswith("pedestal.")}
    return score(found, truth), score(found, own), took
