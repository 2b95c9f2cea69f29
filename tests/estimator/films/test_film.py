"""Films of whole bearings: derivatives, symmetry, units, and where they end."""

import math

import numpy as np
import pytest

from estimator.films.dimensional_film import InvalidFilmData, dimensional_film, film_scale
from estimator.films.film import Film, InvalidSlenderness, OutsideFilm
from estimator.films.profiles import BearingProfile, elliptical, plain, three_lobe
from tests.estimator.films.films import PROFILES, coarse_table, film, positions
from tests.film_plant.profile import PLAIN
from tests.film_plant.reynolds import FilmSolver

NAMES = list(PROFILES)


@pytest.mark.parametrize("name", NAMES)
def test_derivatives_are_those_of_what_is_interpolated(name: str) -> None:
    one = film(name)
    places, step = positions(one, 200), 1e-6
    found = one.at(places)
    for axis, move in enumerate(step * np.eye(2)):
        after, before = one.at(places + move), one.at(places - move)
        for due, given in (
            ((before.force - after.force), found.stiffness[..., axis]),
            ((after.stiffness - before.stiffness), found.stiffness_slope[..., axis]),
            ((after.damping - before.damping), found.damping_slope[..., axis]),
        ):
            size = np.abs(given).reshape(len(places), -1).max(axis=1)
            error = np.abs(due / (2 * step) - given).reshape(len(places), -1).max(axis=1)
            assert (error < 1e-5 * size + 1e-7).all()


@pytest.mark.parametrize("name", NAMES)
def test_damping_is_symmetric_and_dissipates(name: str) -> None:
    one = film(name)
    damping = one.at(positions(one, 300)).damping
    assert np.abs(damping - damping.swapaxes(-1, -2)).max() < 1e-12 * np.abs(damping).max()
    assert np.linalg.eigvalsh(damping).min() > 0.0


@pytest.mark.parametrize(("name", "turn"), [("plain", 0.7), ("two_axial_grooves", math.pi), ("three_lobe", 2 * math.pi / 3)])
def test_a_symmetric_bearing_does_not_know_its_direction(name: str, turn: float) -> None:
    one, matrix = film(name), np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    places = positions(one, 50)
    here, there = one.at(places), one.at(places @ matrix.T)
    assert np.allclose(there.force, here.force @ matrix.T, rtol=0.0, atol=1e-9 * np.abs(here.force).max())
    for quantity in ("stiffness", "damping"):
        turned = matrix @ getattr(here, quantity) @ matrix.T
        assert np.allclose(getattr(there, quantity), turned, rtol=0.0, atol=1e-9 * np.abs(turned).max())


def test_a_turned_bearing_is_a_turned_film() -> None:
    turn = 0.4
    matrix = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    upright = film("three_lobe")
    turned = Film(three_lobe(preload=0.4, first=turn - math.pi / 2), 0.7, table=coarse_table)
    places = positions(upright, 50)
    assert turned.at(places @ matrix.T).force == pytest.approx(upright.at(places).force @ matrix.T, rel=1e-7, abs=1e-9)


def test_four_equal_lobes_are_isotropic_in_their_centre() -> None:
    found = film("four_lobe").at(np.zeros(2))
    assert np.abs(found.force).max() < 1e-12
    (kxx, kxy), (kyx, kyy) = found.stiffness
    assert (kxx, kxy) == pytest.approx((kyy, -kyx), rel=1e-9)
    assert kxx > 0.0
    assert kxy > 0.0
    assert found.damping == pytest.approx(found.damping[0, 0] * np.eye(2), abs=1e-9)
    assert np.abs(found.stiffness_slope).max() < 1e-6 * kxx  # by symmetry


def test_a_journal_in_the_centre_of_a_plain_bearing_carries_nothing_and_is_known() -> None:
    found = film("plain").at(np.array([[0.0, 0.0], [1e-12, 0.0]]))
    assert not found.force[0].any()
    assert np.isfinite(found.stiffness_slope).all()
    assert np.isfinite(found.damping_slope).all()
    assert found.stiffness[0] == pytest.approx(found.stiffness[1])


def test_an_elliptical_bearing_without_preload_has_two_grooves_only() -> None:
    places = positions(film("two_axial_grooves"), 40)
    grooved, lobed = (
        Film(one, 0.5, table=coarse_table).at(places) for one in (PROFILES["two_axial_grooves"][0], elliptical(preload=0.0))
    )
    assert np.array_equal(grooved.stiffness, lobed.stiffness)


def test_films_add_up_over_pads() -> None:
    profile = PROFILES["three_lobe"][0]
    places = positions(film("three_lobe"), 20)
    parts = [Film(BearingProfile((pad,)), 0.7, table=coarse_table).at(places).damping for pad in profile.pads]
    assert film("three_lobe").at(places).damping == pytest.approx(sum(parts))


def test_where_the_film_is_too_thin_it_is_not_known() -> None:
    one = film("plain")
    places = np.array([[0.0, -0.96], [0.0, -0.971], [0.7, 0.7], [0.0, 0.0]])
    assert one.covers(places).tolist() == [True, False, False, True]
    assert one.thinnest(places) == pytest.approx([0.04, 0.029, 1 - 0.7 * math.sqrt(2), 1.0])
    with pytest.raises(
        OutsideFilm, match=r"0\.971 clearances from the bearing's centre, at -90°: its film is 0\.029 .* than 0\.03"
    ):
        one.at(places)


def test_units() -> None:
    one, place = film("plain"), np.array([2e-5, -4e-5])
    data = {"radius": 0.04, "length": 0.04, "clearance": 9e-5, "viscosity": 0.009, "speed": 300.0}
    unit = 0.009 * 300.0 * 0.04 * 0.04 * (0.04 / 9e-5) ** 2
    assert float(film_scale(**data).force) == pytest.approx(unit)
    found, bare = dimensional_film(one, place, **data), one.at(place / 9e-5)
    assert found.force == pytest.approx(unit * bare.force)
    assert found.damping == pytest.approx(unit / 9e-5 / 300.0 * bare.damping)
    step = 1e-11
    for axis, move in enumerate(step * np.eye(2)):
        after, before = (dimensional_film(one, place + sign * move, **data) for sign in (1, -1))
        assert (before.force - after.force) / (2 * step) == pytest.approx(found.stiffness[:, axis], rel=1e-5)
        assert (after.stiffness - before.stiffness) / (2 * step) == pytest.approx(found.stiffness_slope[..., axis], rel=1e-4)
        assert (after.damping - before.damping) / (2 * step) == pytest.approx(found.damping_slope[..., axis], rel=1e-4)


def test_conditions_may_be_many() -> None:
    speed = np.array([100.0, 200.0, 300.0])
    places = np.array([[1e-5, -5e-5], [2e-5, -4e-5], [2e-5, -3e-5]])
    together = dimensional_film(film("plain"), places, radius=0.04, length=0.04, clearance=9e-5, viscosity=0.009, speed=speed)
    for index in range(3):
        alone = dimensional_film(
            film("plain"), places[index], radius=0.04, length=0.04, clearance=9e-5, viscosity=0.009, speed=float(speed[index])
        )
        assert together.stiffness[index] == pytest.approx(alone.stiffness)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"clearance": 0.005}, "radial clearance of 0.005 m in a bearing of radius 0.04 m.*thousandth"),
        ({"viscosity": -0.01}, "viscosity is -0.01: it must be positive"),
        ({"speed": np.array([100.0, 0.0])}, "speed is 0"),
    ],
)
def test_what_no_film_has_is_refused(wrong: dict[str, float], said: str) -> None:
    data = {"radius": 0.04, "length": 0.04, "clearance": 9e-5, "viscosity": 0.009, "speed": 300.0}
    with pytest.raises(InvalidFilmData, match=said):
        film_scale(**{**data, **wrong})


def test_a_film_that_forms_again_by_itself_damps_more() -> None:
    """Against the film plant's finite volumes, on a ring without an edge."""
    places = np.array([[0.0, -0.2], [0.3, -0.3], [0.1, -0.7]])
    solver = FilmSolver(PLAIN, 0.5)
    found, begun = Film(plain(continuous=True), 0.5).at(places), film("plain").at(places)
    for index, place in enumerate(places):
        due = solver.solve(place)
        for quantity in ("force", "stiffness", "damping"):
            one, other = getattr(found, quantity)[index], getattr(due, quantity)
            assert np.abs(one - other).max() < 0.01 * np.abs(other).max()
        assert np.trace(found.damping[index]) > np.trace(begun.damping[index])
    with pytest.raises(InvalidSlenderness, match="known up to 2"):
        Film(plain(continuous=True), 3.0)


def test_a_bearing_longer_than_any_is_refused() -> None:
    with pytest.raises(InvalidSlenderness, match="length over diameter is 40"):
        Film(plain(), 40.0)
