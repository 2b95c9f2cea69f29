"""Vectors of a run at running speed."""

import numpy as np
import pytest

from estimator.phasors.harmonic_ratio import Orders
from estimator.phasors.near_speed import NEAR
from estimator.phasors.running_speed import mean_level, running_speed_vectors, speed_of_trend

SPEED = 300.0


def run(speed: list[float], first: list[complex], second: list[complex] | None = None) -> Orders:
    """Samples of one channel."""
    none = [complex(np.nan, np.nan)] * len(speed)
    return Orders(np.array(speed), np.array(first)[:, None], np.array(none if second is None else second)[:, None])


def test_only_samples_near_running_speed_count() -> None:
    near, far = SPEED * (1 + 0.9 * NEAR), SPEED * (1 + 1.1 * NEAR)
    found = running_speed_vectors(run([SPEED, near, far], [1e-5, 3e-5, 9e-5]), running_speed=SPEED)
    assert found is not None
    assert found.samples == 2
    assert found.speed == pytest.approx((SPEED + near) / 2)
    assert found.first[0] == pytest.approx(2e-5)
    assert np.isnan(found.second[0])


def test_vectors_are_averaged_and_not_amplitudes() -> None:
    found = running_speed_vectors(run([SPEED, SPEED], [1e-5, -1e-5], [2e-6j, complex(np.nan, np.nan)]), running_speed=SPEED)
    assert found is not None
    assert abs(found.first[0]) == pytest.approx(0.0, abs=1e-12)
    assert found.second[0] == pytest.approx(2e-6j)


def test_a_run_that_did_not_come_there_has_none() -> None:
    assert running_speed_vectors(run([0.5 * SPEED], [1e-5]), running_speed=SPEED) is None


def test_runs_are_compared_where_all_of_them_came() -> None:
    assert speed_of_trend(np.array([310.0, 300.0, 320.0])) == 300.0
    with pytest.raises(ValueError, match="zero-size"):
        speed_of_trend(np.array([]))


def test_levels_are_averaged_where_there_are_some() -> None:
    found = mean_level(np.array([[1.0, np.nan, np.nan], [3.0, 5.0, np.nan]]))
    assert found[:2].tolist() == [2.0, 5.0]
    assert np.isnan(found[2])
    assert np.isnan(mean_level(np.empty((0, 2)))).all()
