"""Tilting-pad bearings for the tests, and what printed tables say of two of them."""

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from estimator.films.pivoted_pad import WELL_LOADED, PivotedFilm, PivotedPadSolver
from estimator.films.pivoted_pad_table import PivotedPadTable
from estimator.films.tilting_film import TiltingFilm, TiltingProfile

TILTING = {
    "five, between": TiltingProfile(5, math.radians(60.0), 0.3, 0.5, -math.pi / 2 + math.pi / 5),
    "five offset, on": TiltingProfile(5, math.radians(60.0), 0.3, 0.6),
    "four, between": TiltingProfile(4, math.radians(80.0), 0.2, 0.5, -math.pi / 4),
    "three, on": TiltingProfile(3, math.radians(100.0), 0.5, 0.55),
}
"""Profiles, length over diameter 0.5."""

# T. Someya (ed.), Journal-Bearing Databook, Springer, 1989 (doi:10.1007/978-3-642-52509-4): four pads of 80° with their pivots
# in the middle and no preload. Eccentricity in clearances, Sommerfeld number, K c/W and C c ω/W along the load. Left out: rows
# of eccentricities below 0.3, where the load goes with the root of the eccentricity and so amplifies any difference (at equal
# loads K and C differ by less than 8 %), and the last of the load between pads, whose damping is 17 % below ours while that of
# the same film on one pad is 5 % below.
BETWEEN_PADS = (
    (0.3, 1.59, 1.46, 4.37),
    (0.4, 1.05, 1.68, 3.61),
    (0.5, 0.756, 1.94, 3.33),
    (0.6, 0.550, 2.26, 3.21),
    (0.7, 0.381, 2.65, 3.06),
    (0.8, 0.259, 3.15, 3.01),
    (0.9, 0.168, 3.72, 2.97),
    (1.0, 0.103, 4.47, 2.99),
    (1.1, 0.0576, 5.63, 3.11),
)
"""Rows with the load between two pads, length over diameter 0.5."""
ON_PAD = (
    (0.3, 0.795, 2.25, 5.39),
    (0.4, 0.507, 2.77, 4.93),
    (0.5, 0.316, 3.45, 4.67),
    (0.6, 0.185, 4.43, 4.57),
    (0.7, 0.0987, 5.83, 4.55),
    (0.8, 0.0449, 7.99, 4.73),
    (0.85, 0.0272, 10.3, 5.10),
    (0.9, 0.0143, 14.5, 5.86),
)
"""Rows with the load on a pad. They were taken to be of length over diameter 0.5; the numbers are those of 1."""


def against_print(film: TiltingFilm, rows: Sequence[tuple[float, float, float, float]]) -> float:
    """Largest deviation from printed rows: of the Sommerfeld number, and of K and C from the larger of both [-]."""
    eccentricity, number, stiffness, damping = np.array(rows).T
    found = film.at(np.stack([np.zeros_like(eccentricity), -eccentricity], axis=-1))
    load = found.force[:, 1]
    larger = np.maximum(stiffness, damping)
    return float(
        np.max(
            [
                np.abs(1.0 / (np.pi * load) / number - 1.0),
                np.abs(found.stiffness[:, 1, 1] / load - stiffness) / larger,
                np.abs(found.damping[:, 1, 1] / load - damping) / larger,
            ]
        )
    )


@lru_cache(maxsize=16)
def coarse_pivoted_table(*, arc: float, pivot: float, slenderness: float) -> PivotedPadTable:
    """A table with a third of the nodes, on a mesh of a third of the cells."""
    return PivotedPadTable(arc=arc, pivot=pivot, slenderness=slenderness, around=80, nodes=40)


FOUR = TiltingProfile(4, math.radians(80.0), 0.0, 0.5, -math.pi / 4)
"""The printed bearing with its load between pads."""
FOUR_ON = TiltingProfile(4, math.radians(80.0))
"""The same with its load on a pad."""


def tilting_film(name: str, slenderness: float = 0.5) -> TiltingFilm:
    """The film of a profile."""
    return TiltingFilm(TILTING[name], slenderness, table=coarse_pivoted_table)


def directly(film: PivotedFilm) -> tuple[float, complex]:
    """Push of a pad, and the dynamic stiffness at the spin speed, from one solution."""
    z = film.stiffness + 1j * film.damping
    return -float(film.force[0]), complex(z[0, 0] - z[0, 1] * z[1, 0] / z[1, 1])


def between_nodes(table: PivotedPadTable, solver: PivotedPadSolver, *, last: float, count: int) -> float:
    """Largest relative deviation of a table from solutions, between the place where a pad is well loaded and another [-]."""
    worst = 0.0
    across = solver.loaded()
    for e in np.linspace(WELL_LOADED, last, count):
        across = solver.across(float(e), start=across)
        push, z = directly(solver.at(float(e), across))
        found = table.at(np.array(e))
        worst = max(worst, abs(float(found.push) / push - 1.0), abs(complex(found.reduced(1j)[0]) / z - 1.0))
    return worst
