"""Tests what may differ between two times of the year: the season of the whole machine, and of each element by itself."""

import numpy as np
import pytest

from estimator.arrays import Floats
from estimator.diagnosis.healthy_variation import SEASON, SHARED, slow_variation
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.parameters import unknowns
from tests.estimator.trains import chapter_3

TRAIN = chapter_3()
KNOWN = unknowns(TRAIN, assemble_rotor(TRAIN))
NAMES = tuple(one.name for one in KNOWN.coefficients)
ELEMENTS = {one.element for one in KNOWN.coefficients}
TYPICAL = np.array([np.log(one.expected) if one.direct else one.expected for one in KNOWN.coefficients])


def grown(part: float, elements: set[str], what: str) -> Floats:
    """Change of all coefficients when those of some elements grow by a small part: of logarithms, or in SI."""
    return np.array(
        [
            part * (1.0 if one.direct else one.expected) if one.element in elements and what in one.quantity else 0.0
            for one in KNOWN.coefficients
        ]
    )


def distance(change: Floats) -> float:
    """Return the distance in standard deviations; infinite for what cannot happen."""
    covariance = slow_variation(KNOWN, NAMES, TYPICAL)
    size = np.array([1.0 if one.direct else one.scale for one in KNOWN.coefficients])
    scaled, covariance = change / size, covariance / np.outer(size, size)
    values, vectors = np.linalg.eigh(covariance)
    along = vectors.T @ scaled
    possible = values > 1e-9 * values.max()
    if np.linalg.norm(along[~possible]) > 1e-6 * np.linalg.norm(along):
        return np.inf
    return float(np.sqrt(np.sum(along[possible] ** 2 / values[possible])))


def test_all_stiffnesses_rise_and_fall_with_the_season_the_cross_coupled_ones_too() -> None:
    assert distance(grown(SEASON, ELEMENTS, "stiffness")) < 1.0


def test_one_element_by_itself_moves_as_its_own_oil_does() -> None:
    own, season = SHARED["stiffness"] ** 2, SEASON**2
    # One of n values that share a season (Sherman and Morrison): what the season explains of it comes off.
    expected = np.sqrt(1.0 - season / (own + len(ELEMENTS) * season))
    assert distance(grown(SHARED["stiffness"], {"bearing.B2"}, "stiffness")) == pytest.approx(expected, rel=1e-6)
    assert distance(grown(SHARED["damping"], {"bearing.B2"}, "damping")) <= 1.0 + 1e-9


def test_a_change_out_of_proportion_is_no_season() -> None:
    change = grown(0.01, {"bearing.B2"}, "stiffness")
    change[NAMES.index("bearing.B2.kxy")] *= -1.0
    assert distance(change) == np.inf
