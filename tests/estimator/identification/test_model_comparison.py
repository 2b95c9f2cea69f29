"""Tests which view of misalignment a run prefers, on runs of which the truth is known; runs and baseline have 1 % noise."""

import numpy as np
import pytest

from estimator.fit.identification import Identification
from estimator.fit.identify import identify
from estimator.identification.model_comparison import ModelComparison, compare_misalignment, with_identified_values
from estimator.machine.document import parse_machine
from estimator.phasors.measurement import Measurement
from estimator.rotor.assembly import assemble_rotor
from tests.estimator.trains import (
    Complexes,
    Document,
    Floats,
    chapter_3,
    chapter_3_document,
    dense_elements,
    dense_response,
    noisy,
)

SPEED: Floats = np.arange(4.0, 300.0, 4.0)


def measured(phasor: Complexes, seed: int) -> Measurement:
    return Measurement.of(speed=SPEED, phasor=noisy(phasor, seed=seed))


@pytest.fixture(scope="module")
def baseline() -> Identification:
    return identify(chapter_3(), measured(dense_response(chapter_3(), SPEED, direction=1), seed=0))


def compared(phasor: Complexes, baseline: Identification) -> ModelComparison:
    return compare_misalignment(chapter_3(), measured(phasor, seed=1), baseline=baseline, coupling="C1")


def stiffened(document: Document, factor: float) -> Document:
    for part in (document["couplings"][0], document["bearings"][1], document["bearings"][2]):
        for name in ("kxx", "kxy", "kyx", "kyy"):
            part[name] *= factor
    return document


def with_load(force: complex, moment: complex) -> Complexes:
    """Equal and opposite synchronous forces along x and moments about y in the coupling, added to the unbalance's response."""
    machine = chapter_3()
    rotor = assemble_rotor(machine)
    stiffness, damping = dense_elements(machine)
    ends = 4 * rotor.end_node("S1"), 4 * rotor.first_node["S2"]
    extra = np.empty((SPEED.size, 8), dtype=complex)
    for i, omega in enumerate(SPEED):
        load = np.zeros(rotor.size, dtype=complex)
        for end, sign in zip(ends, (1, -1), strict=True):
            load[end] += sign * force
            load[end + 3] += sign * moment
        dynamic = rotor.stiffness + stiffness - omega**2 * rotor.mass + 1j * omega * (damping + omega * rotor.gyroscopic)
        displacement = np.linalg.solve(dynamic, load)
        extra[i] = [displacement[4 * rotor.node(p.shaft, p.station) + (1 if p.angle_deg == 90 else 0)] for p in machine.probes]
    return dense_response(machine, SPEED, direction=1) + extra


def test_an_unchanged_machine_is_unchanged(baseline: Identification) -> None:
    found = compared(dense_response(chapter_3(), SPEED, direction=1), baseline)
    assert found.preferred == "unchanged", found.verdict


def test_stiffer_elements_are_changed_coefficients(baseline: Identification) -> None:
    machine = parse_machine(stiffened(chapter_3_document(), 1.2))
    found = compared(dense_response(machine, SPEED, direction=1), baseline)
    assert found.preferred == "changed coefficients", found.verdict
    assert found.views[0].identification.accepted
    estimate = found.views[0].identification.estimate("bearing.B2.kxx")
    assert estimate.lower is not None
    assert estimate.upper is not None
    assert estimate.lower < 1.2 * 275000 < estimate.upper


def test_synchronous_loads_are_an_equivalent_load(baseline: Identification) -> None:
    found = compared(with_load(30.0 + 10.0j, 4.0 - 8.0j), baseline)
    assert found.preferred == "equivalent load", found.verdict
    force = found.views[0].identification.estimate("coupling.C1.force_x")
    moment = found.views[0].identification.estimate("coupling.C1.moment_y")
    for one, true in ((force, 30.0 + 10.0j), (moment, 4.0 - 8.0j)):
        assert one.value is not None
        assert one.imaginary is not None
        assert one.standard_error is not None
        # The baseline's own errors, some per cent, come on top of the standard error.
        assert abs(complex(one.value, one.imaginary) - true) < 0.1 * abs(true) + 3 * one.standard_error


def test_what_none_explains_is_said_to_be_so(baseline: Identification) -> None:
    document = chapter_3_document()
    document["bearings"][0]["kxx"] *= 1.5  # at the far end of the train
    found = compared(dense_response(parse_machine(document), SPEED, direction=1), baseline)
    assert found.preferred is None
    assert "none of the views explains" in found.verdict


def test_a_machine_as_identified_has_the_identified_values(baseline: Identification) -> None:
    machine = with_identified_values(chapter_3(), baseline)
    assert machine.bearings[1].kxx == pytest.approx(baseline.estimate("bearing.B2.kxx").value, rel=1e-12)
    assert machine.couplings[0].cxy == pytest.approx(baseline.estimate("coupling.C1.cxy").value, rel=1e-12)
    unbalance = baseline.estimate("disc.D3.unbalance")
    assert machine.discs[2].unbalance is not None
    assert unbalance.value is not None
    assert unbalance.imaginary is not None
    assert machine.discs[2].unbalance.magnitude == pytest.approx(np.hypot(unbalance.value, unbalance.imaginary))


def test_a_coupling_that_is_not_there(baseline: Identification) -> None:
    with pytest.raises(KeyError, match="C9"):
        compare_misalignment(
            chapter_3(), measured(np.ones((SPEED.size, 8), dtype=complex), 0), baseline=baseline, coupling="C9"
        )


def test_an_unbalance_that_changed_is_reported_beside_the_verdict(baseline: Identification) -> None:
    document = chapter_3_document()
    document["discs"][0]["unbalance"] = {"magnitude": 0.0142, "angle_deg": 76}
    found = compared(dense_response(parse_machine(document), SPEED, direction=1), baseline)
    assert found.preferred == "unchanged"
    assert "unbalance has changed: disc.D1.unbalance by" in found.verdict
    assert "D2" not in found.verdict


def test_coefficients_that_follow_the_speed_cannot_be_held() -> None:
    document = chapter_3_document()
    document["bearings"][1]["speed_dependence"] = {"form": "piecewise", "knots_rpm": [500, 2500], "coefficients": ["kxx"]}
    machine = parse_machine(document)
    run = measured(dense_response(chapter_3(), SPEED, direction=1), seed=1)
    with pytest.raises(ValueError, match=r"bearing\.B2\.kxx follow the speed"):
        compare_misalignment(machine, run, baseline=identify(machine, run), coupling="C1")
