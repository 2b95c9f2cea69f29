"""Positions of equilibrium under loads of any size and direction."""

from functools import cache

import numpy as np
import pytest

from estimator.films.equilibrium import EquilibriumSearch, FilmOverloaded
from tests.estimator.films.films import PROFILES, film

DIRECTIONS = np.arange(24) * (2 * np.pi / 24) + 0.02
RAYS = np.stack([np.cos(DIRECTIONS), np.sin(DIRECTIONS)], axis=-1)
NAMES = list(PROFILES)


@cache
def searched(name: str) -> EquilibriumSearch:
    """The search in the film of a profile."""
    return EquilibriumSearch(film(name))


@pytest.mark.parametrize("name", NAMES)
def test_the_film_carries_any_load_in_any_direction(name: str) -> None:
    search = searched(name)
    loads = np.array([1e-9, 1e-6, 1e-3, 0.05, 0.5, 1.5])[:, None, None] * RAYS
    found = search.position(loads)
    assert found.shape == loads.shape
    balance = search.film.at(found).force + loads
    assert (np.linalg.norm(balance, axis=-1) < 1e-8 * np.linalg.norm(loads, axis=-1) + 1e-14).all()
    assert np.linalg.det(search.film.at(found).stiffness).min() > 0.0


@pytest.mark.parametrize("name", NAMES)
def test_without_a_load_the_journal_floats_in_the_centre(name: str) -> None:
    assert np.abs(searched(name).position(np.zeros(2))).max() < 1e-9


def test_a_hardly_loaded_journal_goes_sideways() -> None:
    """By 88.5°, as Raimondi and Boyd print for L/D = 1/2."""
    x, y = searched("plain").position(np.array([0.0, -1e-6]))
    assert x > 0.0
    assert np.degrees(np.arctan2(x, -y)) == pytest.approx(88.5, abs=0.3)


def test_a_start_close_by_leads_to_the_same_position() -> None:
    search, load = searched("elliptical"), np.array([0.3, -1.2])
    found = search.position(load)
    assert search.position(load, start=found + 0.05) == pytest.approx(found, abs=1e-9)
    assert search.position(load, start=np.array([3.0, 0.0])) == pytest.approx(found, abs=1e-9)  # no place of a journal


@pytest.mark.parametrize("name", NAMES)
def test_there_is_one_position_of_equilibrium(name: str) -> None:
    search = searched(name)
    for load in 0.7 * RAYS[::6]:
        found = search.position(load)
        everywhere = np.concatenate([np.zeros((1, 2)), *(part * RAYS for part in (0.3, 0.6, 0.9))])
        ends = search.position(np.broadcast_to(load, everywhere.shape), start=everywhere)
        assert np.abs(ends - found).max() < 1e-8


def test_a_load_that_no_film_carries_is_named() -> None:
    search = searched("plain")
    with pytest.raises(FilmOverloaded, match=r"a load of 200 μωRL\(R/c\)² at -90° \(Sommerfeld number 0\.00159\d\)") as raised:
        search.position(np.array([[0.0, -1.0], [0.0, -200.0]]))
    assert raised.value.carried.tolist() == [True, False]
