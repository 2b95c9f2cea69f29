"""Tilting pads against symmetry, brute force and printed tables; their tables between nodes, derivatives and time."""

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.fluid_film.report_line import ReportLine
from estimator.arrays import Floats
from estimator.films.equilibrium import EquilibriumSearch
from estimator.films.pivoted_pad import PivotedPadSolver
from estimator.films.pivoted_pad_table import PivotedPadTable
from estimator.films.reynolds import AROUND
from estimator.films.tilting_film import TiltingFilm, TiltingProfile
from tests.estimator.films.tilting import BETWEEN_PADS, FOUR, FOUR_ON, ON_PAD, TILTING, against_print, between_nodes
from tests.film_plant.tilting import RockerPads, tilted

SLENDERNESS = 0.5
LOADS = (0.1, 0.5, 1.0, 3.0, 10.0)
"""Loads at which symmetry is tried [μ ω R L (R/c)²]."""
PLACES, DIFFERENCE = 400, 1e-6
"""Number of positions at which derivatives are tried, and the change of a position for a difference [c]."""
BRUTE = ((0.02, -0.2), (-0.02, -0.36), (-0.02, -0.46))
"""Positions at which bearings are solved by brute force, where no pad is about to lose its film [c].

Where one is, solutions jump and the product's film fades within a tenth of the clearance: damping may be 12 % off.
"""
PADS = ((60.0, 0.5), (60.0, 0.6), (80.0, 0.5), (80.0, 0.55), (60.0, 0.45))
"""Arcs [°] and pivots of the pads whose tables are tried between nodes."""


@dataclass(frozen=True)
class _BruteForce:
    """Largest deviations from brute force, of parts of the largest term [-]."""

    force: float
    stiffness: float
    damping: float


def tilting_pads(plants: int) -> list[ReportLine]:
    """Return the rows on tilting pads; with few plants fewer are solved by brute force."""
    places = BRUTE if plants > 1 else BRUTE[:1]
    brute = [_brute_force(profile, place) for profile in TILTING.values() for place in _settled(profile, places)]
    what = f"tilting pads against brute force, {len(brute)} cases"
    return [
        _small("load between four tilting pads: kxx = kyy and kxy = 0, part of kxx", 1e-6, _symmetry()),
        _within(f"{what}: force", 0.01, max(one.force for one in brute)),
        _within("    stiffness and damping at 1x, part of the largest", 0.01, max(max(b.stiffness, b.damping) for b in brute)),
        _within("Someya, four pads, load between: S, K and C, part of a row's larger", 0.06, _between()),
        _within("Someya, four pads, load on a pad: the same", 0.06, _on_pad()),
        _within("tables of tilting pads against solutions between their nodes", 0.005, max(_nodes(*one) for one in PADS)),
        _small("derivatives of forces, K and C against differences, part of the largest", 1e-5, _derivatives()),
        _making(),
    ]


def _within(what: str, asked: float, measured: float) -> ReportLine:
    return ReportLine(what, f"<= {100 * asked:g} %", f"{100 * measured:.2g} %", measured <= asked)


def _small(what: str, asked: float, measured: float) -> ReportLine:
    return ReportLine(what, f"<= {asked:g}", f"{measured:.1e}", measured <= asked)


def _symmetry() -> float:
    search, worst = EquilibriumSearch(TiltingFilm(FOUR, SLENDERNESS)), 0.0
    for load in LOADS:
        found = search.film.at(search.position(np.array([0.0, -load])))
        for matrix in (found.stiffness, found.damping):
            worst = max(worst, float(np.abs(matrix / matrix[0, 0] - np.eye(2)).max()))
    return worst


def _settled(profile: TiltingProfile, places: Sequence[tuple[float, float]]) -> list[Floats]:
    """Return those of the positions at which the film is known and every pad is either loaded or not."""
    film = TiltingFilm(profile, SLENDERNESS)
    known = [place for place in np.array(places) if film.covers(place)]
    pads = [film.at(place).pads for place in known]
    return [place for place, one in zip(known, pads, strict=True) if one is not None and np.all(one.weight % 1.0 == 0.0)]


def _brute_force(profile: TiltingProfile, position: Floats) -> _BruteForce:
    pads = RockerPads(profile.count, profile.arc, profile.preload, profile.pivot, profile.first)
    due = tilted(pads, SLENDERNESS, position, around=180)
    found, reduced = TiltingFilm(profile, SLENDERNESS).at(position), due.reduced(1.0)
    return _BruteForce(
        float(np.abs(found.force - due.force).max() / np.hypot(*due.force)),
        _part(found.stiffness, reduced.real),
        _part(found.damping, reduced.imag),
    )


def _part(found: Floats, due: Floats) -> float:
    return float(np.abs(found - due).max() / np.abs(due).max())


def _between() -> float:
    return against_print(TiltingFilm(FOUR, 0.5), BETWEEN_PADS)


def _on_pad() -> float:
    return against_print(TiltingFilm(FOUR_ON, 1.0), ON_PAD)


def _nodes(arc: float, pivot: float) -> float:
    solver = PivotedPadSolver(arc=math.radians(arc), pivot=pivot, slenderness=SLENDERNESS, around=AROUND)
    table = PivotedPadTable(arc=math.radians(arc), pivot=pivot, slenderness=SLENDERNESS)
    return max(between_nodes(table, solver, last=last, count=20) for last in (0.91, 0.03))


def _derivatives() -> float:
    film = TiltingFilm(TILTING["five offset, on"], SLENDERNESS)
    drawn = np.random.default_rng(0).uniform(-0.8, 0.8, (20 * PLACES, 2))
    places = drawn[film.covers(1.01 * drawn) & film.covers(drawn)][:PLACES]
    found, worst = film.at(places), 0.0
    for axis in range(2):
        step = DIFFERENCE * np.eye(2)[axis]
        ahead, behind = film.at(places + step), film.at(places - step)
        for slope, one, other in (
            (found.static_stiffness, behind.force, ahead.force),
            (found.stiffness_slope, ahead.stiffness, behind.stiffness),
            (found.damping_slope, ahead.damping, behind.damping),
        ):
            difference = ((one - other) / (2 * DIFFERENCE)).reshape(len(places), -1)
            own = slope[..., axis].reshape(len(places), -1)
            worst = max(worst, float(np.max(np.abs(own - difference).max(axis=1) / np.abs(own).max(axis=1))))
    return worst


def _making() -> ReportLine:
    began = time.process_time()
    PivotedPadTable(arc=math.radians(60.0), pivot=0.6, slenderness=SLENDERNESS)
    took = time.process_time() - began
    return ReportLine("one table of a tilting pad, processor time", "<= 30 s", f"{took:.1f} s", took <= 30.0)
