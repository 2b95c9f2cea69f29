"""Analytic derivatives of the response against central differences.

A relative step of 1e-5 leaves a truncation error near 1e-8, for resonances are a few percent wide, and the rounding error that
each test adds to its bound. So a derivative must agree within 1e-6 of its channel's largest value (1e-5 along a direction that
moves all unknowns at once); a derivative by an unbalance within 1e-10 of the response to a unit of it.
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.machine.document import parse_machine
from estimator.rotor.condensation import condense
from estimator.rotor.response import response, sensitivity
from tests.estimator.trains import chapter_3, few_examples, one_disc_document, truth

SPEED = np.array([10.0, 122.0, 145.0, 176.0, 283.0, 402.0])
DIRECTION = np.array([1.0, 1.0, -1.0, 1.0, -1.0, 1.0])
TRAIN = condense(chapter_3(), speed=SPEED, direction=DIRECTION)
COEFFICIENTS, UNBALANCES = truth(chapter_3())


def test_modelled_response_is_the_response() -> None:
    found = sensitivity(TRAIN, coefficients=COEFFICIENTS, excitations=UNBALANCES).phasor
    expected = response(TRAIN, coefficients=COEFFICIENTS, excitations=UNBALANCES)
    assert np.all(np.abs(found - expected) < 1e-10 * np.abs(expected).max(axis=0))


@pytest.mark.parametrize("column", range(42))
def test_derivative_by_a_coefficient(column: int) -> None:
    slope = sensitivity(TRAIN, coefficients=COEFFICIENTS, excitations=UNBALANCES).by_parameter
    assert slope.shape == (SPEED.size, 8, 50)
    step = np.zeros(42)
    step[column] = 1e-5 * abs(COEFFICIENTS[column])
    ends = [response(TRAIN, coefficients=COEFFICIENTS + sign * step, excitations=UNBALANCES) for sign in (1, -1)]
    expected = (ends[0] - ends[1]) / (2 * step[column])
    rounding = 1e-11 * np.abs(ends[0]).max(axis=0) / step[column]
    assert np.all(np.abs(slope[:, :, column] - expected) < 1e-6 * np.abs(expected).max(axis=0) + rounding)
    assert np.abs(expected).max() > 0


@pytest.mark.parametrize("plane", range(4))
@pytest.mark.parametrize("part", [1.0, 1j], ids=["real", "imaginary"])
def test_derivative_by_an_unbalance(plane: int, part: complex) -> None:
    slope = sensitivity(TRAIN, coefficients=COEFFICIENTS, excitations=UNBALANCES).by_parameter
    unit = np.zeros(4, dtype=complex)
    unit[plane] = part
    expected = response(TRAIN, coefficients=COEFFICIENTS, excitations=unit)  # linear: the derivative is the response to 1
    column = 42 + 2 * plane + (0 if part == 1.0 else 1)
    assert np.all(np.abs(slope[:, :, column] - expected) < 1e-10 * np.abs(expected).max(axis=0))


@few_examples
@given(st.lists(st.floats(-1.0, 1.0), min_size=50, max_size=50).filter(lambda values: max(map(abs, values)) > 0.1))
def test_derivative_along_any_direction(values: list[float]) -> None:
    size = np.concatenate([np.abs(COEFFICIENTS), np.full(8, 0.01)])
    along = np.array(values) * size
    parts = along[42:].reshape(-1, 2)
    turn = parts[:, 0] + 1j * parts[:, 1]
    slope = sensitivity(TRAIN, coefficients=COEFFICIENTS, excitations=UNBALANCES).by_parameter
    h = 1e-5
    ends = [
        response(TRAIN, coefficients=COEFFICIENTS + sign * h * along[:42], excitations=UNBALANCES + sign * h * turn)
        for sign in (1, -1)
    ]
    expected = (ends[0] - ends[1]) / (2 * h)
    assert np.all(np.abs(slope @ along - expected) < 1e-5 * np.abs(expected).max(axis=0))


def test_no_unbalance_no_derivative_by_coefficients() -> None:
    machine = parse_machine(one_disc_document())
    train = condense(machine, speed=SPEED, direction=DIRECTION)
    slope = sensitivity(train, coefficients=truth(machine)[0], excitations=np.zeros(1, dtype=complex)).by_parameter
    assert not np.any(slope[:, :, :16])
    assert np.all(np.abs(slope[:, :, 16:]) > 0)
