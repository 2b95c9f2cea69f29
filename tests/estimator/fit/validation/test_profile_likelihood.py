"""Intervals tried against the likelihood's profile where the data hardly determine a train.

Over 60-110 rad/s the Chapter 3 train is badly conditioned (1e6; 2e3 over its whole range). What is still given there must be
worth its standard error. Without the check 14 direct terms a fit were given there, now 4; of those of the Chapter 5 rig over
17-41 Hz 38 % lay beyond 1.96 standard errors, now next to nothing is given.
"""

import math

import numpy as np
import pytest

from estimator.fit.conclusion import LARGEST_CONDITION
from estimator.fit.identification import Identification
from estimator.fit.identify import identify
from estimator.machine.document import parse_machine
from estimator.machine.parameter_description import is_direct
from estimator.phasors.measurement import Measurement
from tests.estimator.trains import Floats, chapter_3, chapter_3_document, dense_response, noisy, perturbed, truth

NARROW: Floats = np.linspace(60.0, 110.0, 60)


def found(seed: int, speed: Floats) -> Identification:
    phasor = noisy(dense_response(chapter_3(), speed, direction=1), seed=seed)
    machine = parse_machine(perturbed(chapter_3_document(), seed=seed, span=0.3))
    return identify(machine, Measurement.of(speed=speed, phasor=phasor))


@pytest.fixture(scope="module")
def narrow() -> list[Identification]:
    return [found(seed, NARROW) for seed in range(3)]


@pytest.mark.long
def test_what_is_given_in_a_narrow_range_is_worth_its_standard_error(narrow: list[Identification]) -> None:
    coefficients, _ = truth(chapter_3())
    deviation = [
        math.log(one.value / true) / (one.standard_error / one.value)
        for result in narrow
        for one, true in zip(result.estimates, coefficients, strict=False)
        if is_direct(one.name) and one.value is not None and one.standard_error is not None
    ]
    assert all(result.condition_number > LARGEST_CONDITION for result in narrow)
    assert deviation
    assert np.max(np.abs(deviation)) < 4.0


@pytest.mark.long
def test_flat_directions_are_said_to_be_open(narrow: list[Identification]) -> None:
    reasons = [one.reason for result in narrow for one in result.estimates if one.reason]
    assert any("far beyond its standard error" in reason for reason in reasons)


def test_a_full_run_down_needs_no_such_check() -> None:
    result = found(0, np.arange(4.0, 300.0, 4.0))
    assert result.condition_number < LARGEST_CONDITION
    assert all(one.estimable for one in result.estimates)
