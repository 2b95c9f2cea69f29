"""The least largest vibration: no other correction is better, and the conditions of an optimum hold."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.arrays import Complexes
from estimator.balancing.least_largest import least_largest
from tests.estimator.trains import few_examples


def drawn(points: int, planes: int, seed: int) -> tuple[Complexes, Complexes]:
    rng = np.random.default_rng(seed)
    matrix = rng.standard_normal((points, planes)) + 1j * rng.standard_normal((points, planes))
    return np.asarray(matrix), rng.standard_normal(points) + 1j * rng.standard_normal(points)


@few_examples
@given(st.integers(1, 4), st.integers(0, 1000), st.floats(0.05, 3.0))
def test_no_other_correction_leaves_less(planes: int, seed: int, size: float) -> None:
    matrix, target = drawn(10, planes, seed)
    limit = np.where(np.arange(planes) % 2 == 0, np.inf, size)
    found = least_largest(matrix, target, limit)
    assert np.all(np.abs(found) <= limit * (1 + 1e-12))
    least = np.abs(matrix @ found - target).max()
    rng = np.random.default_rng(seed + 1)
    for step in (1e-3, 1e-2, 1e-1):
        for _ in range(100):
            other = found + step * (rng.standard_normal(planes) + 1j * rng.standard_normal(planes))
            other *= np.minimum(1.0, limit / np.abs(other))
            assert np.abs(matrix @ other - target).max() >= least * (1 - 3e-6)


def test_it_is_below_least_squares_at_the_worst_point_and_above_it_in_squares() -> None:
    matrix, target = drawn(12, 3, 7)
    found = least_largest(matrix, target, np.full(3, np.inf))
    squares = np.linalg.lstsq(matrix, target, rcond=None)[0]
    assert np.abs(matrix @ found - target).max() < 0.9 * np.abs(matrix @ squares - target).max()
    assert np.linalg.norm(matrix @ found - target) > np.linalg.norm(matrix @ squares - target)


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
def test_units_do_not_matter(scale: float) -> None:
    matrix, target = drawn(8, 2, 3)
    expected = least_largest(matrix, target, np.array([0.2, np.inf]))
    found = least_largest(np.asarray(matrix * scale), np.asarray(target * 1e-6), np.array([0.2e-6 / scale, np.inf]))
    assert found * scale * 1e6 == pytest.approx(expected, rel=1e-3, abs=1e-4)


def test_nothing_to_do_and_nothing_allowed() -> None:
    matrix, target = drawn(8, 2, 3)
    assert np.all(least_largest(matrix, np.zeros(8, dtype=complex), np.full(2, np.inf)) == 0.0)
    assert np.all(least_largest(matrix, target, np.zeros(2)) == 0.0)
