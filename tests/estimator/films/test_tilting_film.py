"""Films of tilting-pad bearings: derivatives, symmetry, pads as states, brute force, printed tables, and where they end."""

import math

import numpy as np
import pytest

from estimator.arrays import Floats
from estimator.films.equilibrium import EquilibriumSearch
from estimator.films.film import InvalidSlenderness, OutsideFilm
from estimator.films.pad import InvalidPad
from estimator.films.tilting_film import TiltingFilm, TiltingProfile
from tests.estimator.films.tilting import (
    BETWEEN_PADS,
    FOUR,
    FOUR_ON,
    ON_PAD,
    TILTING,
    against_print,
    coarse_pivoted_table,
    tilting_film,
)
from tests.film_plant.tilting import RockerPads, tilted

NAMES = list(TILTING)


def places(film: TiltingFilm, count: int, *, seed: int = 0) -> Floats:
    """Positions (count, 2) all over a film, none of them close to where it ends."""
    drawn = np.random.default_rng(seed).uniform(-1.0, 1.0, (60 * count, 2))
    return drawn[film.covers(1.01 * drawn) & film.covers(drawn)][:count]


@pytest.mark.parametrize("name", NAMES)
def test_derivatives_are_those_of_what_is_interpolated(name: str) -> None:
    film = tilting_film(name)
    position, step = places(film, 200), 1e-6
    found = film.at(position)
    for axis, move in enumerate(step * np.eye(2)):
        after, before = film.at(position + move), film.at(position - move)
        for due, given in (
            (before.force - after.force, found.static_stiffness[..., axis]),
            (after.stiffness - before.stiffness, found.stiffness_slope[..., axis]),
            (after.damping - before.damping, found.damping_slope[..., axis]),
        ):
            size = np.abs(given).reshape(len(position), -1).max(axis=1)
            error = np.abs(due / (2 * step) - given).reshape(len(position), -1).max(axis=1)
            assert (error < 1e-5 * size + 1e-4).all()


@pytest.mark.parametrize("name", NAMES)
def test_pads_only_push_and_their_film_dissipates(name: str) -> None:
    film = tilting_film(name)
    found = film.at(places(film, 300))
    assert found.pads is not None
    assert np.linalg.eigvalsh(found.damping).min() >= 0.0
    assert np.allclose(found.stiffness, found.stiffness.swapaxes(-1, -2))
    assert np.linalg.eigvalsh(found.static_stiffness).min() > 0.0
    assert ((found.pads.weight >= 0.0) & (found.pads.weight <= 1.0)).all()


def test_the_load_between_four_pads_meets_the_same_stiffness_in_all_directions() -> None:
    film = TiltingFilm(FOUR, 0.5, table=coarse_pivoted_table)
    for load in (0.2, 1.0, 5.0):
        place = EquilibriumSearch(film).position(np.array([0.0, -load]))
        assert abs(place[0]) < 1e-9
        for matrix in (film.at(place).stiffness, film.at(place).damping):
            assert matrix == pytest.approx(matrix[0, 0] * np.eye(2), abs=1e-9 * matrix[0, 0])


def test_a_bearing_turned_by_the_pitch_of_its_pads_is_the_same() -> None:
    film, angle = tilting_film("five offset, on"), 2 * math.pi / 5
    matrix = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    position = places(film, 50)
    here, there = film.at(position), film.at(position @ matrix.T)
    assert np.allclose(there.force, here.force @ matrix.T, atol=1e-12)
    assert np.allclose(there.damping, matrix @ here.damping @ matrix.T, atol=1e-9)


@pytest.mark.parametrize("eigenvalue", [1j, 0.45j, -0.1 + 0.6j, 0.0])
def test_states_of_the_pads_are_what_their_reduction_eliminates(eigenvalue: complex) -> None:
    film = tilting_film("five offset, on")
    found = film.at(np.array([0.2, -0.4]))
    assert found.pads is not None
    held, axis = found.pads.held, found.pads.axis
    states = (held.drive + eigenvalue * held.drag) / (eigenvalue + held.rate)
    whole = held.stiffness + eigenvalue * held.damping - np.einsum("n,ni,nj->ij", held.push * states, axis, axis)
    assert np.allclose(whole, found.pads.reduced(eigenvalue), rtol=1e-12)
    if eigenvalue == 1j:
        assert np.allclose(whole, found.stiffness + 1j * found.damping, rtol=1e-12)


def test_slow_motions_meet_the_slope_of_the_force() -> None:
    film = TiltingFilm(TILTING["five offset, on"], 0.5)
    found = film.at(np.array([0.05, -0.3]))
    assert found.pads is not None
    assert found.pads.reduced(0.0).real == pytest.approx(found.static_stiffness, rel=0.02)


@pytest.mark.parametrize("position", [(0.02, -0.2), (0.05, -0.35)])
@pytest.mark.parametrize("name", ["five offset, on", "three, on"])
def test_pads_balanced_by_brute_force_carry_the_same(name: str, position: tuple[float, float]) -> None:
    """Against finite volumes, with the tilts found one by one and a matrix over the journal and all of them."""
    profile, place = TILTING[name], np.array(position)
    due = tilted(RockerPads(profile.count, profile.arc, profile.preload, profile.pivot, profile.first), 0.5, place, around=160)
    found, reduced = TiltingFilm(profile, 0.5).at(place), due.reduced(1.0)
    assert np.abs(found.force - due.force).max() < 0.01 * np.hypot(*due.force)
    assert np.abs(found.stiffness - reduced.real).max() < 0.01 * np.abs(reduced.real).max()
    assert np.abs(found.damping - reduced.imag).max() < 0.01 * np.abs(reduced.imag).max()


def test_printed_tables_of_four_pads() -> None:
    assert against_print(TiltingFilm(FOUR, 0.5), BETWEEN_PADS) < 0.06
    assert against_print(TiltingFilm(FOUR_ON, 1.0), ON_PAD) < 0.06


def test_an_unloaded_pad_carries_nothing_and_its_film_ends_smoothly() -> None:
    film = tilting_film("four, between")
    row = film.at(np.stack([np.zeros(4001), np.linspace(0.0, -0.9, 4001)], axis=-1))
    assert row.pads is not None
    upper = row.pads.weight[:, 1:3]
    assert upper[0] == pytest.approx([1.0, 1.0])
    assert upper[-1] == pytest.approx([0.0, 0.0])
    assert np.abs(np.diff(row.damping[:, 1, 1])).max() < 0.01 * row.damping[:, 1, 1].max()


def test_where_a_pad_s_film_is_too_thin_it_is_not_known() -> None:
    film = tilting_film("five, between")
    position = np.array([[0.0, -0.5], [0.0, -0.82], [0.0, -1.5]])
    assert film.covers(position).tolist() == [True, False, False]
    thinnest = film.thinnest(position)
    assert thinnest[0] > 0.03 > thinnest[1] > 0.0 > thinnest[2]
    with pytest.raises(OutsideFilm, match=r"0\.820 clearances from the bearing's centre, at -90°"):
        film.at(position)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"count": 2}, "2 tilting pads: a bearing has 3 to 12"),
        ({"arc": math.radians(80.0)}, "5 tilting pads of 80°.*overlap"),
        ({"preload": 0.9}, "preload of 0.9"),
        ({"pivot": 0.3}, "pivot at 0.3 of the arc"),
    ],
)
def test_pads_that_no_bearing_has_are_refused(wrong: dict[str, float], said: str) -> None:
    with pytest.raises(InvalidPad, match=said):
        TiltingProfile(**{"count": 5, "arc": math.radians(60.0), "preload": 0.3, "pivot": 0.5} | wrong)  # type: ignore[arg-type]


def test_a_bearing_longer_than_any_is_refused() -> None:
    with pytest.raises(InvalidSlenderness, match="length over diameter is 40"):
        TiltingFilm(FOUR, 40.0)
