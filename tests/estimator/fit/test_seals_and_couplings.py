"""Seals with fluid inertia, coupling halves, and couplings with all their terms, against full solves."""

import math
from typing import Any

import numpy as np
import pytest

from estimator.fit.identification import Options
from estimator.fit.identify import identify
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import Measurement
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.condensation import condense
from estimator.rotor.parameters import unknowns
from estimator.rotor.response import response, sensitivity
from tests.estimator.full_train import deviations, full_response, full_train, true_values
from tests.estimator.trains import Complexes, Document, Floats, chapter_3_document, noisy, truth

SPARSE: Floats = np.array([10.0, 61.0, 122.0, 176.0, 283.0, 431.0])
SPEED: Floats = np.arange(10.0, 500.0, 3.0)
SEAL: Document = {"id": "N1", "shaft": "S1", "station": 0.5, "kxx": 4e4, "kxy": 3e4, "kyx": -3e4, "kyy": 5e4}
SEAL |= {"cxx": 120.0, "cxy": 15.0, "cyx": -15.0, "cyy": 140.0, "mxx": 0.8, "myy": 0.6}
HALVES: Document = {
    "driver_half": {"mass": 0.9, "diametral_inertia": 0.002, "polar_inertia": 0.003},
    "driven_half": {"mass": 0.7, "diametral_inertia": 0.001, "polar_inertia": 0.0025},
}
TERMS: Document = {"k_phixy": 6e4, "k_phiyx": 3e4, "c_phix": 40.0, "c_phiy": 55.0, "kx_phiy": 5e4, "ky_phix": -3e4}


def machine_with(*, seal: Document | None = None, coupling: Document | None = None, **changes: Any) -> Machine:
    document = chapter_3_document()
    if seal:
        document["seals"] = [seal]
    document["couplings"][0].update(coupling or {})
    document.update(changes)
    return parse_machine(document)


def condensed_response(machine: Machine, direction: int) -> Complexes:
    train = condense(machine, speed=SPARSE, direction=np.full(SPARSE.size, float(direction)))
    coefficients, unbalances = truth(machine)
    return response(train, coefficients=coefficients, excitations=unbalances)


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize(
    "machine",
    [
        machine_with(seal=SEAL),
        machine_with(coupling=HALVES),
        machine_with(coupling=TERMS),
        machine_with(coupling={"kx_phiy": 5e4}),
        machine_with(seal=SEAL, coupling=HALVES | TERMS),
    ],
    ids=["seal", "coupling halves", "coupling terms", "one coupling term", "all"],
)
def test_condensed_response_is_that_of_the_full_train(machine: Machine, direction: int) -> None:
    found, expected = condensed_response(machine, direction), full_response(machine, SPARSE, direction=direction)
    assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()
    plain = full_response(machine_with(), SPARSE, direction=direction)
    assert np.abs(plain - expected).max() > 1e-3 * np.abs(expected).max()


def test_derivatives_by_inertia_and_coupling_terms() -> None:
    machine = machine_with(seal=SEAL, coupling=TERMS)
    train = condense(machine, speed=SPARSE, direction=np.ones(SPARSE.size))
    coefficients, unbalances = truth(machine)
    found = sensitivity(train, coefficients=coefficients, excitations=unbalances).by_coefficient
    assert len(found) == 5 * 8 + 2 + 8 + 2 + 6
    for k in range(len(found)):
        step = np.zeros(coefficients.size)
        step[k] = 1e-5 * coefficients[k]
        up, down = (response(train, coefficients=coefficients + s, excitations=unbalances) for s in (step, -step))
        expected = (up - down) / (2 * step[k])
        assert np.abs(found[k] - expected).max() < 1e-5 * np.abs(expected).max(), train.unknowns.coefficients[k].name


def test_coupling_half_is_a_disc_at_the_end_of_its_shaft() -> None:
    halves = machine_with(coupling=HALVES)
    document = chapter_3_document()
    for half, shaft, station in (("driver_half", "S1", 1.25), ("driven_half", "S2", 0.0)):
        document["discs"].append({"id": half, "shaft": shaft, "station": station, **HALVES[half]})
    discs = parse_machine(document)
    rotors = assemble_rotor(halves), assemble_rotor(discs)
    assert np.allclose(rotors[0].mass, rotors[1].mass, rtol=1e-14)
    assert np.allclose(rotors[0].gyroscopic, rotors[1].gyroscopic, rtol=1e-14)
    # A half is no balancing plane: nothing is identified there.
    assert len(unknowns(halves, rotors[0]).excitations) == 4


def test_massless_half_changes_nothing() -> None:
    nothing = {"driver_half": {"mass": 0.0}, "driven_half": {"mass": 0.0}}
    assert np.array_equal(condensed_response(machine_with(coupling=nothing), 1), condensed_response(machine_with(), 1))


def test_reciprocity_of_symmetric_terms() -> None:
    # What is symmetric and does not turn moves at i from a force at j as it moves at j from a force at i.
    document = chapter_3_document()
    for part in (*document["bearings"], *document["couplings"]):
        part["kyx"], part["cyx"] = part["kxy"], part["cxy"]
    document["couplings"][0].update(TERMS | {"k_phiyx": TERMS["k_phixy"]})
    document["seals"] = [SEAL | {"kyx": SEAL["kxy"], "cyx": SEAL["cxy"]}]
    for disc in document["discs"]:
        disc["polar_inertia"] = 0.0
    document["materials"]["steel"]["density"] = 1e-6  # no gyroscopic moment
    machine = parse_machine(document)
    train = condense(machine, speed=SPARSE, direction=np.ones(SPARSE.size))
    dynamic = train.dynamic_stiffness(truth(machine)[0])
    assert np.abs(dynamic - dynamic.swapaxes(1, 2)).max() < 1e-9 * np.abs(dynamic).max()
    full = full_train(machine).dynamic_stiffness(122.0)
    assert np.abs(full - full.T).max() < 1e-9 * np.abs(full).max()
    document["couplings"][0]["k_phiyx"] = 0.0
    skewed = condense(parse_machine(document), speed=SPARSE, direction=np.ones(SPARSE.size))
    dynamic = skewed.dynamic_stiffness(truth(parse_machine(document))[0])
    assert np.abs(dynamic - dynamic.swapaxes(1, 2)).max() > 1e-9 * np.abs(dynamic).max()


def test_coupled_terms_are_those_of_a_beam() -> None:
    """A coupling with a short beam's stiffness at its driven end: a force along x bends by x = F l³/3EI and θy = F l²/2EI."""
    length, bending = 0.1, 5e3
    machine = machine_with(
        coupling={
            "kxx": 12 * bending / length**3,
            "kyy": 12 * bending / length**3,
            "k_phix": 4 * bending / length,
            "k_phiy": 4 * bending / length,
            "kx_phiy": -6 * bending / length**2,
            "ky_phix": 6 * bending / length**2,
            "kxy": 0.0,
            "kyx": 0.0,
        }
    )
    rotor = assemble_rotor(machine)
    driven = 4 * rotor.node("S2", 0.0)
    block = np.zeros((4, 4))
    for one in unknowns(machine, rotor).coefficients:
        if one.element == "coupling.C1" and one.order == 0:
            for left, right in one.pairs:
                for row, a in left.items():
                    for column, b in right.items():
                        if driven <= row < driven + 4 and driven <= column < driven + 4:
                            block[row - driven, column - driven] += (one.nominal or 0.0) * a * b
    along_x = np.linalg.solve(block, [1.0, 0.0, 0.0, 0.0])
    along_y = np.linalg.solve(block, [0.0, 1.0, 0.0, 0.0])
    assert along_x == pytest.approx([length**3 / (3 * bending), 0.0, 0.0, length**2 / (2 * bending)])
    # A positive slope of the y-z plane is a negative θx.
    assert along_y == pytest.approx([0.0, length**3 / (3 * bending), -(length**2) / (2 * bending), 0.0])


def test_seal_is_identified_with_its_inertia() -> None:
    machine = machine_with(
        seal=SEAL,
        probes=[
            *chapter_3_document()["probes"],
            {"id": "N1X", "shaft": "S1", "station": 0.5, "angle_deg": 45},
            {"id": "N1Y", "shaft": "S1", "station": 0.5, "angle_deg": 135},
        ],
    )
    real = machine_with(seal=SEAL | {"mxx": 1.1, "myy": 0.5, "kxx": 3e4, "cyy": 200.0}, probes=dumped_probes(machine))
    found = identify(machine, Measurement.of(speed=SPEED, phasor=noisy(full_response(real, SPEED), seed=3)))
    assert found.accepted, found.verdict
    expected = true_values(real)
    inertia = [found.estimate(f"seal.N1.{name}") for name in ("mxx", "myy")]
    assert all(one.estimable and one.unit == "kg" and one.quantity == "inertia" for one in inertia)
    assert np.abs(deviations(found, expected)).max() < 4.5
    assert 0.75 < math.sqrt(np.mean(deviations(found, expected) ** 2)) < 1.25


def dumped_probes(machine: Machine) -> list[Any]:
    return [probe.model_dump() for probe in machine.probes]


def test_seal_without_inertia_in_the_document_has_none() -> None:
    plain = {name: value for name, value in SEAL.items() if name not in ("mxx", "myy")}
    machine = machine_with(seal=plain)
    names = unknowns(machine, assemble_rotor(machine)).names
    assert [name for name in names if name.startswith("seal")] == [
        f"seal.N1.{name}" for name in ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")
    ]


def test_coupling_terms_are_identified_from_all_that_a_coupling_moves() -> None:
    # Softer in bending than Chapter 3's, with probes at both halves: else nothing sees these terms.
    soft = {"k_phix": 900.0, "k_phiy": 800.0, "k_phixy": 150.0, "k_phiyx": 90.0, "c_phix": 2.0, "c_phiy": 3.0}
    soft |= {"kx_phiy": 4e3, "ky_phix": -3e3}
    probes = [
        *chapter_3_document()["probes"],
        *({"id": f"E{a}", "shaft": "S1", "station": 1.25, "angle_deg": a} for a in (0, 90)),
        *({"id": f"F{a}", "shaft": "S2", "station": 0.0, "angle_deg": a} for a in (0, 90)),
    ]
    real = machine_with(coupling=HALVES | soft, probes=probes)
    nominal = machine_with(coupling=HALVES | {name: 1.3 * value for name, value in soft.items()}, probes=probes)
    measurement = Measurement.of(speed=SPEED, phasor=noisy(full_response(real, SPEED), seed=4))
    found = identify(nominal, measurement)
    assert found.accepted, found.verdict
    estimable = [name for name in soft if found.estimate(f"coupling.C1.{name}").estimable]
    assert set(estimable) >= {"k_phix", "k_phiy", "k_phixy", "k_phiyx"}
    assert np.abs(deviations(found, true_values(real))).max() < 4.5
    # Without the halves' masses the model cannot follow.
    without = machine_with(coupling=soft, probes=probes)
    assert not identify(without, measurement, Options(starts=1)).accepted
