"""Turns and crossings of a curve, against the curve itself on a fine grid."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.updated_model.monotone_segments import TurningCurve

HEIGHTS = st.lists(st.floats(0.0, 1.0), min_size=6, max_size=20)


@given(HEIGHTS)
def test_between_two_cuts_a_curve_rises_or_falls(heights: list[float]) -> None:
    curve = TurningCurve.through(np.arange(float(len(heights))), np.array(heights))
    for first, last in zip(curve.cuts, curve.cuts[1:], strict=False):
        steps = np.diff(curve.spline(np.linspace(first, last, 50)))
        assert np.all(steps >= -1e-12) or np.all(steps <= 1e-12)


@given(HEIGHTS, st.floats(0.05, 0.95), st.booleans())
def test_the_first_crossing_is_found_unless_the_curve_rises_too_high_before(
    heights: list[float], part: float, upwards: bool
) -> None:
    curve = TurningCurve.through(np.arange(float(len(heights))), np.array(heights))
    fine = np.linspace(0.0, len(heights) - 1.0, 20_001)
    for top in curve.tops:
        height = float(curve.spline(top))
        level, highest = height - part * abs(height), height * 1.1
        if height <= level:
            continue
        found = curve.first_below(level, start=float(top), highest=highest, upwards=upwards)
        walk = fine[fine > top] if upwards else fine[fine < top][::-1]
        seen = curve.spline(walk)
        if found is None:
            low = seen < level - 1e-9
            first = int(np.argmax(low)) if low.any() else len(walk)
            assert first == len(walk) or np.max(seen[:first]) > highest - 1e-3 * abs(highest)
        else:
            assert curve.spline(found) == pytest.approx(level, abs=1e-9)
            before = seen[np.abs(walk - top) < abs(found - top) - 1e-3]
            assert np.all(before > level - 1e-9)
            assert np.all(before <= highest + 1e-9)


def test_a_turn_at_a_point_is_found_once() -> None:
    place = np.linspace(0.0, 10.0, 11)
    curve = TurningCurve.through(place, 1.0 - (place - 5.0) ** 2 / 30.0)
    assert curve.tops == pytest.approx([5.0])
