"""Rows of gaps: marginal likelihood of zeros and drifts against the one written out, derivatives against differences."""

import numpy as np

from estimator.arrays import Floats
from estimator.fit.problem.gap_rows import ChannelGaps, seen_noise
from tests.estimator.fit.test_gap_checks import Fitted, fitted

__all__ = ["fitted"]

SAMPLES = 40
NOISE, ZERO, DRIFT = 1e-6, 1e-2, 5e-6


def channel(place: Floats) -> ChannelGaps:
    time = np.linspace(-0.5, 0.5, place.size)
    errors = np.column_stack([np.full(place.size, ZERO), DRIFT * time])
    return ChannelGaps.of(0, 0, np.arange(place.size), place, noise=NOISE, errors=errors)


def test_whitened_residuals_have_the_marginal_likelihoods_square() -> None:
    rng = np.random.default_rng(1)
    place = 30e-6 * rng.standard_normal(SAMPLES)
    time = np.linspace(-0.5, 0.5, SAMPLES)
    covariance = NOISE**2 * np.eye(SAMPLES) + ZERO**2 + DRIFT**2 * np.outer(time, time)
    exact = float(place @ np.linalg.solve(covariance, place))
    assert np.isclose(float(np.sum(channel(place).measured ** 2)), exact, rtol=1e-6)


def test_a_zero_costs_nothing_and_a_drift_as_much_as_is_said() -> None:
    time = np.linspace(-0.5, 0.5, SAMPLES)
    assert np.sum(channel(np.full(SAMPLES, 1e-3)).measured ** 2) < 0.02
    assert np.isclose(np.sum(channel(2.0 * DRIFT * time).measured ** 2), 4.0, rtol=0.02)


def test_gaps_without_errors_of_the_model_have_as_many_squares_as_degrees_of_freedom() -> None:
    rng, time = np.random.default_rng(2), np.linspace(-0.5, 0.5, SAMPLES)
    squares = []
    for _ in range(200):
        place = 1e-3 * rng.standard_normal() + DRIFT * rng.standard_normal() * time + NOISE * rng.standard_normal(SAMPLES)
        squares.append(float(np.sum(channel(place).measured ** 2)))
    assert np.isclose(np.mean(squares), channel(time).freedom, rtol=0.05)


def test_noise_is_seen_beside_a_smooth_motion() -> None:
    rng, time = np.random.default_rng(3), np.linspace(0.0, 1.0, 400)
    assert np.isclose(seen_noise(80e-6 * time**2 + 2e-6 * rng.standard_normal(400)), 2e-6, rtol=0.2)


def test_derivatives_of_the_cost_are_those_of_differences(fitted: Fitted) -> None:
    rows = fitted.judged(fitted.gaps).problem.gaps
    assert rows is not None
    theta = fitted.found.theta
    cost, gradient, _ = rows.linearised(theta)
    assert np.isclose(cost, rows.cost(theta), rtol=1e-12)
    for place in rows.places.tolist():
        step = np.zeros(theta.size)
        step[place] = 1e-4
        slope = (rows.cost(theta + step) - rows.cost(theta - step)) / 2e-4
        assert np.isclose(-2.0 * gradient[place], slope, rtol=2e-3, atol=0.05 * np.abs(gradient).max() * 1e-2)
    assert not np.delete(gradient, rows.places).any()
