"""The benchmark of phasors from waveforms: its figures on fewer draws, and its truth."""

import math

import numpy as np
import pytest

from benchmarks.estimator.phasors import CASES, NOISE, RAMP, SECONDS, drawn, keyphasor_pulses, main, outcome


def test_the_noise_is_as_stated() -> None:
    """26 dB: the power of the sine, 1/2, is 10^2.6 times the noise's."""
    assert 0.5 / NOISE.noise**2 == pytest.approx(10.0**2.6)
    record = drawn(NOISE, 3)
    at = np.arange(record.probe.size) / 1000.0
    assert at.size == round(1000 * SECONDS)
    columns = np.stack([np.cos(100.0 * math.pi * at), np.sin(100.0 * math.pi * at)], axis=1)
    rest = record.probe - columns @ np.linalg.lstsq(columns, record.probe, rcond=None)[0]
    assert np.std(rest) == pytest.approx(NOISE.noise, rel=0.05)


def test_the_pulse_rises_at_angle_zero() -> None:
    angle = 2.0 * math.pi * np.array([-0.02, 0.0, 0.00625, 0.05, 0.1, 0.2, 0.9])
    assert keyphasor_pulses(angle, 0.025) == pytest.approx([0.0, 0.5, 0.75, 1.0, 0.5, 0.0, 0.0])


def test_the_figures_asked_for_hold() -> None:
    """With 100 draws the rms error is known to 1/√200 of itself: 1.2 is 2.8 of these above the bound."""
    noise, ramp = outcome(NOISE, 100), outcome(RAMP, 20)
    assert noise.own.rms / noise.bound < 1.2
    assert noise.claimed == pytest.approx(noise.bound, rel=0.1)
    assert noise.thesis.rms > 5.0 * noise.own.rms
    assert abs(ramp.own.amplitude_percent) < 0.5
    assert abs(ramp.own.phase_deg) < 0.5


def test_every_case_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    main(["--runs", "1"])
    page = capsys.readouterr().out
    assert [case.name for case in CASES if case.name not in page] == []
    assert "seeds 0 to 0" in page
