"""Noise and outliers from neighbouring speeds."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from estimator.phasors.local_noise import is_resolved, isolated_samples, local_fit, neighbour_noise
from tests.estimator.sweeps import noisy, single_mass, steady
from tests.estimator.trains import few_examples

SPEED = np.linspace(60.0, 300.0, 300)


def curve(damping_ratio: float) -> np.ndarray[tuple[int, ...], np.dtype[np.complex128]]:
    return steady(single_mass(natural_frequency=150.0, damping_ratio=damping_ratio), SPEED)[:, 0]


def test_a_cubic_leaves_no_difference() -> None:
    phasor = 1 + 2j * SPEED - 0.1 * SPEED**2 + 1e-3j * SPEED**3
    fit = local_fit(SPEED, phasor, np.ones(SPEED.size, dtype=bool))
    assert np.abs(fit.difference).max() < 1e-8 * np.abs(phasor).max()


@pytest.mark.parametrize(("relative", "floor"), [(0.01, 0.0), (0.05, 0.0), (0.01, 1e-6), (0.0, 1e-6)])
def test_noise_comes_out_at_its_size(relative: float, floor: float) -> None:
    ratios = []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        clean = curve(0.2)
        phasor = noisy(clean, seed, relative) + floor / np.sqrt(2) * (rng.standard_normal(300) + 1j * rng.standard_normal(300))
        fit = local_fit(SPEED, phasor, np.ones(300, dtype=bool))
        assert is_resolved(fit, SPEED, phasor)
        part, least = neighbour_noise(fit, np.abs(phasor))
        ratios.append(np.median(np.hypot(part * np.abs(clean), least) / np.hypot(relative * np.abs(clean), floor)))
    assert 0.85 < np.median(ratios) < 1.3
    assert min(ratios) > 0.7
    assert max(ratios) < 1.5


def test_sparse_samples_are_known_to_be_sparse() -> None:
    phasor = noisy(curve(0.02), 1, 1e-4)
    assert not is_resolved(local_fit(SPEED[::8], phasor[::8], np.ones(38, dtype=bool)), SPEED[::8], phasor[::8])


@few_examples
@given(st.integers(4, 295), st.floats(0.2, 1.0), st.floats(-np.pi, np.pi), st.integers(0, 1000))
@example(place=4, size=0.5, angle=1.0, seed=0)
@example(place=295, size=1.0, angle=-2.0, seed=6)
def test_a_wrong_phasor_is_found_and_it_alone(place: int, size: float, angle: float, seed: int) -> None:
    phasor = noisy(curve(0.1), seed)
    phasor[place] *= 1 + size * np.exp(1j * angle)
    fit = local_fit(SPEED, phasor, np.ones(300, dtype=bool))
    assert isolated_samples(fit, 0.01 * np.abs(phasor)).tolist() == [place]


@few_examples
@given(st.floats(0.01, 0.3), st.integers(0, 1000))
def test_a_sharp_resonance_is_no_outlier(damping_ratio: float, seed: int) -> None:
    # At 1 % half of the half-power width is two steps of the speed.
    phasor = noisy(curve(damping_ratio), seed)
    fit = local_fit(SPEED, phasor, np.ones(300, dtype=bool))
    assert isolated_samples(fit, 0.01 * np.abs(phasor)).size == 0


def test_few_points_say_nothing() -> None:
    fit = local_fit(SPEED[:6], np.ones(6, dtype=complex), np.ones(6, dtype=bool))
    assert np.isnan(neighbour_noise(fit, np.ones(6))).all()
    assert isolated_samples(fit, np.ones(6)).size == 0
    assert not is_resolved(fit, SPEED[:6], np.ones(6, dtype=complex))
