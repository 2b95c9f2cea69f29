"""Shape-preserving cubics against scipy's."""

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from estimator.bearings.monotone_cubic import MonotoneCubic


@pytest.mark.parametrize("seed", range(20))
def test_it_is_the_same_as_scipys(seed: int) -> None:
    rng = np.random.default_rng(seed)
    place = np.cumsum(rng.uniform(0.05, 2.0, rng.integers(3, 30)))
    values = np.exp(rng.standard_normal((place.size, 8))) * rng.choice([-1.0, 1.0], (place.size, 8))
    values[:, 0] = 2.0  # level
    values[:, 1] = np.sort(values[:, 1])
    at = np.concatenate([place, rng.uniform(place[0], place[-1], 200)])
    np.testing.assert_allclose(MonotoneCubic(place, values)(at), PchipInterpolator(place, values)(at), rtol=1e-12, atol=1e-12)


def test_what_ascends_is_not_left_by_more_than_its_ends() -> None:
    place = np.arange(6.0)
    values = np.array([[0.0], [0.0], [1.0], [1.0], [1.5], [20.0]])
    found = MonotoneCubic(place, values)(np.linspace(0.0, 5.0, 501))[:, 0]
    assert np.all(np.diff(found) >= -1e-15)
    assert found.min() >= 0.0
    assert found.max() <= 20.0
