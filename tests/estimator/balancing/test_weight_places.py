"""Weights at the places of a plane: what they give together, the lightest of them, whole steps, and what cannot be given."""

import cmath
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.balancing.weight_places import PlacesUnusable, WeightPlaces, combine_weights, split_weight
from tests.estimator.trains import few_examples


@few_examples
@given(st.integers(3, 24), st.floats(0.0, 360.0), st.floats(1e-8, 1.0))
def test_two_neighbouring_places_give_any_unbalance(count: int, angle: float, size: float) -> None:
    wanted = cmath.rect(size, math.radians(angle))
    found = split_weight(wanted, WeightPlaces.evenly(count, radius=0.03))
    assert found.unbalance == pytest.approx(wanted, rel=1e-6, abs=1e-6 * size)
    used = np.flatnonzero(found.masses > 1e-9 * found.masses.max())
    assert used.size <= 2
    assert used.size < 2 or (used[1] - used[0]) % count in (1, count - 1)
    # The law of sines for two weights that are 360°/n apart.
    step = 2 * math.pi / count
    inside = math.radians(angle) % step
    expected = size / 0.03 * (math.sin(step - inside) + math.sin(inside)) / math.sin(step)
    assert found.masses.sum() == pytest.approx(expected, rel=1e-5)


def test_places_that_are_full_send_the_rest_to_others() -> None:
    free = split_weight(1e-3 + 0j, WeightPlaces.evenly(12, radius=0.1))
    assert np.count_nonzero(free.masses > 1e-9) == 1
    full = split_weight(1e-3 + 0j, WeightPlaces.evenly(12, radius=0.1, largest=0.005))
    assert full.shortfall < 1e-6
    assert full.masses.max() <= 0.005 * (1 + 1e-9)
    assert np.count_nonzero(full.masses > 1e-9) >= 3


def test_what_the_places_cannot_give_is_missed_by_as_little_as_possible() -> None:
    found = split_weight(1e-3 + 0j, WeightPlaces(np.array([90.0, 60.0]), radius=0.1, largest=0.01))
    assert found.shortfall == pytest.approx(math.sin(math.radians(60.0)), rel=1e-6)
    assert found.masses == pytest.approx([0.0, 0.005], abs=1e-9)


def test_whole_steps_are_the_best_of_all_near_ones() -> None:
    places = WeightPlaces.evenly(8, radius=0.05, step=0.001)
    wanted = cmath.rect(3.4e-4, math.radians(20.0))
    found = split_weight(wanted, places)
    assert found.masses / 0.001 == pytest.approx(np.round(found.masses / 0.001))
    arms = 0.05 * np.exp(1j * np.radians(places.angles_deg))
    best = min(abs(a * 0.001 * arms[0] + b * 0.001 * arms[1] - wanted) for a in range(12) for b in range(12))
    assert abs(found.unbalance - wanted) <= best * (1 + 1e-9)
    assert found.shortfall < 0.1


def test_several_weights_combine_into_one() -> None:
    together = combine_weights([0.01, 0.01, 0.005], radii=[0.1, 0.1, 0.2], angles_deg=[0.0, 120.0, 240.0])
    assert together == pytest.approx(0.0, abs=1e-12)


def test_places_that_are_none_are_named() -> None:
    for wrong in ({"angles_deg": np.array([])}, {"radius": 0.0}, {"largest": 1e-3, "step": 2e-3}):
        with pytest.raises(PlacesUnusable, match="at least one angle"):
            WeightPlaces(**({"angles_deg": np.array([0.0]), "radius": 0.1} | wrong))  # type: ignore[arg-type]
    assert split_weight(0j, WeightPlaces.evenly(4, radius=0.1)).masses.sum() == 0.0
