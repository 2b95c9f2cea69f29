"""Noise in decibels against Table E.1 and against what is measured in simulated signals."""

import math

import numpy as np
import pytest

from estimator.thesis.signal_noise import decibels, noisy_signal, percent, phasor_error
from estimator.thesis.time_history import least_squares_phasor


@pytest.mark.parametrize(("noise", "printed"), [(1.0, 40.00), (2.0, 33.98), (5.0, 26.02), (100.0, 0.0)])
def test_table_e_1(noise: float, printed: float) -> None:
    assert decibels(noise) == pytest.approx(printed, abs=0.005)
    assert percent(printed) == pytest.approx(noise, rel=6e-4)


def test_per_cent_undoes_decibels() -> None:
    for noise in (0.01, 3.7, 250.0):
        assert percent(decibels(noise)) == pytest.approx(noise, rel=1e-12)


def test_a_noisy_signal_has_the_ratio_asked_for_whatever_its_mean() -> None:
    time = np.arange(200_000) / 1000.0
    signal = 5e-3 + 4e-5 * np.cos(2 * math.pi * 17.0 * time)
    added = noisy_signal(signal, decibels=26.02, rng=np.random.default_rng(0)) - signal
    rms = 4e-5 / math.sqrt(2)
    assert 20 * math.log10(rms / added.std()) == pytest.approx(26.02, abs=0.05)
    assert abs(added.mean()) < 5 * rms * 0.05 / math.sqrt(time.size)


def test_the_error_left_in_a_phasor() -> None:
    """500 fits to 300 samples of 5 % noise; the rms of 1000 normal numbers is known within 2.2 %, four times that allowed."""
    time = np.arange(300) / 1000.0
    true = 3e-5 * np.exp(1.1j)
    signal = (true * np.exp(2j * math.pi * 20.0 * time)).real
    rng = np.random.default_rng(1)
    errors = []
    for _ in range(500):
        noisy = noisy_signal(signal, decibels=decibels(5.0), rng=rng)
        errors.append(abs(least_squares_phasor(noisy, time=time, pulse=0.0, frequency=20.0) - true) / abs(true))
    found = math.sqrt(np.mean(np.square(errors)))
    assert found == pytest.approx(phasor_error(percent=5.0, samples=300), rel=0.09)


def test_what_has_no_ratio() -> None:
    with pytest.raises(ValueError, match="positive"):
        decibels(0.0)
    with pytest.raises(ValueError, match="does not vary"):
        noisy_signal(np.ones(10), decibels=20.0, rng=np.random.default_rng(0))
    with pytest.raises(ValueError, match="2 samples"):
        phasor_error(percent=1.0, samples=2)
