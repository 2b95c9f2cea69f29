"""Rayleigh and internal damping of the shafts, against the equations of motion of a damped rotor that turns.

`full_train` writes internal damping down as an observer turning with the shaft sees it.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from estimator.fit.identify import identify
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import Measurement
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.condensation import condense
from estimator.rotor.response import response
from tests.estimator.full_train import FullTrain, elements, full_response, full_train, two_material_document
from tests.estimator.trains import Document, Floats, chapter_3_document, noisy, one_disc_document, truth

SPEED: Floats = np.array([10.0, 61.0, 122.0, 176.0, 283.0, 431.0])


def damped_document() -> Document:
    document = two_material_document(chapter_3_document())
    document["damping"] = {"alpha": 2.5, "beta": 3e-5}
    document["materials"]["steel"]["internal_damping"] = 4e-5
    document["materials"]["titanium"]["internal_damping"] = 1e-5
    return document


def isotropic_machine(**changes: float) -> Machine:
    """One disc in the middle of a light shaft, on stiff bearings that hardly damp, the same in x and y."""
    document = one_disc_document(density=1e-3, kxx=1e9, kyy=1e9, cxx=1e-6, cyy=1e-6, mass=5.0)
    document["materials"]["steel"].update(changes)
    return parse_machine(document)


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("part", ["both", "internal damping", "Rayleigh damping"])
def test_condensed_response_is_that_of_the_full_damped_train(direction: int, part: str) -> None:
    document = damped_document()
    if part == "internal damping":
        del document["damping"]
    if part == "Rayleigh damping":
        for material in document["materials"].values():
            del material["internal_damping"]
    machine = parse_machine(document)
    train = condense(machine, speed=SPEED, direction=np.full(SPEED.size, float(direction)))
    coefficients, unbalances = truth(machine)
    found = response(train, coefficients=coefficients, excitations=unbalances)
    expected = full_response(machine, SPEED, direction=direction)
    assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()
    undamped = parse_machine(two_material_document(chapter_3_document()))
    assert np.abs(full_response(undamped, SPEED, direction=direction) - expected).max() > 1e-3 * np.abs(expected).max()


def test_matrices_of_the_rotor_are_those_of_the_turning_observer() -> None:
    machine = parse_machine(damped_document())
    rotor = assemble_rotor(machine)
    nothing = np.zeros_like(rotor.mass)
    expected = full_train(machine, (nothing, nothing, nothing))
    assert np.abs(rotor.damping - expected.damping).max() < 1e-12 * np.abs(expected.damping).max()
    assert np.abs(rotor.circulatory - expected.circulatory).max() < 1e-12 * np.abs(expected.circulatory).max()
    assert np.array_equal(rotor.circulatory, -rotor.circulatory.T)


def test_forward_synchronous_whirl_feels_no_internal_damping() -> None:
    # The shaft turns with the whirl and keeps its bend. Simply supported, massless: k = 48 EI/l³ (1 + 12 EI/(κGA l²))⁻¹.
    machine = isotropic_machine(internal_damping=1e-3)
    inertia, area = math.pi / 64 * 0.03**4, math.pi / 4 * 0.03**2
    bending, shear = 2.1e11 * inertia, 6 * 1.3 / (7 + 6 * 0.3) * 2.1e11 / 2.6 * area
    stiffness = 1 / (1 / (48 * bending) + 1 / (4 * shear) + 1 / (2 * 1e9))
    critical = math.sqrt(stiffness / 5.0)
    speed = critical * np.array([0.3, 0.9, 1.1, 2.0])
    train = condense(machine, speed=speed, direction=np.ones(4))
    coefficients, unbalances = truth(machine)
    found = response(train, coefficients=coefficients, excitations=unbalances)
    expected = speed**2 * unbalances[0] / (stiffness - speed**2 * 5.0)
    assert np.abs(found[:, 0] / expected - 1).max() < 1e-4
    assert np.abs(found[:, 1] / expected + 1j).max() < 1e-4


def test_external_damping_of_a_simply_supported_shaft() -> None:
    # Stiffness-proportional damping of a massless shaft makes its stiffness k (1 + jωβ).
    document = one_disc_document(density=1e-3, kxx=1e12, kyy=1e12, cxx=1e-6, cyy=1e-6, mass=5.0)
    document["damping"] = {"beta": 2e-4}
    machine = parse_machine(document)
    bending, shear = (
        2.1e11 * math.pi / 64 * 0.03**4,
        6 * 1.3 / (7 + 6 * 0.3) * 2.1e11 / 2.6 * math.pi / 4 * 0.03**2,
    )
    stiffness = 1 / (1 / (48 * bending) + 1 / (4 * shear))
    speed = math.sqrt(stiffness / 5.0) * np.array([0.5, 1.0, 1.5])
    found = response(
        condense(machine, speed=speed, direction=np.ones(3)), coefficients=truth(machine)[0], excitations=truth(machine)[1]
    )
    expected = speed**2 * truth(machine)[1][0] / (stiffness * (1 + 2e-4j * speed) - speed**2 * 5.0)
    assert np.abs(found[:, 0] / expected - 1).max() < 1e-4


def with_own_damping(machine: Machine) -> FullTrain:
    """The full train with the damping and circulatory matrices of the rotor under test."""
    rotor = assemble_rotor(machine)
    _, damping, _ = elements(machine)
    return replace(full_train(machine), damping=rotor.damping + damping, circulatory=rotor.circulatory)


@pytest.mark.parametrize("sense", [1, -1])
def test_internal_damping_destabilises_above_the_critical_speed(sense: int) -> None:
    # Jeffcott rotor without external damping: the threshold of stability is the critical speed.
    train = with_own_damping(isotropic_machine(internal_damping=1e-4))
    critical = float(np.min(np.abs(train.eigenvalues(spin=0.0))))
    below, above = (train.eigenvalues(spin=sense * part * critical) for part in (0.98, 1.02))
    assert below.real.max() < 0.0
    assert above.real.max() > 0.0
    # Unstable in forward whirl with the first natural frequency.
    fastest = above[np.argmax(above.real)]
    assert abs(fastest) == pytest.approx(critical, rel=1e-3)


def test_external_damping_lifts_the_threshold() -> None:
    # With c_e = c_i the threshold lies at ω (1 + c_e/c_i) = 2 ω of the first critical speed.
    document = one_disc_document(density=1e-3, kxx=1e12, kyy=1e12, cxx=1e-6, cyy=1e-6, mass=5.0)
    document["materials"]["steel"]["internal_damping"] = 1e-5
    document["damping"] = {"beta": 1e-5}
    train = with_own_damping(parse_machine(document))
    critical = float(np.min(np.abs(train.eigenvalues(spin=0.0))))
    first = [
        max(root.real for root in train.eigenvalues(spin=part * critical) if abs(abs(root) - critical) < 0.05 * critical)
        for part in (1.98, 2.02)
    ]
    assert first[0] < 0.0 < first[1]


def test_damping_left_out_of_the_model_is_seen() -> None:
    document = damped_document()
    real = parse_machine(document)
    speed = np.arange(10.0, 300.0, 2.0)
    measurement = Measurement.of(speed=speed, phasor=noisy(full_response(real, speed), seed=1))
    assert identify(real, measurement).accepted
    document["damping"] = {"alpha": 0.0, "beta": 0.0}
    assert not identify(parse_machine(document), measurement).accepted
