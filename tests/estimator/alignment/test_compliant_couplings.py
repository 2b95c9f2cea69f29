"""Runs in compliances of their couplings: one that finds a rigid coupling soft says of alignment what the others say."""

import math

import numpy as np
import pytest

from estimator.alignment.compliant_couplings import NEAR, CompliantCouplings, compliant_couplings
from estimator.alignment.run_likelihood import RunLikelihood
from tests.estimator.alignment.drawn_runs import COORDINATES

UNIT, USUAL = 0.5, 2.0
COUPLINGS = CompliantCouplings((1,), np.array([UNIT]), np.array([USUAL]))


@pytest.mark.parametrize("stiffness", [USUAL - 7.0, USUAL - 3.0, USUAL + 3.0, USUAL + 7.0])
def test_what_is_linear_in_a_compliance_is_reported_alike_however_far_off_the_fit_ended(stiffness: float) -> None:
    """Two numbers are measured, each the sum of an offset and of what a coupling gives way by."""
    measured = np.array([[1.0, 3.0], [2.0, -1.0]])
    end = math.copysign(NEAR, stiffness - USUAL)
    softer = np.exp(end - (stiffness - USUAL) * UNIT)
    there = np.array([0.7, USUAL + (end + 1.0 - softer) / UNIT])
    slope = measured * np.array([1.0, softer])  # with the logarithm of the stiffness
    found = np.array([0.7, stiffness])
    own = RunLikelihood(slope.T @ slope, slope.T @ slope @ found)
    told = COUPLINGS.likelihood(own, found)
    assert told.information == pytest.approx(measured.T @ measured, rel=1e-9)
    assert told.vector == pytest.approx(measured.T @ measured @ there, rel=1e-9)


def test_near_the_usual_stiffness_nothing_changes() -> None:
    own, found = RunLikelihood(np.array([[2.0, 1.0], [1.0, 3.0]]), np.array([0.4, -1.0])), np.array([0.7, USUAL - 1.5])
    told = COUPLINGS.likelihood(own, found)
    assert told.information == pytest.approx(own.information, rel=1e-9)
    assert told.vector == pytest.approx(own.vector, rel=1e-9)


def test_direct_stiffnesses_of_couplings_are_meant_and_their_median() -> None:
    runs = np.outer([0.0, 1.0, 5.0], np.ones(COORDINATES.size))
    found = compliant_couplings(COORDINATES.names, COORDINATES.unit, runs)
    named = {COORDINATES.names[place] for place in found.places}
    assert {f"coupling.C1.{term}" for term in ("kxx", "kyy")} <= named
    assert not any(one.endswith(("kxy", "cxx", "clearance")) for one in named)
    assert found.usual == pytest.approx(np.ones(len(found.places)))
