"""Speed laws against scipy's splines, and against closed forms."""

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator, PPoly, make_lsq_spline

from estimator.phasors.speed_law import SAMPLES_PER_KNOT, SpeedLaw


def _noisy(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return times and speeds of a coast-down with uneven pauses and noise, from fewest samples to many."""
    rng = np.random.default_rng(seed)
    time = 1e5 * rng.standard_normal() + np.cumsum(rng.uniform(0.02, 3.0, rng.integers(17, 900)))
    return time, 300.0 * np.exp(-(time - time[0]) / 500.0) + rng.standard_normal(time.size)


@pytest.mark.parametrize("seed", range(20))
def test_the_nearest_spline_is_scipys(seed: int) -> None:
    time, speed = _noisy(seed)
    inner = time[SAMPLES_PER_KNOT:-SAMPLES_PER_KNOT:SAMPLES_PER_KNOT]
    knots = np.concatenate([np.repeat(time[0], 4), inner, np.repeat(time[-1], 4)])
    theirs = PPoly.from_spline(make_lsq_spline(time, speed, knots, k=3).antiderivative().tck)
    at = np.concatenate([time, np.random.default_rng(seed).uniform(time[0], time[-1], 500)])
    law = SpeedLaw.measured(time, speed)
    assert (law.begin, law.end) == (time[0], time[-1])
    scale = float(np.abs(theirs(at, 2)).max())
    np.testing.assert_allclose(law.speed(at), theirs(at, 1), rtol=1e-8)
    np.testing.assert_allclose(law.acceleration(at), theirs(at, 2), atol=1e-7 * scale)
    np.testing.assert_allclose(law.angle(at), theirs(at), rtol=1e-9, atol=1e-6)


@pytest.mark.parametrize("count", [2, 3, 16])
def test_few_samples_are_gone_through(count: int) -> None:
    time, speed = np.linspace(3.0, 9.0, count), np.geomspace(300.0, 100.0, count)
    theirs = PchipInterpolator(time, speed)
    at = np.linspace(3.0, 9.0, 101).reshape(1, 101)
    for law in (SpeedLaw.measured(time, speed), SpeedLaw.through(time, speed)):
        np.testing.assert_allclose(law.speed(at), theirs(at), rtol=1e-12)
        np.testing.assert_allclose(law.acceleration(at), theirs(at, 1), rtol=1e-10)
        np.testing.assert_allclose(law.angle(at), theirs.antiderivative()(at), rtol=1e-12, atol=1e-9)


def test_a_cubic_speed_is_exact() -> None:
    time = np.linspace(0.0, 20.0, 200)
    law = SpeedLaw.measured(time, 300.0 - 4.0 * time + 0.3 * time**2 - 0.005 * time**3)
    at = np.linspace(0.0, 20.0, 77)
    np.testing.assert_allclose(law.angle(at), 300.0 * at - 2.0 * at**2 + 0.1 * at**3 - 0.00125 * at**4, rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(law.acceleration(at), -4.0 + 0.6 * at - 0.015 * at**2, atol=1e-9)
