"""Phasors from time signals whose phasor is known."""

import cmath
import math

import numpy as np
import pytest
from numpy.typing import NDArray

from estimator.thesis.time_history import band_passed, extrema_phasor, least_squares_phasor

Floats = NDArray[np.float64]
RATE = 1000.0
TIME = np.arange(2000) / RATE


def signal(phasor: complex, frequency: float, *, pulse: float = 0.0) -> Floats:
    """Re(X e^{jω(t - pulse)}) at TIME."""
    return np.asarray((phasor * np.exp(2j * math.pi * frequency * (TIME - pulse))).real)


@pytest.mark.parametrize("phase", [0.0, 1.0, 3.0, -2.0])
def test_a_least_squares_phasor_is_exact_without_noise_whatever_the_mean(phase: float) -> None:
    true = 4e-5 * cmath.exp(1j * phase)
    found = least_squares_phasor(2e-3 + signal(true, 17.3, pulse=0.1234), time=TIME, pulse=0.1234, frequency=17.3)
    assert abs(found - true) < 1e-9 * abs(true)


@pytest.mark.parametrize("frequency", [17.0, 41.0])
@pytest.mark.parametrize("phase", [0.3, 2.0, -1.0])
def test_one_maximum_and_one_minimum_are_right_within_a_sample(frequency: float, phase: float) -> None:
    """The maximum may lie half a sample away, where the cosine has fallen by at most (πf/f_s)²/2."""
    true = 4e-5 * cmath.exp(1j * phase)
    found = extrema_phasor(signal(true, frequency, pulse=0.2), time=TIME, pulse=0.2, frequency=frequency)
    half_sample = math.pi * frequency / RATE
    assert abs(cmath.phase(found / true)) <= half_sample * 1.0001
    assert 1.0 - half_sample**2 / 2 <= abs(found) / abs(true) <= 1.0 + 1e-12


def test_the_band_pass_keeps_the_line_and_takes_the_rest() -> None:
    true = 4e-5 * cmath.exp(0.7j)
    disturbed = 5e-3 + signal(true, 25.0) + signal(3e-5, 50.0) + signal(2e-5j, 8.0)
    filtered = band_passed(disturbed, sampling_rate=RATE, frequency=25.0)
    middle = slice(700, 1300)
    assert filtered[middle] == pytest.approx(signal(true, 25.0)[middle], abs=0.01 * abs(true))


def test_what_cannot_be_read_is_named() -> None:
    with pytest.raises(ValueError, match="period and a half"):
        extrema_phasor(signal(1.0, 17.0), time=TIME, pulse=1.95, frequency=17.0)
    with pytest.raises(ValueError, match="band from"):
        band_passed(signal(1.0, 17.0), sampling_rate=RATE, frequency=1.0)
    with pytest.raises(ValueError, match="2 samples"):
        least_squares_phasor(np.ones(2), time=TIME[:2], pulse=0.0, frequency=17.0)
