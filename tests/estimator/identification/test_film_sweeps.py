"""Sweeps of a train on films, whose coefficients follow the speed, integrated in time by physics of their own."""

import numpy as np
import pytest

from estimator.fit.identification import Options
from estimator.fit.problem.coordinates import Coordinates
from estimator.identification.quality_gate import identify_gated
from estimator.identification.sweep_correction import predicted_transient
from estimator.rotor.condensation import condense
from estimator.updated_model.model import model_at
from tests.estimator.sweeps import recorded
from tests.film_plant.documents import linear_machine
from tests.film_plant.plant import RPM, Plant, noisy
from tests.film_plant.plants import motor_compressor_plant
from tests.film_plant.scores import true_values
from tests.film_plant.sweep import SweepRecord

RATE_RPM_PER_S = 80.0


@pytest.fixture(scope="module")
def plant() -> Plant:
    return motor_compressor_plant(1, "flexible")


@pytest.fixture(scope="module")
def record(plant: Plant) -> SweepRecord:
    return plant.swept(rate_rpm_per_s=RATE_RPM_PER_S, samples=150)


def test_the_correction_follows_each_modes_own_eigenvalue(plant: Plant, record: SweepRecord) -> None:
    """Asked: within 10 % of an integration in time."""
    knots = np.linspace(plant.slowest / RPM, plant.fastest / RPM, 12).tolist()
    machine = linear_machine(plant, form="piecewise", knots_rpm=knots, terms="all", perturbation=0.0)
    train = condense(machine, speed=np.ones(1), direction=np.ones(1))
    coordinates = Coordinates.of(train, unbalance_scale=1.0)
    truth, theta = true_values(plant, machine), coordinates.centre.copy()
    for place, one in enumerate(coordinates.parameters):
        if one.name in truth:
            theta[place] = one.fitted(truth[one.name].real)
    for disc, first in zip(plant.train.discs, coordinates.excitation_place, strict=False):
        theta[first], theta[first + 1] = disc.unbalance.real, disc.unbalance.imag
    model = model_at(machine, coordinates.names, coordinates.point(theta))
    found = predicted_transient(model, time=record.time, speed=record.speed)
    for predicted, measured in ((found.instant, record.instant), (found.averaged, record.averaged)):
        true = measured - record.steady
        assert np.abs(true).max() > 0.02 * np.abs(record.steady).max()
        assert np.linalg.norm(predicted - true) < 0.1 * np.linalg.norm(true)


def test_a_job_with_three_knots_ends_with_a_verdict(plant: Plant, record: SweepRecord) -> None:
    """It ended with a singular matrix: eigenvalues were carried on in a straight line until they grew."""
    knots = np.linspace(plant.slowest / RPM, plant.fastest / RPM, 3).round().tolist()
    machine = linear_machine(plant, form="polynomial", knots_rpm=knots, terms="direct")
    phasor = noisy(record.averaged, np.random.default_rng(0))
    run, measurement = recorded(record.time, record.speed, phasor, machine.channels)
    found = identify_gated(machine, [run], [measurement], options=Options(starts=2))
    assert found.error is None
    assert found.identification is not None
    assert found.identification.verdict
