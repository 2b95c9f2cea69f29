"""Solutions of Reynolds' equation on single pads, against closed forms, printed values and themselves."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from estimator.arrays import Floats
from estimator.films.pad import FULL_ARC
from estimator.films.reynolds import PadFilm, PadSolver

ECCENTRICITIES = [0.3, 0.6]


def plain(slenderness: float, eccentricity: float, *, rupture: bool = True) -> PadFilm:
    """The film of a plain bearing."""
    return PadSolver(arc=FULL_ARC, slenderness=slenderness, rupture=rupture).solve(eccentricity)


@pytest.mark.parametrize("e", ECCENTRICITIES)
def test_a_short_bearing_carries_what_ocvirk_says(e: float) -> None:
    found = plain(0.1, e)
    radial, tangential = -2 * e**2 / (1 - e**2) ** 2, math.pi * e / (2 * (1 - e**2) ** 1.5)
    assert found.force == pytest.approx(2 * 0.1**2 * np.array([radial, tangential]), rel=0.02)
    damping = 2 * math.pi * 0.1**2 * (1 + 2 * e**2) / (1 - e**2) ** 2.5
    assert found.radial_damping == pytest.approx(damping, rel=0.03)


@pytest.mark.parametrize("e", ECCENTRICITIES)
def test_a_full_film_in_a_long_bearing_carries_what_sommerfeld_says(e: float) -> None:
    found = plain(80.0, e, rupture=False)
    due = 12 * math.pi * e / ((2 + e**2) * math.sqrt(1 - e**2))
    assert found.force == pytest.approx([0.0, due], abs=0.02 * due)


@pytest.mark.parametrize("e", [0.3, 0.6, 0.9])
def test_a_long_bearing_with_rupture_agrees_with_one_dimension(e: float) -> None:
    found, due = plain(400.0, e), one_dimension(e)
    assert found.force == pytest.approx(due, abs=0.01 * np.hypot(*due))


def one_dimension(e: float) -> Floats:
    """Force (radial, tangential) of an endless film from the thickest place to where Reynolds' condition ends it."""

    def thickness(angle: float) -> float:
        return 1 - e * math.cos(angle)

    def slope(angle: float, end: float) -> float:
        return 6 * (thickness(angle) - thickness(end)) / thickness(angle) ** 3

    def final(end: float) -> float:
        return float(quad(slope, -math.pi, end, args=(end,), epsabs=1e-11, limit=200)[0])

    end = brentq(final, 0.01, math.pi - 0.01, xtol=1e-13)
    # By parts: -∫ p cos = ∫ p' sin and -∫ p sin = -∫ p' cos.
    radial = quad(lambda angle: slope(angle, end) * math.sin(angle), -math.pi, end, limit=200)[0]
    tangential = quad(lambda angle: -slope(angle, end) * math.cos(angle), -math.pi, end, limit=200)[0]
    return np.array([radial, tangential])


RAIMONDI_AND_BOYD = [
    (1.0, 0.2, 0.631, 74.02),
    (1.0, 0.4, 0.264, 63.10),
    (1.0, 0.6, 0.121, 50.58),
    (1.0, 0.8, 0.0446, 36.24),
    (0.5, 0.2, 2.03, 74.94),
    (0.5, 0.4, 0.779, 61.45),
    (0.5, 0.6, 0.319, 48.14),
    (0.5, 0.8, 0.0923, 33.31),
]
"""A. A. Raimondi, J. Boyd, ASLE Trans. 1 (1958) 159: L/D, eccentricity, Sommerfeld number (N in rev/s), attitude [°]."""


@pytest.mark.parametrize(("slenderness", "eccentricity", "sommerfeld", "attitude"), RAIMONDI_AND_BOYD)
def test_printed_loads_of_a_plain_bearing(slenderness: float, eccentricity: float, sommerfeld: float, attitude: float) -> None:
    radial, tangential = plain(slenderness, eccentricity).force
    assert 1 / (math.pi * math.hypot(radial, tangential)) == pytest.approx(sommerfeld, rel=0.02)
    assert math.degrees(math.atan2(tangential, -radial)) == pytest.approx(attitude, rel=0.02)


PLACES = [(160.0, 0.5, 0.3), (160.0, 0.9, -1.2), (160.0, 0.9, 1.2), (70.0, 0.8, 0.1), (100.0, 0.05, 0.5), (60.0, 0.6, 2.9)]
"""Arc [°], eccentricity, direction [rad]."""


@pytest.mark.parametrize(("arc", "e", "direction"), PLACES)
def test_the_film_is_where_its_pressure_is_positive(arc: float, e: float, direction: float) -> None:
    found = PadSolver(arc=math.radians(arc), slenderness=1.0).solve(e, direction)
    assert found.pressure.min() == 0.0
    assert 0.0 < (found.pressure > 0.0).mean() < 1.0


@pytest.mark.parametrize(("arc", "e", "direction"), PLACES)
def test_a_finer_mesh_changes_little(arc: float, e: float, direction: float) -> None:
    usual = PadSolver(arc=math.radians(arc), slenderness=1.0)
    fine = PadSolver(arc=math.radians(arc), slenderness=1.0, around=960, along=10)
    one, other = usual.solve(e, direction), fine.solve(e, direction)
    assert np.abs(one.force - other.force).max() < 2e-3 * np.abs(other.force).max()
    assert np.abs(one.damping - other.damping).max() < 3e-3 * np.abs(other.damping).max()


@pytest.mark.parametrize(("arc", "e", "direction"), PLACES)
def test_stiffness_is_the_derivative_of_the_force(arc: float, e: float, direction: float) -> None:
    solver = PadSolver(arc=math.radians(arc), slenderness=1.0)
    found = solver.stiffness(solver.solve(e, direction))
    axes = rotation(direction)
    place, step = e * axes[:, 0], 0.02 * min(e, 1.0 - e)
    differences = [(force(solver, place - step * one) - force(solver, place + step * one)) / (2 * step) for one in axes.T]
    due = axes.T @ np.stack(differences, axis=1)
    assert np.abs(found - due).max() < 5e-3 * np.abs(due).max()


def rotation(angle: float) -> Floats:
    """The matrix (2, 2) that turns by an angle."""
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


def force(solver: PadSolver, place: Floats) -> Floats:
    """The force (2,) in axes along and across the middle of the pad."""
    direction = float(np.arctan2(place[1], place[0]))
    return rotation(direction) @ solver.solve(float(np.hypot(*place)), direction).force


def test_damping_does_not_jump_when_the_edge_of_the_film_passes_a_node() -> None:
    solver = PadSolver(arc=math.radians(120.0), slenderness=0.7, around=120)
    directions = np.linspace(0.1, 0.16, 41)  # the edge passes some three cells
    films = [solver.solve(0.6, float(one)) for one in directions]
    damping = np.array([one.radial_damping for one in films])
    assert len({(one.pressure > 0.0).sum() for one in films}) > 5
    smooth = np.polyval(np.polyfit(directions - 0.13, damping, 3), directions - 0.13)
    assert np.abs(damping / smooth - 1).max() < 1e-3


def test_a_concentric_journal_has_a_film_in_the_limit() -> None:
    solver = PadSolver(arc=math.radians(100.0), slenderness=0.5)
    at_centre, near = solver.solve(0.0, 0.4), solver.solve(1e-6, 0.4)
    assert not at_centre.force.any()
    assert at_centre.force_over_eccentricity == pytest.approx(near.force_over_eccentricity, rel=1e-4)


def test_a_film_that_only_diverges_carries_nothing() -> None:
    found = PadSolver(arc=math.radians(60.0), slenderness=1.0).solve(0.8, -math.pi / 2)
    assert not found.force.any()
    assert not found.damping.any()
