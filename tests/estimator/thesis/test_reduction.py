"""Exact elimination, dynamic condensation and high-frequency condensation against the full solve."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.arrays import Complexes, Floats
from estimator.rotor.condensation import condense
from estimator.rotor.rayleigh import RayleighCoefficients
from estimator.rotor.response import response
from estimator.thesis.flexible_train import FlexibleTrain, flexible_train, full_response
from estimator.thesis.reduced_model import ReducedModel, reduced_response
from estimator.thesis.reduction import (
    dynamic_masters,
    dynamically_condensed,
    eliminated,
    high_frequency_condensed,
    high_frequency_transformation,
)
from tests.estimator.trains import chapter_3, truth

MACHINE = chapter_3()
TRAIN = flexible_train(MACHINE)
COEFFICIENTS, UNBALANCES = truth(MACHINE)
SPEED = np.array([40.0, 122.0, 162.0, 220.0, 283.0])
DIRECTION = np.array([1.0, -1.0, 1.0, -1.0, 1.0])


def full(train: FlexibleTrain, speed: Floats = SPEED, direction: Floats = DIRECTION) -> Complexes:
    """The full solve."""
    return full_response(train, coefficients=COEFFICIENTS, unbalances=UNBALANCES, speed=speed, direction=direction)


def deviation(model: ReducedModel, expected: Complexes) -> Floats:
    """Largest deviation of the reduced response from the full one, per speed, over the largest displacement."""
    found = reduced_response(model, coefficients=COEFFICIENTS, unbalances=UNBALANCES)
    return np.asarray(np.abs(found - expected).max(axis=1) / np.abs(expected).max(axis=1))


@pytest.mark.parametrize("rayleigh", [None, RayleighCoefficients(mass_coefficient=1.5, stiffness_coefficient=1e-4)])
def test_elimination_is_exact(rayleigh: RayleighCoefficients | None) -> None:
    train = flexible_train(MACHINE, rayleigh=rayleigh)
    model = eliminated(train, speed=SPEED, direction=DIRECTION)
    assert deviation(model, full(train)[:, train.interface]).max() < 1e-11


def test_elimination_agrees_with_the_condensation_of_the_estimator() -> None:
    core = condense(MACHINE, speed=SPEED, direction=DIRECTION)
    expected = response(core, coefficients=COEFFICIENTS, excitations=UNBALANCES)
    model = eliminated(TRAIN, speed=SPEED, direction=DIRECTION)
    found = reduced_response(model, coefficients=COEFFICIENTS, unbalances=UNBALANCES)[:, : TRAIN.bearing.size]
    assert np.abs(found - expected).max() < 1e-11 * np.abs(expected).max()


def test_dynamic_condensation_keeps_the_masters_of_the_thesis() -> None:
    """8 bearing translations, 8 at the coupling, 8 disc translations (Eq. 4.53)."""
    masters = dynamic_masters(TRAIN)
    assert masters.size == 24
    assert masters[:8].tolist() == TRAIN.bearing.tolist()
    assert set(TRAIN.disc) < set(masters)


def test_dynamic_condensation_is_exact_without_gyroscopic_effect() -> None:
    still = replace(TRAIN, gyroscopic=np.zeros_like(TRAIN.gyroscopic))
    model = dynamically_condensed(still, speed=SPEED, direction=DIRECTION)
    assert deviation(model, full(still)[:, dynamic_masters(still)]).max() < 1e-10


def test_dynamic_condensation_errs_little_with_gyroscopic_effect() -> None:
    """The part left out of the transformation enters the response in second order only."""
    model = dynamically_condensed(TRAIN, speed=SPEED, direction=DIRECTION)
    found = deviation(model, full(TRAIN)[:, dynamic_masters(TRAIN)])
    assert 1e-10 < found.max() < 3e-3  # largest on the critical speed of 162 rad/s
    stronger = replace(TRAIN, gyroscopic=2 * TRAIN.gyroscopic)
    doubled = deviation(
        dynamically_condensed(stronger, speed=SPEED, direction=DIRECTION), full(stronger)[:, dynamic_masters(stronger)]
    )
    assert np.median(doubled / found) == pytest.approx(4.0, rel=0.1)


def test_high_frequency_condensation_follows_its_formula() -> None:
    """At rest the dynamic transformation is Guyan's, so the whole can be written out with plain partitions."""
    transformation = high_frequency_transformation(TRAIN, speed=np.array([0.0]))[0]
    masters = dynamic_masters(TRAIN)
    slaves = np.array([k for k in range(TRAIN.size) if k not in masters])
    guyan = np.zeros((48, 24))
    guyan[masters] = np.eye(24)
    guyan[slaves] = -np.linalg.inv(TRAIN.stiffness[np.ix_(slaves, slaves)]) @ TRAIN.stiffness[np.ix_(slaves, masters)]
    mass = guyan.T @ TRAIN.mass @ guyan
    expected = guyan @ np.vstack([np.eye(8), -np.linalg.inv(mass[8:, 8:]) @ mass[8:, :8]])
    assert np.allclose(transformation, expected, rtol=0, atol=1e-9)


def test_high_frequency_condensation_misses_the_response_altogether() -> None:
    """At the thesis's own speeds: the reduced model is some hundred times too stiff to move."""
    speed = np.arange(150.0, 176.0, 5.0)
    direction = np.ones_like(speed)
    found = deviation(
        high_frequency_condensed(TRAIN, speed=speed, direction=direction), full(TRAIN, speed, direction)[:, TRAIN.bearing]
    )
    assert np.all((found > 0.9) & (found < 1.1))


def test_high_frequency_condensation_needs_a_million_radians_per_second() -> None:
    """It becomes right only far above every natural frequency of what it eliminates, which the stiff coupling sets."""
    speed = np.array([1e3, 1e4, 1e5, 1e6])
    direction = np.ones_like(speed)
    found = deviation(
        high_frequency_condensed(TRAIN, speed=speed, direction=direction), full(TRAIN, speed, direction)[:, TRAIN.bearing]
    )
    assert np.all(found[:3] > 0.5)
    assert found[3] < 0.05
