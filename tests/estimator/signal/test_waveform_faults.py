"""Faults of a waveform, and sound waveforms that must not be taken for faulty."""

import math

import numpy as np
import pytest

from estimator.arrays import Floats
from estimator.signal.waveform_faults import WaveformFault, waveform_fault

RATE = 2560.0
PER_TURN = RATE / 31.7


def sine(amplitude: float = 1.0) -> Floats:
    """One second at 31.7 Hz about -9."""
    return np.asarray(-9.0 + amplitude * np.cos(2.0 * math.pi * 31.7 * np.arange(2560) / RATE + 0.4))


def half_flat() -> Floats:
    signal = sine()
    signal[1000:1200] = -9.7
    return signal


def with_a_hole() -> Floats:
    signal = sine()
    signal[77] = math.nan
    return signal


@pytest.mark.parametrize(
    ("signal", "rails", "fault"),
    [
        (sine(), None, None),
        (sine(), (-20.0, -1.0), None),
        (np.clip(sine(), -math.inf, -8.05), None, "clipped"),
        (np.clip(sine(), -9.9, math.inf), None, "clipped"),
        (np.clip(sine(), -9.9, math.inf), (-9.9, -1.0), "clipped"),
        (np.full(2560, -24.0), None, "flat line"),
        (np.full(2560, -24.0), (-24.0, 0.0), "rail"),
        (np.full(2560, -24.0) - 0.001 * np.random.default_rng(1).random(2560), (-24.0, 0.0), "rail"),
        (half_flat(), None, "flat line"),
        (with_a_hole(), None, "not finite"),
    ],
)
def test_faults(signal: Floats, rails: tuple[float, float] | None, fault: WaveformFault | None) -> None:
    assert waveform_fault(signal, samples_per_turn=PER_TURN, rails=rails) == fault


@pytest.mark.parametrize("step", [0.001, 0.01, 0.03, 0.1, 0.3])
@pytest.mark.parametrize("noise", [0.0, 0.02])
@pytest.mark.parametrize("amplitude", [1.0, 0.95, 1.04])
def test_a_quantised_sine_is_not_clipped(step: float, noise: float, amplitude: float) -> None:
    signal = sine(amplitude) + noise * np.random.default_rng(2).normal(size=2560)
    assert waveform_fault(step * np.round(signal / step), samples_per_turn=PER_TURN) is None


def test_a_quantised_sine_clipped_at_nine_tenths_is_seen() -> None:
    """Its flat top takes arccos(0.9)/π = 14 % of the samples, the value next to it 0.7 %."""
    signal = 0.01 * np.round(np.clip(sine(), -math.inf, -8.1) / 0.01)
    assert waveform_fault(signal, samples_per_turn=PER_TURN) == "clipped"
