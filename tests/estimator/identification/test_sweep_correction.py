"""Tests what a model predicts that a sweep adds to the phasors: against the time-domain integration."""

import numpy as np
import pytest

from estimator.fit.problem.coordinates import Coordinates
from estimator.identification.sweep_correction import predicted_transient
from estimator.machine.document import Machine
from estimator.phasors.speed_law import SpeedLaw
from estimator.rotor.condensation import condense
from estimator.simulation.coast_down import coast_down
from estimator.updated_model.model import UpdatedModel
from tests.estimator.sweeps import fast_coast_down, light_chapter_3, linear_law, single_mass, steady


def nominal(machine: Machine) -> UpdatedModel:
    train = condense(machine, speed=np.ones(1), direction=np.ones(1))
    size = Coordinates.of(train, unbalance_scale=1.0).size
    return UpdatedModel.of(
        machine,
        coefficients=np.array([one.expected for one in train.unknowns.coefficients]),
        unbalances=np.array([one.nominal for one in train.unknowns.excitations]),
        covariance=np.zeros((size, size)),
    )


def test_prediction_is_what_the_integration_shows() -> None:
    machine, moved = light_chapter_3(), fast_coast_down()
    time = np.linspace(5.0, 100.0, 200)
    speed = moved.law.speed(time)
    true = moved.envelope(time) - steady(machine, speed)
    found = predicted_transient(nominal(machine), time=time, speed=speed).instant
    clear = np.abs(true) > 0.01 * np.abs(steady(machine, speed))
    assert np.mean(clear) > 0.2
    wrong = (np.abs(found - true) / np.abs(true))[clear]
    assert np.median(wrong) < 0.05
    assert np.quantile(wrong, 0.9) < 0.25
    still = np.abs(true) < 0.001 * np.abs(steady(machine, speed))
    assert np.all(np.abs(found)[still] < 0.005 * np.abs(steady(machine, speed))[still])


def test_means_over_blocks_are_predicted_too() -> None:
    machine, moved = light_chapter_3(), fast_coast_down()
    time = np.linspace(5.0, 99.0, 200)
    speed = moved.law.speed(time)
    half = (time[1] - time[0]) / 2
    inside = np.linspace(-half, half, 201)
    mean = np.array([np.trapezoid(moved.envelope(moment + inside), inside, axis=0) for moment in time]) / (2 * half)
    true = mean - steady(machine, speed)
    found = predicted_transient(nominal(machine), time=time, speed=speed).averaged
    middle = slice(1, -1)  # the first and the last block are only half known
    clear = np.abs(true[middle]) > 0.02 * np.abs(steady(machine, speed))[middle]
    assert np.median((np.abs(found - true)[middle] / np.abs(true[middle]))[clear]) < 0.05


def test_lightly_damped_single_mass_to_a_few_per_cent() -> None:
    machine = single_mass(natural_frequency=150.0, damping_ratio=0.01)
    moved = coast_down(machine, linear_law(first=80.0, last=230.0, duration=15.0), step=1e-3)
    time = np.linspace(1.0, 15.0, 300)
    speed = moved.law.speed(time)
    true = moved.envelope(time) - steady(machine, speed)
    found = predicted_transient(nominal(machine), time=time, speed=speed).instant
    behind = speed > 150.0
    assert np.abs(true[behind]).max() > 0.2 * np.abs(steady(machine, speed)).max()
    assert np.abs(found - true)[behind].max() < 0.03 * np.abs(true).max()


def test_deviation_of_slow_sweeps_goes_with_the_rate() -> None:
    machine = light_chapter_3()
    speed = np.linspace(560.0, 60.0, 150)
    sizes = []
    for duration in (4e4, 8e4):
        found = predicted_transient(nominal(machine), time=np.linspace(0.0, duration, 150), speed=speed).instant
        sizes.append(np.sqrt(np.mean(np.abs(found / steady(machine, speed)) ** 2)))
    assert sizes[0] < 0.01
    assert sizes[1] == pytest.approx(sizes[0] / 2, rel=0.02)


def test_noise_of_the_speed_is_no_acceleration() -> None:
    machine = light_chapter_3()
    rng = np.random.default_rng(1)
    time = np.linspace(0.0, 2000.0, 200)
    speed = np.linspace(560.0, 60.0, 200)
    model = nominal(machine)
    clean = predicted_transient(model, time=time, speed=speed).instant
    found = predicted_transient(model, time=time, speed=speed * (1 + 5e-4 * rng.standard_normal(200))).instant
    size = np.abs(steady(machine, speed))
    assert np.max(np.abs(found) / size) < np.max(np.abs(clean) / size) + 0.05


def test_speed_law_follows_what_it_is_given() -> None:
    time = np.linspace(0.0, 10.0, 60)
    law = SpeedLaw.measured(time, 300.0 - 2.0 * time**2)
    np.testing.assert_allclose(law.speed(time), 300.0 - 2.0 * time**2, rtol=1e-9)
    np.testing.assert_allclose(law.acceleration(time), -4.0 * time, atol=1e-6)
    np.testing.assert_allclose(law.angle(time), 300.0 * time - 2.0 / 3.0 * time**3, rtol=1e-9, atol=1e-9)
    with pytest.raises(ValueError, match="ascending"):
        SpeedLaw.through(np.array([0.0, 0.0]), np.array([1.0, 2.0]))
