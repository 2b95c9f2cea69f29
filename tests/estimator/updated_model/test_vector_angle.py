"""The angle of an unbalance and its interval: closed forms, and how often it holds the truth."""

import numpy as np
import pytest

from estimator.updated_model.vector_angle import angle_deg, angle_half_width_deg

Z95 = 1.959963984540054


def test_angles_are_counted_from_the_mark_to_y() -> None:
    vectors = np.array([1.0, 1j, -1.0, -1j, 1 - 1e-20j, complex(np.nan, np.nan)])
    np.testing.assert_allclose(angle_deg(vectors), [0.0, 90.0, 180.0, 270.0, 0.0, np.nan], atol=1e-12)


def test_closed_forms() -> None:
    vectors = np.array([2.0, 2j, 2.0, 2.0, 0.0, complex(np.nan, np.nan)])
    upper = np.array([2.0, 3.0, 4.0, 5.0, 1.0, np.nan])
    np.testing.assert_allclose(angle_half_width_deg(vectors, upper), [0.0, 30.0, 180.0, 180.0, 180.0, np.nan])


@pytest.mark.parametrize("distance", [2.5, 4.0, 10.0, 100.0])
def test_intervals_hold_the_truth(distance: float) -> None:
    """distance: of the truth from zero, in standard errors."""
    rng = np.random.default_rng(20)
    count = 40_000
    truth = np.asarray(distance * np.exp(1j * np.radians(rng.uniform(0, 360, count))), dtype=complex)
    found = truth + rng.standard_normal(count) + 1j * rng.standard_normal(count)
    off = np.abs((angle_deg(found) - angle_deg(truth) + 180) % 360 - 180)
    held = np.mean(off <= angle_half_width_deg(found, np.abs(found) + Z95))
    assert 0.945 <= held <= (0.955 if distance >= 4 else 0.97)
