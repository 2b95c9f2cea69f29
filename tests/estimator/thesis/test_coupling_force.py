"""Misalignment forces and moments of a coupling (Eq. 2.12) against the law of motion and the element's own matrix."""

import numpy as np
import pytest

from estimator.machine.document import parse_machine
from estimator.thesis.coupling_force import coupling_force
from estimator.thesis.flexible_train import flexible_train, full_response, parts, unbalance_force
from tests.estimator.trains import chapter_3, truth

TRAIN = flexible_train(chapter_3())
COEFFICIENTS, UNBALANCES = truth(chapter_3())
SPEED = np.array([60.0, 122.0, 250.0])
DIRECTION = np.array([1.0, -1.0, 1.0])
DISPLACEMENT = full_response(TRAIN, coefficients=COEFFICIENTS, unbalances=UNBALANCES, speed=SPEED, direction=DIRECTION)
FORCE = coupling_force(
    TRAIN,
    coupling=0,
    coefficients=COEFFICIENTS,
    displacement=DISPLACEMENT[:, TRAIN.coupling],
    speed=SPEED,
)


def test_it_is_the_printed_sum() -> None:
    """Eq. 2.12 written out with the coupling's values from the document."""
    c = chapter_3().couplings[0]
    step = DISPLACEMENT[:, TRAIN.coupling[:4]] - DISPLACEMENT[:, TRAIN.coupling[4:]]
    kxx, kxy, cxx, cxy = (np.array(value, dtype=float) for value in (c.kxx, c.kxy, c.cxx, c.cxy))
    expected = kxx * step[:, 0] + kxy * step[:, 1] + 1j * SPEED * (cxx * step[:, 0] + cxy * step[:, 1])
    assert np.abs(FORCE[:, 0] - expected).max() < 1e-9 * np.abs(expected).max()
    assert np.abs(FORCE[:, 2] - np.array(c.k_phix, dtype=float) * step[:, 2]).max() < 1e-9 * np.abs(FORCE[:, 2]).max()
    assert np.abs(FORCE[:, 3] - np.array(c.k_phiy, dtype=float) * step[:, 3]).max() < 1e-9 * np.abs(FORCE[:, 3]).max()


def test_it_carries_the_driven_shaft() -> None:
    """Newton along x and y for the whole driven shaft: mass times acceleration is unbalance plus coupling minus bearings."""
    first = int(TRAIN.coupling[4])
    force = unbalance_force(TRAIN, speed=SPEED, direction=DIRECTION) @ parts(UNBALANCES)
    bearings = [b for b in chapter_3().bearings if b.shaft == "S2"]
    for axis in (0, 1):
        along = np.zeros(TRAIN.size)
        along[first + axis :: 4] = 1.0
        inertia = -(SPEED**2) * (DISPLACEMENT @ TRAIN.mass @ along)
        carried = np.zeros(SPEED.size, dtype=complex)
        for number, bearing in enumerate(bearings):
            x, y = DISPLACEMENT[:, TRAIN.bearing[4 + 2 * number]], DISPLACEMENT[:, TRAIN.bearing[5 + 2 * number]]
            row = "xy"[axis]
            k = [np.array(getattr(bearing, f"k{row}{column}"), dtype=float) for column in "xy"]
            c = [np.array(getattr(bearing, f"c{row}{column}"), dtype=float) for column in "xy"]
            carried += (k[0] + 1j * SPEED * c[0]) * x + (k[1] + 1j * SPEED * c[1]) * y
        expected = inertia - force @ along + carried
        assert np.abs(FORCE[:, axis] - expected).max() < 1e-8 * np.abs(expected).max()


def test_a_bearing_beside_the_coupling_adds_nothing() -> None:
    document = chapter_3().model_dump()
    document["bearings"] = [*document["bearings"], {**document["bearings"][1], "id": "B5", "station": 1.25}]
    train = flexible_train(parse_machine(document))
    coefficients, _ = truth(parse_machine(document))
    found = coupling_force(
        train, coupling=0, coefficients=coefficients, displacement=DISPLACEMENT[:, TRAIN.coupling], speed=SPEED
    )
    assert np.abs(found - FORCE).max() < 1e-12 * np.abs(FORCE).max()


def test_what_is_not_there_is_refused() -> None:
    with pytest.raises(IndexError, match="no coupling number 1"):
        coupling_force(TRAIN, coupling=1, coefficients=COEFFICIENTS, displacement=DISPLACEMENT[:, :8], speed=SPEED)
    with pytest.raises(ValueError, match=r"should have \(3, 8\)"):
        coupling_force(TRAIN, coupling=0, coefficients=COEFFICIENTS, displacement=DISPLACEMENT, speed=SPEED)
