"""The bound of the logarithm of a determinant touches it, lies above it, ends at gains of zero, and has the slope it says."""

import numpy as np
import pytest

from benchmarks.calibration.simulated_trains import MountedTrain
from benchmarks.calibration.wrong_weights import KINDS, stated
from estimator.calibration.calibrate import calibrate
from estimator.calibration.determinant_bound import DeterminantBound
from estimator.fit.problem.channel_coordinates import ChannelCoordinates

UNIT = np.array([1.0, 0.5, 0.5, 2.0, 2.0])
CHANNELS = ChannelCoordinates(np.array([1, -1, 3]), np.array([-1, -1, -1]), UNIT)
"""Two gains among five coordinates; the second channel's is taken as exact."""
POWER = np.array([3.0, 0.0, 7.0])
"""Factors of the logarithms of the gains."""
HERE = np.array([0.3, -0.4, 1.2, 0.2, -0.7])
STEP = 1e-6


def logarithm(theta: np.ndarray) -> float:
    return float(0.8 * theta[0] + POWER @ np.log(np.abs(CHANNELS.gains(theta))))


def differences(function: object, theta: np.ndarray) -> np.ndarray:
    assert callable(function)
    return np.array([(function(theta + step) - function(theta - step)) / (2.0 * STEP) for step in STEP * np.eye(theta.size)])


def bound() -> DeterminantBound:
    return DeterminantBound.through(HERE, differences(logarithm, HERE), CHANNELS)


def test_the_bound_touches_the_logarithm_and_lies_above_it() -> None:
    found, rng = bound(), np.random.default_rng(0)
    np.testing.assert_allclose(found.derivatives(HERE)[0], differences(logarithm, HERE), rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(found.growth, POWER / np.abs(CHANNELS.gains(HERE)), rtol=1e-6)
    for other in HERE + 2.0 * rng.standard_normal((200, HERE.size)):
        assert found.value(other) - found.value(HERE) >= logarithm(other) - logarithm(HERE) - 1e-6


def test_gains_of_the_opposite_sign_bring_nothing() -> None:
    found = bound()
    straight = differences(logarithm, HERE)
    opposite = HERE.copy()
    for pair, gain in (([1, 2], CHANNELS.gains(HERE)[0]), ([3, 4], CHANNELS.gains(HERE)[2])):
        opposite[pair] += -2.0 * np.array([gain.real, gain.imag]) / UNIT[pair]
    np.testing.assert_allclose(CHANNELS.gains(opposite)[[0, 2]], -CHANNELS.gains(HERE)[[0, 2]], rtol=1e-12)
    assert straight @ (opposite - HERE) < -10.0  # the straight line would lead there
    assert abs(found.value(opposite) - found.value(HERE)) < 1e-6


def test_derivatives_are_those_of_the_value() -> None:
    found = bound()
    there = HERE + np.array([0.1, 0.5, -0.3, 0.4, 0.2])
    gradient, curvature = found.derivatives(there)
    np.testing.assert_allclose(gradient, differences(found.value, there), rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(curvature, differences(lambda at: found.derivatives(at)[0], there), rtol=1e-6, atol=1e-6)


@pytest.mark.long
def test_a_fit_of_weights_that_tell_nothing_comes_to_an_end() -> None:
    """Each run has the weights of the next: gains went through zero to and fro from pass to pass, and no pass converged."""
    plant = MountedTrain("motor-pump", 0)
    runs = plant.runs(12, 16)
    weights = KINDS["each run with the weights of the next"]([np.asarray(one.measurement.added) for one in runs])
    found = calibrate(plant.machine, stated(runs, weights))
    assert not found.accepted
    assert not found.verdict.startswith("not converged"), found.verdict
