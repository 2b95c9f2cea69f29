"""Viscosity over speed: a power law in closed form, an expected course; the balance that gives a film's temperature."""

import numpy as np
import pytest

from estimator.films.film import Film
from estimator.films.heat_balance import FED, HEAT_CAPACITY, film_temperature
from estimator.films.oil import STANDARD_DENSITY, grade_oil
from estimator.films.profiles import plain
from estimator.films.viscosity_over_speed import ViscosityOverSpeed
from tests.film_plant.oil import HeatedOil
from tests.film_plant.train import Bearing

SPEED = np.array([80.0, 200.0, 400.0])
RADIUS, LENGTH, CLEARANCE = 0.05, 0.05, 8e-5


def warmed(*, load: float, carried: float = 0.8, speed: np.ndarray = SPEED) -> np.ndarray:
    return film_temperature(
        Film(plain(continuous=True), 0.5),
        oil=grade_oil(46),
        inlet=45.0,
        carried=carried,
        load=np.array([0.0, -load]),
        radius=RADIUS,
        length=LENGTH,
        clearance=CLEARANCE,
        speed=speed,
    )


def test_viscosity_falls_with_a_power_of_the_speed() -> None:
    oil = ViscosityOverSpeed(0.02, 300.0, slope=0.3)
    assert oil.at(300.0) == pytest.approx(0.02)
    assert oil.at(600.0) == pytest.approx(0.02 * 2**-0.3)
    thicker = oil.changed(factor=1.1, slope=0.3 + 1e-6)
    assert np.log(thicker.at(SPEED) / oil.at(SPEED) / 1.1) / 1e-6 == pytest.approx(oil.by_slope(SPEED), rel=1e-6)


def test_viscosity_follows_the_expected_course_and_is_level_beyond_it() -> None:
    course = np.array([100.0, 200.0, 400.0]), np.array([0.03, 0.025, 0.018])
    oil = ViscosityOverSpeed(0.05, 200.0, course=course)
    assert oil.at(course[0]) == pytest.approx(2.0 * course[1])
    assert oil.at(50.0) == pytest.approx(0.06)
    assert oil.at(900.0) == pytest.approx(0.036)


def test_without_load_the_balance_is_that_of_a_concentric_journal() -> None:
    (found,) = warmed(load=0.0, speed=SPEED[1:2])
    viscosity = float(grade_oil(46).viscosity(found))
    friction = 2 * np.pi * viscosity * SPEED[1] ** 2 * RADIUS**3 * LENGTH / CLEARANCE
    carried = STANDARD_DENSITY * HEAT_CAPACITY * FED * SPEED[1] * RADIUS * CLEARANCE * LENGTH * (found - 45.0)
    assert carried == pytest.approx(0.8 * friction, rel=1e-4)


def test_films_warm_with_speed_as_another_balance_says() -> None:
    found = warmed(load=4000.0)
    assert np.all(np.diff(found) > 2.0)
    assert found[0] > 46.0
    assert np.all(warmed(load=4000.0, carried=0.4) < found)
    film, oil = Film(plain(continuous=True), 0.5), HeatedOil(46, 45.0, carried=0.8, feed=FED)
    bearing = Bearing(0, 0.1, 2 * RADIUS, LENGTH, CLEARANCE, oil)
    for speed, temperature in zip(SPEED, found, strict=True):
        ways = np.linspace(0.02, 0.95, 200)
        others = [oil.temperature(bearing, speed=speed, eccentricity=way) for way in ways]
        force = [
            oil_force(film, way, viscosity=float(grade_oil(46).viscosity(other)), speed=speed)
            for way, other in zip(ways, others, strict=True)
        ]
        assert float(np.interp(4000.0, force, others)) == pytest.approx(temperature, abs=0.5)


def oil_force(film: Film, way: float, *, viscosity: float, speed: float) -> float:
    """Load [N] that the film carries with the journal on a part of the way to the wall."""
    unit = viscosity * speed * RADIUS * LENGTH * (RADIUS / CLEARANCE) ** 2
    return float(unit * np.linalg.norm(film.at(np.array([0.0, -way])).force))


def test_a_load_that_no_warm_film_carries_leaves_the_oil_cool() -> None:
    (found,) = warmed(load=3e5, speed=np.array([5.0]))
    assert 45.0 <= found < 50.0
