"""Runs of one plant: they differ by what is stated, and none whirls."""

import numpy as np

from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.plants import SMALLEST_RATIO, motor_compressor_plant
from tests.film_plant.scatter import DAMPING, OIL, STIFFNESS, run_of


def test_runs_of_a_plant_scatter_by_what_is_stated() -> None:
    plant = motor_compressor_plant(1, discrepancy=DiscrepancySize())
    rng = np.random.default_rng(0)
    runs = [run_of(plant, rng) for _ in range(3)]
    speed = plant.speeds(2)
    thicker = np.array([run.films(speed).viscosity[0] for run in runs]) / plant.films(speed).viscosity[0]
    assert np.ptp(thicker, axis=1).max() < 1e-12  # one oil for all bearings
    assert 0.2 * OIL < np.abs(np.log(thicker)).max() < 4.0 * OIL
    usual = [run.with_discrepancy(plant.discrepancy).films(speed) for run in runs if plant.discrepancy is not None]
    for size, name in ((STIFFNESS, "stiffness"), (DAMPING, "damping")):
        parts = np.array(
            [getattr(run.films(speed), name) / getattr(one, name) - 1 for run, one in zip(runs, usual, strict=True)]
        )
        assert np.ptp(parts, axis=1).max() < 1e-9  # level over speed
        assert 0.7 * size < np.std(parts) < 1.3 * size
    assert min(run.damping_ratios(run.speeds(2)).min() for run in runs) > SMALLEST_RATIO
