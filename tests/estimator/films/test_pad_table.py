"""Tables of pads between their nodes."""

import math

import numpy as np
import pytest

from estimator.arrays import Floats
from estimator.films.pad import FULL_ARC
from estimator.films.pad_table import PadTable, pad_table
from estimator.films.reynolds import PadSolver
from tests.estimator.films.films import coarse_table


def deviations(table: PadTable, solver: PadSolver, *, full: bool, count: int) -> Floats:
    """Largest deviations (3,) of force, stiffness and damping from solutions, over the largest term there.

    Where a pad carries next to nothing, they are over a fiftieth of the largest term amid the pad.
    """
    rng, worst = np.random.default_rng(3), np.zeros(3)
    for _ in range(count):
        e, direction = rng.uniform(0.02, 0.95), 0.0 if full else rng.uniform(-0.8, 1.3)
        one, amid, film = solver.solve(e, direction), solver.solve(e, 0.0), table.at(np.array(e), np.array(direction))
        (g, h), (ge, he), (gf, hf) = film.force_ratio, film.first[0], film.first[1]
        stiffness = -np.array([[g + e * ge, gf - h], [h + e * he, hf + g]])
        pairs = [
            (e * film.force_ratio, one.force, amid.force),
            (stiffness, solver.stiffness(one), solver.stiffness(amid)),
            (film.damping, np.array(one.radial_damping), np.array(amid.radial_damping)),
        ]
        worst = np.maximum(worst, [np.abs(found - due).max() / size(due, scale) for found, due, scale in pairs])
    return worst


def size(due: Floats, amid: Floats) -> float:
    """The largest term, or a fiftieth of that amid the pad."""
    return max(float(np.abs(due).max()), 0.02 * float(np.abs(amid).max()))


def test_a_plain_bearing() -> None:
    solver = PadSolver(arc=FULL_ARC, slenderness=0.5)
    assert deviations(pad_table(arc=FULL_ARC, slenderness=0.5), solver, full=True, count=25).max() < 0.005


def test_a_pad() -> None:
    arc = math.radians(100.0)
    table = PadTable(arc=arc, slenderness=0.7, around=100, radial_nodes=20, angular_nodes=96)
    solver = PadSolver(arc=arc, slenderness=0.7, around=100)
    assert deviations(table, solver, full=False, count=25).max() < 0.005


@pytest.mark.long
@pytest.mark.parametrize(("arc", "slenderness"), [(160.0, 0.5), (160.0, 1.0), (100.0, 0.7), (60.0, 0.8)])
def test_a_pad_as_the_product_tabulates_it(arc: float, slenderness: float) -> None:
    solver = PadSolver(arc=math.radians(arc), slenderness=slenderness)
    found = deviations(pad_table(arc=math.radians(arc), slenderness=slenderness), solver, full=False, count=300)
    assert found.max() < 0.005


def test_a_table_is_made_once_for_each_geometry() -> None:
    assert pad_table(arc=FULL_ARC, slenderness=0.5) is pad_table(arc=FULL_ARC, slenderness=0.5)
    assert pad_table(arc=FULL_ARC, slenderness=0.5) is not pad_table(arc=FULL_ARC, slenderness=0.51)


def test_second_derivatives_do_not_jump_from_cell_to_cell() -> None:
    table = coarse_table(arc=math.radians(100.0), slenderness=0.7)

    def largest_change(points: int) -> float:
        share = np.linspace(0.0, 1.0, points)
        film = table.at(0.15 + 0.6 * share, -0.9 + 2.2 * share)  # across nodes of both coordinates
        return float(np.abs(np.diff(film.second, axis=0)).max())

    assert largest_change(4001) < 0.6 * largest_change(2001)


def test_the_table_ends_where_the_film_is_too_thin() -> None:
    table = coarse_table(arc=math.radians(100.0), slenderness=0.7)
    eccentricity = np.array([0.96, 0.98, 1.1, 1.2, 1.4])
    direction = np.array([0.0, 0.0, 1.6, 3.0, 3.0])
    assert table.covers(eccentricity, direction).tolist() == [True, False, True, True, False]
    edge = math.radians(50.0)
    assert table.thinnest(np.array([0.5, 0.5]), np.array([0.2, edge + 0.3])) == pytest.approx([0.5, 1 - 0.5 * math.cos(0.3)])
