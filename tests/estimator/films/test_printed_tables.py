"""Films against printed tables and the reference arrays of the motor and compressor."""

import csv
import json
from functools import cache
from typing import Any

import numpy as np
import pytest

from estimator.arrays import Floats
from estimator.films.dimensional_film import dimensional_film, film_scale
from estimator.films.equilibrium import EquilibriumSearch
from estimator.films.film import Film
from estimator.films.profiles import elliptical, plain, two_axial_grooves
from tests.estimator.films.films import coarse_table
from tests.paths import ROOT

DATA = ROOT / "tests" / "data"
BEARINGS = {"two_axial_groove_20deg": two_axial_grooves(), "elliptical_preload_0.5": elliptical(preload=0.5)}
SLIPS = {("elliptical_preload_0.5", "0.161"): 85.29}
"""Attitude that one row should have: the printed 83.29 is a slip, see the data's README."""
COUPLINGS = ("flexible", "rigid")
CASES = ("aligned", "parallel_down", "parallel_up", "angle_100urad", "oil_warm", "worn_B2")


def rows() -> list[dict[str, str]]:
    """The rows of Lund and Thomsen's tables."""
    with (DATA / "lund_thomsen_1978.csv").open() as file:
        return list(csv.DictReader(file))


@cache
def search(bearing: str, slenderness: float) -> EquilibriumSearch:
    """The search in the film of a printed bearing."""
    return EquilibriumSearch(Film(BEARINGS[bearing], slenderness, table=coarse_table))


@pytest.mark.parametrize("row", rows(), ids=lambda row: f"{row['bearing']} {row['L_over_D']} {row['S']}")
def test_lund_and_thomsen(row: dict[str, str]) -> None:
    one = search(row["bearing"], float(row["L_over_D"]))
    load = 1.0 / (np.pi * float(row["S"]))
    x, y = place = one.position(np.array([0.0, -load]))
    attitude = SLIPS.get((row["bearing"], row["S"]), float(row["attitude_deg"]))
    assert np.hypot(x, y) == pytest.approx(float(row["eccentricity"]), abs=0.005)
    assert np.degrees(np.arctan2(x, -y)) == pytest.approx(attitude, abs=0.5)
    found = one.film.at(place)
    # Their x points along the load, our -y, and their y a quarter turn on, our x.
    axes = np.array([[0.0, 1.0], [-1.0, 0.0]])
    stiffness, damping = (axes.T @ matrix @ axes / load for matrix in (found.stiffness, found.damping))
    printed = [float(row[name]) for name in ("Kxx", "Kxy", "Kyx", "Kyy")]
    assert np.abs(stiffness.ravel() - printed).max() < 0.02 * max(printed)
    printed = [float(row[name]) for name in ("Bxx", "Bxy", "Byy")]
    assert np.abs(damping.ravel()[[0, 1, 3]] - printed).max() < 0.02 * max(printed)


@cache
def reference() -> tuple[dict[str, Any], dict[str, Floats]]:
    """The train of the motor and compressor, and its arrays."""
    with np.load(DATA / "motor-compressor" / "arrays.npz") as arrays:
        return json.loads((DATA / "motor-compressor" / "train.json").read_text()), dict(arrays)


@cache
def plain_film() -> EquilibriumSearch:
    """The film of its bearings, whose length is half the diameter."""
    return EquilibriumSearch(Film(plain(), 0.5))


@pytest.mark.parametrize("coupling", COUPLINGS)
@pytest.mark.parametrize("case", CASES)
def test_motor_and_compressor(coupling: str, case: str) -> None:
    train, arrays = reference()
    due = {name: arrays[f"{coupling}.{case}.{name}"] for name in ("load", "journal_position", "stiffness", "damping")}
    for index, bearing in enumerate(train["bearings"]):
        worn, warm = case == "worn_B2" and index == 1, case == "oil_warm"
        data = {
            "radius": bearing["diameter"] / 2,
            "length": bearing["length"],
            "clearance": bearing["radial_clearance"] * (1.3 if worn else 1.0),
            "viscosity": bearing["viscosity"] * (0.85 if warm else 1.0),
            "speed": arrays["speed"],
        }
        scale = film_scale(**data)
        place = scale.clearance[:, None] * plain_film().position(-due["load"][:, index] / scale.force[:, None])
        assert np.abs(place - due["journal_position"][:, index]).max() < 0.02 * data["clearance"]
        found = dimensional_film(plain_film().film, place, **data)
        for name in ("stiffness", "damping"):
            given, expected = getattr(found, name), due[name][:, index]
            assert (np.abs(given - expected).max(axis=(1, 2)) < 0.02 * np.abs(expected).max(axis=(1, 2))).all(), name
