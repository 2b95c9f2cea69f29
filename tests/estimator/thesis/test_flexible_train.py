"""The flexible train of Chapters 3 and 4 against the dense model that the estimator's tests keep."""

import numpy as np
import pytest

from estimator.machine.document import parse_machine
from estimator.rotor.rayleigh import RayleighCoefficients
from estimator.thesis.flexible_train import flexible_train, full_response, parts, unbalance_force
from tests.estimator.trains import chapter_3, dense_elements, dense_response, one_disc_document, truth

SPEED = np.array([10.0, 122.0, 162.0, 283.0])
MACHINE = chapter_3()
TRAIN = flexible_train(MACHINE)
COEFFICIENTS, UNBALANCES = truth(MACHINE)


def test_it_has_the_degrees_of_freedom_of_the_thesis() -> None:
    """48 degrees of freedom: 8 at bearings, 8 at the coupling, 32 inside (Eq. 3.21)."""
    assert TRAIN.size == 48
    assert TRAIN.bearing.size == 8
    assert TRAIN.coupling.size == 8
    assert TRAIN.interface.size == 16
    assert len(TRAIN.unknowns.coefficients) == 42


@pytest.mark.parametrize("direction", [1, -1])
def test_response_is_that_of_the_dense_model(direction: int) -> None:
    found = full_response(
        TRAIN,
        coefficients=COEFFICIENTS,
        unbalances=UNBALANCES,
        speed=SPEED,
        direction=np.full(SPEED.size, float(direction)),
    )
    expected = dense_response(MACHINE, SPEED, direction=direction)
    assert np.all(np.abs(found[:, TRAIN.bearing] - expected) < 1e-10 * np.abs(expected).max(axis=0))


def test_shaft_damping_enters_the_response() -> None:
    """Against a dense solve with C = αM + βK written out: the discs' mass and inertia stay undamped."""
    alpha, beta = 2.0, 3e-4
    damped = flexible_train(MACHINE, rayleigh=RayleighCoefficients(mass_coefficient=alpha, stiffness_coefficient=beta))
    shafts = TRAIN.mass.copy()
    for disc, x in zip(MACHINE.discs, TRAIN.disc[::2], strict=True):
        shafts[x : x + 4, x : x + 4] -= np.diag([disc.mass, disc.mass, disc.diametral_inertia, disc.diametral_inertia])
    stiffness, damping = dense_elements(MACHINE)
    damping = damping + alpha * shafts + beta * TRAIN.stiffness
    omega = 143.0
    dynamic = TRAIN.stiffness + stiffness - omega**2 * TRAIN.mass + 1j * omega * (damping - omega * TRAIN.gyroscopic)
    speed, direction = np.array([omega]), np.array([-1.0])
    force = unbalance_force(TRAIN, speed=speed, direction=direction)[0] @ parts(UNBALANCES)
    expected = np.linalg.solve(dynamic, force)
    found = full_response(damped, coefficients=COEFFICIENTS, unbalances=UNBALANCES, speed=speed, direction=direction)[0]
    undamped = full_response(TRAIN, coefficients=COEFFICIENTS, unbalances=UNBALANCES, speed=speed, direction=direction)[0]
    assert np.abs(found - expected).max() < 1e-10 * np.abs(expected).max()
    assert np.abs(found - undamped).max() > 0.01 * np.abs(undamped).max()


def test_a_bending_mode_of_the_bare_shaft_has_the_stated_ratio() -> None:
    """A free shaft without its disc: ζ = (α/ω + βω)/2 at its first bending frequency."""
    machine = parse_machine(one_disc_document(mass=1e-9, diametral_inertia=1e-12, polar_inertia=0.0))
    damping = RayleighCoefficients(mass_coefficient=4.0, stiffness_coefficient=1e-5)
    train = flexible_train(machine, rayleigh=damping)
    size = train.size
    inverse = np.linalg.inv(train.mass)
    state = np.block([[np.zeros((size, size)), np.eye(size)], [-inverse @ train.stiffness, -inverse @ train.damping]])
    roots = np.linalg.eigvals(state)
    first = min(roots[roots.imag > 100.0], key=lambda root: root.imag)
    frequency = abs(first)
    assert -first.real / frequency == pytest.approx((4.0 / frequency + 1e-5 * frequency) / 2, rel=1e-5)


def test_a_bearing_at_the_coupling_is_counted_once() -> None:
    document = MACHINE.model_dump()
    document["bearings"] = [*document["bearings"], {**document["bearings"][1], "id": "B5", "station": 1.25}]
    train = flexible_train(parse_machine(document))
    assert train.bearing.size == 10
    assert np.unique(train.interface).size == train.interface.size == 16


def test_parts_keep_leading_axes() -> None:
    assert parts(np.array([[1 + 2j, 3 - 4j]])).tolist() == [[1.0, 2.0, 3.0, -4.0]]
    assert parts(np.array([1 + 2j, 3 - 4j])).tolist() == [1.0, 2.0, 3.0, -4.0]
