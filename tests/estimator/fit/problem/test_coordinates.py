"""The fit's coordinates: exact inverse maps (relative 1e-12) and the prior. Their slopes: `test_fit.py`."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.fit.problem.coordinates import UNBALANCE_SPREAD, Coordinates
from estimator.machine.document import Machine, parse_machine
from estimator.rotor.coefficient_models import CROSS_SPREAD, KNOWN_SPREAD, UNKNOWN_SPREAD
from estimator.rotor.condensation import condense
from tests.estimator.trains import chapter_3, chapter_3_document, few_examples, truth, without


def coordinates(machine: Machine, scale: float = 0.01) -> Coordinates:
    return Coordinates.of(condense(machine, speed=np.array([1.0]), direction=np.array([1.0])), unbalance_scale=scale)


COORDINATES = coordinates(chapter_3())
NAMES = condense(chapter_3(), speed=np.array([1.0]), direction=np.array([1.0])).unknowns.names
vectors = st.lists(st.floats(-3.0, 3.0), min_size=50, max_size=50).map(np.array)


@few_examples
@given(vectors)
def test_there_and_back(theta: np.ndarray) -> None:
    coefficients, unbalances = COORDINATES.coefficients(theta), COORDINATES.excitations(theta)
    assert coefficients.shape == (42,)
    assert unbalances.shape == (4,)
    assert COORDINATES.with_coefficients(theta, coefficients) == pytest.approx(theta, rel=1e-12, abs=1e-12)
    assert theta[42:].reshape(4, 2) @ [0.01, 0.01j] == pytest.approx(unbalances, rel=1e-12)


def test_back_and_there() -> None:
    coefficients, _ = truth(chapter_3())
    theta = COORDINATES.with_coefficients(np.zeros(50), coefficients)
    assert COORDINATES.coefficients(theta) == pytest.approx(coefficients, rel=1e-12)


@few_examples
@given(vectors)
def test_direct_terms_stay_positive_and_only_they_are_logarithms(theta: np.ndarray) -> None:
    assert np.all(COORDINATES.coefficients(theta)[COORDINATES.logarithmic] > 0)
    for name, logarithmic in zip(NAMES, COORDINATES.logarithmic, strict=False):
        assert logarithmic == (name.split(".")[-1] in ("kxx", "kyy", "cxx", "cyy", "k_phix", "k_phiy"))


def test_one_unit_of_a_direct_term_is_a_factor_e_and_of_the_others_their_scale() -> None:
    zero = np.zeros(50)
    step = COORDINATES.coefficients(zero + 1.0)
    assert step[NAMES.index("bearing.B1.kxx")] == pytest.approx(math.e * 250000.0)
    assert step[NAMES.index("bearing.B1.kxy")] == pytest.approx((250000.0 + 275000.0) / 2)
    assert step[NAMES.index("bearing.B1.cyx")] == pytest.approx((300.0 + 399.0) / 2)
    assert step[NAMES.index("coupling.C1.k_phix")] == pytest.approx(math.e * 250000.0)
    assert COORDINATES.excitations(zero + 1.0) == pytest.approx(np.full(4, 0.01 + 0.01j))


def test_prior_of_known_coefficients_lies_at_their_values() -> None:
    assert COORDINATES.coefficients(COORDINATES.centre) == pytest.approx(truth(chapter_3())[0], rel=1e-12)
    assert not np.any(COORDINATES.centre[42:])
    expected = np.where(COORDINATES.logarithmic, KNOWN_SPREAD, CROSS_SPREAD)
    assert np.array_equal(COORDINATES.spread, np.concatenate([expected, np.full(8, UNBALANCE_SPREAD)]))


def test_prior_of_unknown_coefficients_is_wide_and_without_cross_coupling() -> None:
    found = coordinates(parse_machine(without(chapter_3_document(), ("bearings",))))
    bearings = np.array([name.startswith("bearing.") for name in NAMES[:42]])
    direct = found.logarithmic
    assert np.all(found.spread[:42][bearings & direct] == UNKNOWN_SPREAD)
    assert np.all(found.spread[:42][~bearings & direct] == KNOWN_SPREAD)
    expected = found.coefficients(found.centre)
    assert np.all(expected[bearings & ~direct] == 0.0)
    # 48 EI/L³ of the bearing's own shaft.
    stiffness = 48 * 2.1e11 * math.pi / 64 * 0.02**4 / 1.25**3
    assert expected[NAMES.index("bearing.B1.kxx")] == pytest.approx(stiffness, rel=1e-12)
    middle = (90 + 6000) / 2 * math.pi / 30
    assert expected[NAMES.index("bearing.B1.cyy")] == pytest.approx(0.1 * stiffness / middle, rel=1e-12)


def test_prior_of_an_element_known_in_part_takes_its_own_size() -> None:
    document = without(chapter_3_document(), ("bearings",), ("kxx", "kxy", "kyx", "cxx", "cxy", "cyx", "cyy"))
    found = coordinates(parse_machine(document))
    expected = found.coefficients(found.centre)
    assert expected[NAMES.index("bearing.B1.kxx")] == pytest.approx(275000.0)
    assert found.scale[NAMES.index("bearing.B1.kxy")] == pytest.approx(275000.0)


@pytest.mark.parametrize("value", [0.0, -1.0])
def test_direct_term_that_is_not_positive_has_no_coordinate(value: float) -> None:
    coefficients, _ = truth(chapter_3())
    coefficients[NAMES.index("bearing.B2.cyy")] = value
    with pytest.raises(ValueError, match="must be positive"):
        COORDINATES.with_coefficients(np.zeros(50), coefficients)


def test_negative_cross_coupling_has_one() -> None:
    coefficients, _ = truth(chapter_3())
    coefficients[NAMES.index("bearing.B2.kxy")] *= -1
    theta = COORDINATES.with_coefficients(np.zeros(50), coefficients)
    assert COORDINATES.coefficients(theta) == pytest.approx(coefficients, rel=1e-12)
