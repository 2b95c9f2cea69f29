"""The scatter that blocks claim against their true errors: lines beside the order, coloured noise, a converter's steps."""

import math
from typing import Literal

import numpy as np
import pytest
import scipy.signal

from estimator.arrays import Floats
from estimator.signal.keyphasor import shaft_angle
from estimator.signal.order_tracking import Block, track_orders
from estimator.signal.phasor_scatter import quantisation_error

RATE, SPEED = 1000.0, 2.0 * math.pi * 41.3
TIME = np.arange(1100) / RATE
ANGLE = shaft_angle(2.0 * math.pi / SPEED * np.arange(60.0))
RUNS = 200


def block(waveforms: Floats) -> Block:
    (found,) = track_orders(waveforms, sampling_rate=RATE, angle=ANGLE, seconds=1.0).blocks
    return found


def claim_over_error(noise: Floats, *, order: int = 1) -> float:
    """Return stated scatter over true error of an order in waveforms with this noise (RUNS, N)."""
    clean = np.cos(SPEED * TIME + 0.4) + 0.3 * np.cos(2.0 * SPEED * TIME - 1.0)
    found = block(clean + noise)
    true = {1: np.exp(0.4j), 2: 0.3 * np.exp(-1.0j)}[order]
    error = np.sqrt(np.mean(np.abs(found.phasors[:, order - 1] - true) ** 2))
    return float(np.sqrt(np.mean(found.scatter[:, order - 1] ** 2)) / error)


def lines(frequency: float, *, size: float = 0.1, white: float = 0.0) -> Floats:
    rng = np.random.default_rng(1)
    phase = rng.uniform(0.0, 2.0 * math.pi, (RUNS, 1))
    return np.asarray(size * np.cos(2.0 * math.pi * frequency * TIME + phase) + white * rng.normal(size=(RUNS, TIME.size)))


@pytest.mark.parametrize("away", [0.6, 0.8, 1.3, 1.5, -1.5, 2.5, -3.5, 6.4, 9.5])
@pytest.mark.parametrize("white", [0.0, 0.05])
@pytest.mark.parametrize("order", [1, 2])
def test_a_line_beside_the_order_is_claimed(away: float, white: float, order: int) -> None:
    """`away` blocks' widths of 1 Hz, a tenth of the 1×, with and without white noise of 23 dB."""
    noise = lines(order * SPEED / (2.0 * math.pi) + away, white=white)
    assert 0.7 < claim_over_error(noise, order=order) < 1.5


def test_harmonics_are_not_claimed() -> None:
    """3× of half the 1× says nothing of 1×: beside white noise of 0.05 it would claim seven times too much as white noise."""
    noise = lines(3.0 * SPEED / (2.0 * math.pi), size=0.5, white=0.05)
    assert 0.85 < claim_over_error(noise) < 1.25


@pytest.mark.parametrize(("kind", "corner"), [("lowpass", 80.0), ("highpass", 150.0), ("lowpass", 20.0)])
def test_noise_that_is_not_white_is_weighed_where_the_order_is(kind: Literal["lowpass", "highpass"], corner: float) -> None:
    rng = np.random.default_rng(2)
    sections = scipy.signal.butter(2, corner, kind, fs=RATE, output="sos")
    noise = scipy.signal.sosfilt(sections, 0.3 * rng.normal(size=(RUNS, TIME.size + 500)), axis=1)[:, 500:]
    for order in (1, 2):
        assert 0.8 < claim_over_error(noise, order=order) < 1.3


def test_the_error_of_a_coarse_converter_is_that_of_its_staircase() -> None:
    """Rms over amplitudes of the fundamental's error, against the closed form; noise of a step smooths it out."""
    at = np.linspace(0.0, 2.0 * math.pi, 20_000, endpoint=False)
    sizes = np.linspace(9.0, 12.0, 61)
    errors = [2.0 * np.mean(np.rint(size * np.cos(at)) * np.cos(at)) - size for size in sizes]
    coarse = np.rint(10.5 * np.cos(at[::10]))
    claimed = quantisation_error(coarse, amplitude=10.5, variance=1.0 / 12.0)
    assert claimed == pytest.approx(np.sqrt(np.mean(np.square(errors))), rel=0.15)
    assert quantisation_error(coarse, amplitude=10.5, variance=1.0) < 1e-6 * claimed
    assert quantisation_error(10.5 * np.cos(at[:2000]), amplitude=10.5, variance=0.0) == 0.0
    assert quantisation_error(np.zeros(100), amplitude=0.0, variance=0.0) == 0.0
