"""The run-out of a coupling against closed forms, and its derivatives: two beams that overhang their bearings towards it.

Euler and Bernoulli's beam on two bearings L apart that overhangs by a: a force F and a moment M at its end move that by
α F + β M and tilt it by β F + γ M with α = a² (L + a) / 3EI, γ = (L + 3a) / 3EI. Two alike, one the other's mirror image, that
are joined rigidly with a run-out e are each bent by e / 2, with F = e / 2α and no moment; a tilt φ gives M = φ / 2γ alone.
"""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.machine.document import Machine, parse_machine
from estimator.rotor.condensation import condense
from estimator.rotor.response import response, sensitivity
from estimator.updated_model.coupling_loads import coupling_forces
from estimator.updated_model.model import expected_model
from tests.estimator.trains import chapter_3_document

SPAN, OVERHANG, DIAMETER, YOUNG = 1.2, 0.4, 0.03, 2e11
BENDING = YOUNG * math.pi * DIAMETER**4 / 64
ALPHA = OVERHANG**2 * (SPAN + OVERHANG) / (3 * BENDING)
GAMMA = (SPAN + 3 * OVERHANG) / (3 * BENDING)
OFFSET, ANGLE = 3e-6 * np.exp(0.4j), 5e-5 * np.exp(-1.1j)
SLOW = 0.05
"""Speed at which nothing but stiffness counts [rad/s]."""


def overhanging(stiffness: float = 1e10) -> Machine:
    length = SPAN + OVERHANG
    shaft = {"sections": [{"length": length, "outer_diameter": DIAMETER, "material": "steel"}]}
    stiff = {"kxx": 1e11, "kxy": 0.0, "kyx": 0.0, "kyy": 1e11, "cxx": 1e-3, "cxy": 0.0, "cyx": 0.0, "cyy": 1e-3}
    document = chapter_3_document()
    document["materials"] = {"steel": {"young_modulus": YOUNG, "density": 7850.0, "poisson_ratio": 0.3}}
    document["shafts"] = [{"id": "S1", **shaft}, {"id": "S2", **shaft}]
    document["discs"] = document["discs"][:1]
    document["discs"][0].update(shaft="S1", station=SPAN / 2, unbalance={"magnitude": 0.0, "angle_deg": 0.0})
    places = [("B1", "S1", 0.0), ("B2", "S1", SPAN), ("B3", "S2", OVERHANG), ("B4", "S2", length)]
    document["bearings"] = [{"id": name, "shaft": on, "station": station, **stiff} for name, on, station in places]
    coupling = stiff | {"kxx": stiffness, "kyy": stiffness}
    document["couplings"] = [
        {"id": "C1", "driver": "S1", "driven": "S2", **coupling, "k_phix": stiffness, "k_phiy": stiffness}
        | {"rotating_error": {"offset_spread": 1e-4, "angle_spread": 1e-3}}
    ]
    document["probes"] = [
        {"id": f"{on}{axis}", "shaft": on, "station": station, "angle_deg": angle}
        for on, station in (("S1", length), ("S2", 0.0))
        for axis, angle in (("X", 0.0), ("Y", 90.0))
    ]
    return parse_machine(document)


def expected_values(machine: Machine) -> Floats:
    train = condense(machine, speed=np.ones(1), direction=np.ones(1))
    return np.array([one.expected for one in train.unknowns.coefficients])


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("stiffness", [1e9, 1e10, 3e10])
def test_a_rigid_coupling_bends_its_shafts_by_its_run_out_however_stiff_it_is(stiffness: float, direction: float) -> None:
    train = condense(overhanging(), speed=np.array([SLOW]), direction=np.array([direction]))
    excitations = np.array([0.0, OFFSET, 0.0])
    # What the document expects of the stiffness is not what the coupling has.
    coefficients = expected_values(overhanging(stiffness))
    found = response(train, coefficients=coefficients, excitations=excitations)[0]
    turned = OFFSET if direction > 0 else np.conj(OFFSET)
    closed = np.array([-turned, 1j * direction * turned, turned, -1j * direction * turned]) / 2
    assert np.abs(found - closed).max() < 5e-3 * abs(OFFSET)  # of Timoshenko's beam: 0.2 %


def test_what_the_coupling_carries_is_that_of_the_closed_form() -> None:
    model = expected_model(overhanging())
    values = model.values.copy()
    for name, size in (("rotating_offset", OFFSET), ("rotating_angle", ANGLE)):
        for part, value in (("real", size.real), ("imaginary", size.imag)):
            values[model.coordinates.index(f"coupling.C1.{name}.{part}")] = value
    found = coupling_forces(replace(model, values=values), speed=np.array([SLOW]))[0]
    assert abs(found.force.value[0]) == pytest.approx(abs(OFFSET) / (2 * ALPHA), rel=0.01)
    assert abs(found.moment.value[0]) == pytest.approx(abs(ANGLE) / (2 * GAMMA), rel=0.01)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_derivatives_beside_a_run_out(direction: float) -> None:
    """Against central differences, of all coefficients of the coupling, its cross-coupled ones included."""
    machine = overhanging(1e6)
    train = condense(machine, speed=np.array([20.0, 90.0, 250.0]), direction=np.full(3, direction))
    names = [one.name for one in train.unknowns.coefficients]
    coefficients = expected_values(machine) + np.array([3e4 * (name == "coupling.C1.kxy") for name in names])
    excitations = np.array([1e-4 * np.exp(0.3j), 1e-5 * OFFSET / abs(OFFSET), ANGLE])
    slope = sensitivity(train, coefficients=coefficients, excitations=excitations)
    assert np.allclose(slope.phasor, response(train, coefficients=coefficients, excitations=excitations), rtol=1e-10)
    for k in [place for place, name in enumerate(names) if name.startswith("coupling.")]:
        step = np.zeros(len(names))
        step[k] = 1e-4 * max(abs(coefficients[k]), 1.0)
        ends = [response(train, coefficients=coefficients + sign * step, excitations=excitations) for sign in (1, -1)]
        difference = (ends[0] - ends[1]) / (2 * step[k])
        rounding = 1e-10 * np.abs(ends[0]).max() / step[k]
        assert np.abs(slope.by_coefficient[k] - difference).max() < 1e-5 * np.abs(difference).max() + rounding, names[k]
