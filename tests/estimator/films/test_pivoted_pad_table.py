"""Tilting pads in balance: where they lose their film, and their tables between nodes."""

import math

import numpy as np
import pytest

from estimator.films.pivoted_pad import NoTilt, PivotedPadSolver
from estimator.films.pivoted_pad_table import PivotedPadTable, pivoted_pad_table
from tests.estimator.films.tilting import between_nodes, coarse_pivoted_table


def test_a_pad_pivoted_in_its_middle_loses_its_film_where_the_journal_leaves_its_centre() -> None:
    solver = PivotedPadSolver(arc=math.radians(60.0), pivot=0.5, slenderness=0.5, around=80)
    e, across = np.array(solver.unloading()).T
    assert e[-1] == pytest.approx(0.0, abs=1e-4)
    assert across[-1] < 0.01
    assert (np.diff(e) < 0.0).all()
    # The load, and with it the tilt, goes with the root of the distance.
    assert across[-5] / across[-3] == pytest.approx(math.sqrt(e[-5] / e[-3]), rel=0.05)


@pytest.mark.parametrize(("pivot", "last"), [(0.55, -0.19), (0.6, -1.0)])
def test_a_pivot_behind_the_middle_keeps_the_film_longer(pivot: float, last: float) -> None:
    solver = PivotedPadSolver(arc=math.radians(60.0), pivot=pivot, slenderness=0.5, around=80)
    curve = solver.unloading()
    assert curve[-1][0] == pytest.approx(last, abs=0.06)
    for e, across in curve[:: len(curve) // 4]:
        film = solver.at(e, across)
        assert abs(film.force[1]) < 1e-6 * abs(film.force[0])
        assert film.stiffness[1, 1] > 0.0


def test_no_tilt_holds_a_pad_that_the_journal_has_left() -> None:
    solver = PivotedPadSolver(arc=math.radians(60.0), pivot=0.5, slenderness=0.5, around=80)
    with pytest.raises(NoTilt, match=r"-0\.300 clearances"):
        solver.across(-0.3, start=0.1)


@pytest.mark.parametrize(("arc", "pivot"), [(60.0, 0.5), (80.0, 0.6)])
def test_a_table_between_its_nodes(arc: float, pivot: float) -> None:
    own = {"arc": math.radians(arc), "pivot": pivot, "slenderness": 0.5, "around": 80}
    assert between_nodes(PivotedPadTable(**own), PivotedPadSolver(**own), last=0.9, count=15) < 0.005  # type: ignore[arg-type]


def test_a_table_is_made_once_for_each_geometry() -> None:
    one = {"arc": math.radians(60.0), "pivot": 0.5, "slenderness": 0.5}
    assert pivoted_pad_table(**one) is pivoted_pad_table(**one)


def test_slopes_do_not_jump_from_cell_to_cell() -> None:
    table = coarse_pivoted_table(arc=math.radians(60.0), pivot=0.6, slenderness=0.5)

    def largest_change(points: int) -> float:
        found = table.at(np.linspace(-1.2, 0.9, points))
        return float(np.abs(np.diff(np.log(found.reduced(1j)[1].real[found.weight > 0.05]))).max())

    assert largest_change(4001) < 0.6 * largest_change(2001)
