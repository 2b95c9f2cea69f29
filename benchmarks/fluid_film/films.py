"""Films against closed forms and printed tables, a table against direct solutions, and derivatives against differences."""

import csv
import math
import time

import numpy as np

from benchmarks.fluid_film.report_line import ReportLine
from estimator.arrays import Floats
from estimator.films.equilibrium import EquilibriumSearch
from estimator.films.film import Film
from estimator.films.pad import FULL_ARC
from estimator.films.pad_table import PadTable
from estimator.films.profiles import elliptical, two_axial_grooves
from estimator.films.reynolds import PadSolver
from tests.estimator.films.test_reynolds import RAIMONDI_AND_BOYD, one_dimension
from tests.paths import DATA

ECCENTRICITIES = (0.3, 0.6)
SHORT, LONG, ENDLESS = 0.1, 80.0, 400.0
"""Lengths over diameter of the closed forms [-]."""

PLACES = 400
"""Number of positions at which derivatives are tried."""
DIFFERENCE = 1e-5
"""Change of a position for a difference [c]."""


def films(_: int) -> list[ReportLine]:
    """Return the rows on single films."""
    return [
        _within("Ocvirk's short bearing, L/D 0.1: force", 0.02, _ocvirk()),
        _within("Sommerfeld's full film, L/D 80: force", 0.02, _sommerfeld()),
        _within("with rupture, L/D 400, against one dimension: force", 0.01, _ruptured()),
        _within("Raimondi and Boyd, L/D 0.5 and 1: Sommerfeld number and attitude", 0.02, _raimondi_and_boyd()),
        _within("Lund and Thomsen, 14 rows: K and B, part of a row's largest", 0.06, _lund_and_thomsen()),
        _within("derivatives of K and C against differences, elliptical", 1e-5, _derivatives()),
        _making(),
    ]


def _within(what: str, asked: float, measured: float) -> ReportLine:
    return ReportLine(what, f"<= {100 * asked:g} %", f"{100 * measured:.2g} %", measured <= asked)


def _ocvirk() -> float:
    worst = 0.0
    for e in ECCENTRICITIES:
        found = PadSolver(arc=FULL_ARC, slenderness=SHORT).solve(e).force
        due = np.array([-2 * e**2 / (1 - e**2) ** 2, math.pi * e / (2 * (1 - e**2) ** 1.5)]) * 2 * SHORT**2
        worst = max(worst, float(np.abs(found / due - 1.0).max()))
    return worst


def _sommerfeld() -> float:
    worst = 0.0
    for e in ECCENTRICITIES:
        found = PadSolver(arc=FULL_ARC, slenderness=LONG, rupture=False).solve(e).force
        due = 12 * math.pi * e / ((2 + e**2) * math.sqrt(1 - e**2))
        worst = max(worst, float(np.hypot(found[0], found[1] - due)) / due)
    return worst


def _ruptured() -> float:
    worst = 0.0
    for e in ECCENTRICITIES:
        found, due = PadSolver(arc=FULL_ARC, slenderness=ENDLESS).solve(e).force, one_dimension(e)
        worst = max(worst, float(np.hypot(*(found - due)) / np.hypot(*due)))
    return worst


def _raimondi_and_boyd() -> float:
    worst = 0.0
    for slenderness, eccentricity, sommerfeld, attitude in RAIMONDI_AND_BOYD:
        radial, tangential = PadSolver(arc=FULL_ARC, slenderness=slenderness).solve(eccentricity).force
        number = 1 / (math.pi * math.hypot(radial, tangential))
        angle = math.degrees(math.atan2(tangential, -radial))
        worst = max(worst, abs(number / sommerfeld - 1.0), abs(angle / attitude - 1.0))
    return worst


def _lund_and_thomsen() -> float:
    profiles = {"two_axial_groove_20deg": two_axial_grooves(), "elliptical_preload_0.5": elliptical(preload=0.5)}
    # Their x points along the load, our -y, and their y a quarter turn on, our x.
    axes = np.array([[0.0, 1.0], [-1.0, 0.0]])
    searches: dict[tuple[str, float], EquilibriumSearch] = {}
    worst = 0.0
    with (DATA / "lund_thomsen_1978.csv").open() as file:
        for row in csv.DictReader(file):
            key = row["bearing"], float(row["L_over_D"])
            if key not in searches:
                searches[key] = EquilibriumSearch(Film(profiles[key[0]], key[1]))
            load = 1.0 / (np.pi * float(row["S"]))
            found = searches[key].film.at(searches[key].position(np.array([0.0, -load])))
            own = [axes.T @ matrix @ axes / load for matrix in (found.stiffness, found.damping)]
            stiffness = np.array([float(row[name]) for name in ("Kxx", "Kxy", "Kyx", "Kyy")])
            damping = np.array([float(row[name]) for name in ("Bxx", "Bxy", "Byy")])
            worst = max(worst, float(np.abs(own[0].ravel() - stiffness).max() / stiffness.max()))
            worst = max(worst, float(np.abs(own[1].ravel()[[0, 1, 3]] - damping).max() / damping.max()))
    return worst


def _derivatives() -> float:
    film = Film(elliptical(preload=0.5), 0.5)
    drawn = np.random.default_rng(0).uniform(-0.8, 0.8, (20 * PLACES, 2))
    places = drawn[film.covers(1.01 * drawn) & film.covers(drawn)][:PLACES]
    found = film.at(places)
    worst = 0.0
    for axis in range(2):
        step = DIFFERENCE * np.eye(2)[axis]
        ahead, behind = film.at(places + step), film.at(places - step)
        for slope, one, other in (
            (found.stiffness_slope, ahead.stiffness, behind.stiffness),
            (found.damping_slope, ahead.damping, behind.damping),
        ):
            difference = (one - other) / (2 * DIFFERENCE)
            worst = max(worst, float(np.max(_largest(slope[..., axis] - difference) / _largest(difference))))
    return worst


def _largest(matrices: Floats) -> Floats:
    return np.asarray(np.abs(matrices).max(axis=(-2, -1)))


def _making() -> ReportLine:
    began = time.process_time()
    PadTable(arc=math.radians(160.0), slenderness=0.5)
    took = time.process_time() - began
    return ReportLine("one table of a grooved bearing's pad, processor time", "<= 30 s", f"{took:.1f} s", took <= 30.0)
