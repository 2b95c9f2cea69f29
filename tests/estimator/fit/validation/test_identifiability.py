"""Reasons why parameters stay open, beside the modes of a dense eigenvalue analysis."""

import numpy as np

from estimator.fit.identify import identify
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.identifiability import reasons_for
from estimator.machine.document import Machine, parse_machine
from estimator.machine.rules import Noise
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import condense
from tests.estimator.full_train import coupling_nodes, full_response, full_train
from tests.estimator.statics.test_film_model import document as film_document
from tests.estimator.trains import Floats, chapter_3, chapter_3_document, noisy, one_disc_document


def modes(machine: Machine, spin: float) -> tuple[Floats, Floats, Floats]:
    """Damped natural frequencies (M,) [rad/s], the coupling's relative (x, y, θx, θy) per mode (4, M), energies (M,)."""
    train = full_train(machine)
    size = len(train.mass)
    inverse = np.linalg.inv(train.mass)
    damping, stiffness = train.damping + spin * train.gyroscopic, train.stiffness + spin * train.circulatory
    state = np.block([[np.zeros((size, size)), np.eye(size)], [-inverse @ stiffness, -inverse @ damping]])
    roots, vectors = np.linalg.eig(state)
    up = roots.imag > 1e-6 * np.abs(roots)
    shape, frequency = vectors[:size, up], roots.imag[up]
    driver, driven = coupling_nodes(machine, machine.couplings[0])
    apart = np.abs(shape[driver : driver + 4] - shape[driven : driven + 4])
    energy = np.einsum("im,ij,jm->m", shape.conj(), train.mass, shape).real * frequency**2
    return frequency, apart, energy


def test_coupling_that_no_mode_in_the_range_moves() -> None:
    machine = chapter_3()
    speed = np.linspace(60.0, 110.0, 80)
    found = identify(machine, Measurement.of(speed=speed, phasor=noisy(full_response(machine, speed), seed=0)))
    said = {
        one.name: one.reason
        for one in found.estimates
        if one.reason and "crosses no mode that moves coupling C1" in one.reason
    }
    assert said
    frequency, apart, energy = modes(machine, 85.0)
    inside = (frequency >= 60.0) & (frequency <= 110.0)
    row = {"kxx": 0, "kyy": 1, "k_phix": 2, "k_phiy": 3}
    checked = 0
    for name in said:
        own = name.rsplit(".", 1)[-1]
        if own not in row:
            continue
        share = getattr(machine.couplings[0], own) * apart[row[own]] ** 2 / energy
        # The fit's own values differ a little from the true ones: the border between the two is not sharp.
        assert share[inside].max(initial=0.0) < 0.02, name
        assert "speed range 573-1050 r/min" in (said[name] or "")
        checked += 1
    assert checked


def test_two_bearings_at_one_place_cannot_be_told_apart() -> None:
    document = one_disc_document(kxx=2e5, kyy=2.4e5)  # soft enough for the first modes to move them
    document["bearings"].append({**document["bearings"][0], "id": "B3", "station": 1e-4})
    document["probes"] += [{"id": f"E{a}", "shaft": "S", "station": 0.0, "angle_deg": a} for a in (0, 90)]
    document["probes"] += [{"id": f"F{a}", "shaft": "S", "station": 1.0, "angle_deg": a} for a in (0, 90)]
    machine = parse_machine(document)
    speed = np.linspace(20.0, 600.0, 150)
    found = identify(machine, Measurement.of(speed=speed, phasor=noisy(full_response(machine, speed), seed=0)))
    one = found.estimate("bearing.B3.kxx")
    assert not one.estimable
    assert "cannot be told from what others do, most of all bearing.B1.kxx" in (one.reason or "")
    assert found.estimate("bearing.B2.kxx").estimable


def test_what_is_estimable_has_no_reason() -> None:
    document = chapter_3_document()
    speed = np.arange(10.0, 300.0, 3.0)
    machine = parse_machine(document)
    found = identify(machine, Measurement.of(speed=speed, phasor=noisy(full_response(machine, speed), seed=0)))
    assert all((one.reason is None) == one.estimable for one in found.estimates)


def test_a_fit_that_ends_where_a_film_carries_nothing_has_a_reason_in_place_of_modes() -> None:
    """Its coefficients are no numbers, of which no eigenvalue problem can be solved."""
    machine = parse_machine(film_document(discrepancy=0.0))
    speed = np.linspace(100.0, 450.0, 6)
    measurement = Measurement.of(speed=speed, phasor=np.full((speed.size, len(machine.probes)), 1e-5 + 0j))
    train = condense(machine, speed=speed, direction=measurement.direction)
    coordinates = Coordinates.of(train, unbalance_scale=1.0)
    theta = coordinates.centre.copy()
    theta[coordinates.names.index("bearing.B1.clearance")] += np.log(30.0)
    assert np.isnan(coordinates.coefficients(theta)).any()
    nothing = np.zeros(measurement.phasor.shape, dtype=bool)
    problem = FitProblem(train, measurement, coordinates, Noise(relative=0.01, floor=0.0), nothing)
    size = coordinates.size
    found = FitResult(
        theta, np.nan, np.zeros((size, size)), False, 1, problem.noise, nothing, np.nan, np.ones(len(machine.probes))
    )
    reason = reasons_for(machine)(problem, found, np.eye(size))
    assert "a film carries no journal" in reason("bearing.B1.clearance")
