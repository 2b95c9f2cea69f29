"""Acceptance regions in the polar plane."""

import numpy as np
import pytest

from estimator.trends.acceptance_region import FEWEST, PART, acceptance_region

CENTRE = 3e-5 * np.exp(-0.7j)


def vectors(generator: np.random.Generator, count: int) -> np.ndarray:
    """Vectors that scatter more along one axis than across it."""
    scatter = 2e-6 * generator.normal(size=count) + 0.4e-6j * generator.normal(size=count)
    return np.asarray(CENTRE + scatter * np.exp(0.5j))


@pytest.mark.parametrize("count", [FEWEST, 6, 20])
def test_it_holds_as_many_of_the_next_vectors_as_it_says(count: int) -> None:
    generator = np.random.default_rng(1)
    inside = []
    for _ in range(4000):
        *before, following = vectors(generator, count + 1)
        region = acceptance_region(np.array(before))
        assert region is not None
        inside.append(region.holds(following))
    assert np.mean(inside) == pytest.approx(PART, abs=0.02)


def test_it_lies_along_the_scatter() -> None:
    region = acceptance_region(vectors(np.random.default_rng(2), 2000))
    assert region is not None
    assert region.inclination == pytest.approx(0.5, abs=0.03)
    assert region.semi_major / region.semi_minor == pytest.approx(5.0, rel=0.1)
    assert region.centre == pytest.approx(CENTRE, abs=3e-7)


def test_vectors_without_scatter_have_a_small_region() -> None:
    region = acceptance_region(np.full(8, CENTRE))
    assert region is not None
    assert region.holds(CENTRE)
    assert not region.holds(1.02 * CENTRE)


def test_too_few_or_none_have_no_region() -> None:
    assert acceptance_region(np.full(FEWEST - 1, CENTRE)) is None
    assert acceptance_region(np.zeros(8, complex)) is None
