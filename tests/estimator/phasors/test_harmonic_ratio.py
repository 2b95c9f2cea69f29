"""The 2× against the 1×: medians by hand, intervals of the binomial, and what does not count."""

import numpy as np
import pytest

from estimator.phasors.harmonic_ratio import FEWEST, Orders, measures_second, second_order, second_over_first

SPEED = 300.0


def orders(ratio: np.ndarray, *, speed: float = SPEED) -> Orders:
    """Samples at one speed whose 2× is that part of a 1× of any phase."""
    turned = np.exp(1j * np.arange(ratio.size))
    first = (5e-5 * turned)[:, None]
    return Orders(np.full(ratio.size, speed), first, ratio[:, None] * 5e-5 * np.conj(turned[:, None]))


def test_median_and_the_values_between_which_it_lies() -> None:
    """Of 11 values the second and the tenth: P(B ≤ 1) = 12/2048 < 0.025 < 67/2048 = P(B ≤ 2)."""
    found = second_over_first([orders(np.arange(1.0, 12.0) / 10)], 0, running_speed=SPEED)
    assert found is not None
    assert (found.value, found.lower, found.upper) == pytest.approx((0.6, 0.2, 1.0))
    assert found.samples == 11


def test_six_samples_are_the_fewest() -> None:
    ratio = np.array([0.3, 0.1, 0.2, 0.5, 0.4, 0.6])
    found = second_over_first([orders(ratio)], 0, running_speed=SPEED)
    assert found is not None
    assert (found.lower, found.upper) == pytest.approx((0.1, 0.6))
    assert ratio.size == FEWEST
    assert second_over_first([orders(ratio[:-1])], 0, running_speed=SPEED) is None


def test_the_interval_holds_the_median_of_any_distribution_in_95_per_cent() -> None:
    """Of 4000 draws 95 % is known within 0.35 %."""
    rng = np.random.default_rng(1)
    hits = 0
    for ratio in rng.exponential(1.0, (4000, 15)):
        found = second_over_first([orders(ratio)], 0, running_speed=SPEED)
        assert found is not None
        hits += found.lower <= np.log(2.0) <= found.upper
    assert 0.95 < hits / 4000 < 0.98  # of 15 values the 4th and the 12th hold it in 96.5 %


def test_runs_count_together_and_only_near_the_speed() -> None:
    far = orders(np.full(20, 9.0), speed=0.89 * SPEED)
    near = [orders(np.full(4, 0.2), speed=0.91 * SPEED), orders(np.full(5, 0.3), speed=1.09 * SPEED)]
    found = second_over_first([far, *near], 0, running_speed=SPEED)
    assert found is not None
    assert found.value == pytest.approx(0.3)
    assert found.samples == 9


def test_what_was_not_measured_does_not_count() -> None:
    one = orders(np.full(9, 0.5))
    one.second[0], one.first[1], one.first[2] = np.nan, np.nan, 0.0
    found = second_over_first([one], 0, running_speed=SPEED)
    assert found is not None
    assert found.samples == 6
    without = Orders(one.speed, one.first, np.full_like(one.second, np.nan))
    assert measures_second([without, one], 0)
    assert not measures_second([without], 0)


def test_amplitude_and_phase_of_the_2x_are_those_of_the_mean_with_its_errors() -> None:
    rng, true = np.random.default_rng(4), 3e-6 * np.exp(2.5j)
    found = []
    for _ in range(200):
        one = orders(np.ones(40))
        one.second[:, 0] = true + 2e-7 * (rng.standard_normal(40) + 1j * rng.standard_normal(40))
        told = second_order([one], 0, running_speed=SPEED)
        assert told is not None
        found.append((told.amplitude, told.phase, told.amplitude_error, told.phase_error))
    amplitude, phase, amplitude_error, phase_error = np.array(found).T
    assert np.isclose(amplitude.mean(), 3e-6, rtol=0.01)
    assert np.isclose(phase.mean(), 2.5, atol=0.01)
    assert np.isclose(amplitude_error.mean(), amplitude.std(), rtol=0.2)
    assert np.isclose(phase_error.mean(), phase.std(), rtol=0.2)


def test_too_few_samples_and_nothing_have_no_2x() -> None:
    few = orders(np.ones(FEWEST - 1))
    assert second_order([few], 0, running_speed=SPEED) is None
    nothing = orders(np.ones(20))
    nothing.second[:] = 0.0
    assert second_order([nothing], 0, running_speed=SPEED) is None
