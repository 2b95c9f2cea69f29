"""A train condensed to its journals, as fleets run it down, moves as the whole train does."""

import numpy as np
import pytest

from benchmarks.alignment.film_fleet import FILM_SPEEDS, SAMPLES
from benchmarks.alignment.film_histories import FilmHistory, Happening
from tests.film_plant.condensed import CondensedTrain
from tests.film_plant.motor_compressor import CouplingKind
from tests.film_plant.plant import HIGHEST_MODE, KEPT_MODE, NOISE_FLOOR, NOISE_PART
from tests.film_plant.response import smallest_damping_ratio
from tests.film_plant.sweep import ReducedTrain, films_between


@pytest.mark.parametrize(("seed", "kind", "happening"), [(4, "flexible", "healthy"), (5, "rigid", "pedestal")])
def test_a_condensed_train_responds_and_whirls_as_the_whole_one(seed: int, kind: CouplingKind, happening: Happening) -> None:
    plant = FilmHistory(seed, kind, happening, 0).plant_in(3)
    speed = plant.speeds(SAMPLES)
    films = plant.films(speed)
    due = plant.phasors(films)
    train = CondensedTrain(plant.matrices, speed)
    found = train.phasors(stiffness=films.stiffness, damping=films.damping)
    assert np.abs(found - due).max() < 1e-9 * np.abs(due).max()
    stiffness, damping = films_between(plant.films(plant.speeds(FILM_SPEEDS)), speed)
    noise = np.hypot(NOISE_PART * np.abs(due), NOISE_FLOOR)
    assert np.max(np.abs(train.phasors(stiffness=stiffness, damping=damping) - due) / noise) < 0.05
    assert train.is_of(plant.matrices)
    assert not train.is_of(FilmHistory(seed, kind, "unbalance", 0).plant_in(3).matrices)
    few = plant.films(plant.speeds(2))
    reduced = ReducedTrain(plant.matrices, KEPT_MODE * plant.fastest)
    ratios = [
        smallest_damping_ratio(reduced.eigenvalues(speed=float(w), stiffness=k, damping=c), HIGHEST_MODE * plant.fastest)
        for w, k, c in zip(few.speed, few.stiffness, few.damping, strict=True)
    ]
    np.testing.assert_allclose(ratios, plant.damping_ratios(few.speed), rtol=1e-2)
