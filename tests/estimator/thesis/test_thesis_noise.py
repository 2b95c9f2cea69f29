"""Noise of Eq. 2.19-2.20 and circular complex noise."""

import math
from functools import partial

import numpy as np
import pytest

from estimator.arrays import Complexes
from estimator.thesis.noise import Sharing, complex_noise, multiplicative_noise, multiplicative_rms

RESPONSE: Complexes = np.exp(1j * np.linspace(0, 6, 4000)).reshape(500, 8) * 1e-4


def relative(noisy: Complexes) -> Complexes:
    return np.asarray(noisy / RESPONSE - 1.0)


def test_multiplicative_noise_is_real_and_within_half_of_its_percentage() -> None:
    error = relative(multiplicative_noise(RESPONSE, percent=5.0, rng=np.random.default_rng(0)))
    assert np.abs(error.imag).max() < 1e-14
    assert error.real.min() >= -0.025
    assert error.real.max() == pytest.approx(0.025, abs=1e-12)  # R / R_max reaches one


def test_five_percent_is_1_44_percent_rms() -> None:
    assert multiplicative_rms(5.0) == pytest.approx(0.0144338, rel=1e-5)
    error = relative(multiplicative_noise(RESPONSE, percent=5.0, rng=np.random.default_rng(0)))
    assert math.sqrt(np.mean(error.real**2)) == pytest.approx(multiplicative_rms(5.0), rel=0.03)


@pytest.mark.parametrize(("sharing", "different"), [("none", 4000), ("channel", 8), ("speed", 500), ("all", 1)])
def test_sharing_says_how_many_numbers_are_drawn(sharing: Sharing, different: int) -> None:
    noisy = multiplicative_noise(RESPONSE, percent=5.0, rng=np.random.default_rng(1), sharing=sharing)
    error = relative(noisy).real
    assert np.unique(error.round(12)).size == different
    if sharing == "channel":
        assert np.ptp(error, axis=0).max() < 1e-12
    if sharing == "speed":
        assert np.ptp(error, axis=1).max() < 1e-12


def test_complex_noise_is_circular_and_of_the_stated_rms() -> None:
    error = relative(complex_noise(RESPONSE, rms=0.01, rng=np.random.default_rng(2)))
    assert math.sqrt(np.mean(np.abs(error) ** 2)) == pytest.approx(0.01, rel=0.03)
    assert np.std(error.real) == pytest.approx(np.std(error.imag), rel=0.05)
    assert abs(np.mean(error)) < 5e-4


def test_same_seed_same_noise() -> None:
    for noise in (partial(multiplicative_noise, RESPONSE, percent=2.0), partial(complex_noise, RESPONSE, rms=0.02)):
        assert np.array_equal(noise(rng=np.random.default_rng(7)), noise(rng=np.random.default_rng(7)))
        assert not np.array_equal(noise(rng=np.random.default_rng(7)), noise(rng=np.random.default_rng(8)))


def test_no_noise() -> None:
    assert np.array_equal(multiplicative_noise(RESPONSE, percent=0.0, rng=np.random.default_rng(0)), RESPONSE)
    assert np.array_equal(complex_noise(RESPONSE, rms=0.0, rng=np.random.default_rng(0)), RESPONSE)


def test_negative_noise_is_refused() -> None:
    with pytest.raises(ValueError, match="at least 0"):
        multiplicative_noise(RESPONSE, percent=-1.0, rng=np.random.default_rng(0))
    with pytest.raises(ValueError, match="at least 0"):
        complex_noise(RESPONSE, rms=-1.0, rng=np.random.default_rng(0))
