"""Response of a model with everything that a document can hold: slopes against differences, and its parts' meanings."""

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.machine.parts import Probe
from estimator.modes.critical_speed import critical_speed_table
from estimator.modes.eigenmodes import eigenvalue_slopes, eigenvalues, modes
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.parameters import dense, unknowns
from estimator.rotor.system_matrices import system_matrices
from estimator.updated_model.coupling_loads import coupling_forces
from estimator.updated_model.forced_response import forced_response
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.station_response import station_response
from tests.estimator.models import differences, model_of, rich_model
from tests.estimator.trains import chapter_3, dense_response

SPEED = np.array([60.0, 140.0, 250.0])


RICH = rich_model()


def test_the_rich_machine_has_a_coordinate_of_every_kind() -> None:
    for name in ("bearing.B1.kxx@1500rpm", "bearing.B3.cxy@3000rpm", "bearing.B3.kyy", "seal.G.mxx", "coupling.C1.kx_phiy"):
        assert name in RICH.coordinates
    for name in ("shaft.S1.bow.real", "coupling.C1.moment_x.imaginary", "material.steel.young_modulus"):
        assert name in RICH.coordinates
    assert not any(name.startswith(("probe", "bearing.B4", "seal.G.kxy", "disc.D4")) for name in RICH.coordinates)


def test_slopes_of_the_response_are_those_of_small_changes() -> None:
    found = forced_response(RICH, speed=SPEED)
    expected = differences(RICH, lambda model: forced_response(model, speed=SPEED).phasor)
    size = np.sqrt(np.diag(RICH.covariance))
    largest = np.abs(expected * size).max()
    assert found.slope * size == pytest.approx(expected * size, abs=1e-4 * largest)


def test_bands_of_coupling_forces_are_those_of_small_changes() -> None:
    (found,) = coupling_forces(RICH, speed=SPEED)
    names = ("force_x", "force_y", "moment_x", "moment_y")

    def loads(model: UpdatedModel) -> np.ndarray:
        (force,) = coupling_forces(model, speed=SPEED)
        return np.array([getattr(force, name).value for name in names])

    for name, slope in zip(names, differences(RICH, loads), strict=True):
        parts = np.stack([slope.real, slope.imag], axis=-2)
        expected = parts @ RICH.covariance @ np.swapaxes(parts, -1, -2)
        assert getattr(found, name).covariance == pytest.approx(expected, abs=1e-3 * np.abs(expected).max())


def test_matrices_and_condensation_agree_on_the_rich_machine() -> None:
    """The response to the discs' unbalances alone, from the full matrices of the scaled machine."""
    other = np.array([".bow." in name or ".force_" in name or ".moment_" in name for name in RICH.coordinates])
    model = replace(RICH, values=np.where(other, 0.0, RICH.values))
    rotor = assemble_rotor(model.machine)
    probe = model.machine.probes[3]
    found = station_response(model, speed=SPEED, places=[probe]).response.value[:, 0]
    for i, speed in enumerate(SPEED):
        matrices = system_matrices(model.scaled_machine, coefficients=model.coefficients(float(speed)))
        force = np.zeros(rotor.size, dtype=complex)
        for disc, unbalance in zip(model.machine.discs, model.excitations, strict=False):
            x = 4 * rotor.node(disc.shaft, disc.station)
            force[x : x + 2] += speed**2 * unbalance * np.array([1, -1j])
        q = np.linalg.solve(matrices.dynamic_stiffness(1j * speed, spin=float(speed)), force)
        x = 4 * rotor.node(probe.shaft, probe.station)
        angle = np.deg2rad(probe.angle_deg)
        assert found[i] == pytest.approx(q[x] * np.cos(angle) + q[x + 1] * np.sin(angle), rel=1e-7)


def test_eigenvalues_follow_every_kind_of_coefficient() -> None:
    machine, spin = RICH.scaled_machine, 200.0
    coefficients = RICH.coefficients(spin)
    found = modes(system_matrices(machine, coefficients=coefficients), spin=spin)
    assert found.eigenvalue[:8] == pytest.approx(eigenvalues(machine, coefficients=coefficients, spin=spin)[:8], rel=1e-8)
    slopes = eigenvalue_slopes(machine, found)[:8]
    names = [one.name for one in unknowns(machine, assemble_rotor(machine)).coefficients]
    for name in ("seal.G.mxx", "coupling.C1.kx_phiy", "coupling.C1.c_phix", "coupling.C1.k_phixy", "bearing.B2.cyx"):
        k = names.index(name)
        step = 1e-3 * abs(coefficients[k])
        shifted = []
        for sign in (1, -1):
            changed = coefficients.copy()
            changed[k] += sign * step
            shifted.append(eigenvalues(machine, coefficients=changed, spin=spin)[:8])
        expected = (shifted[0] - shifted[1]) / (2 * step)
        assert slopes[:, k] == pytest.approx(expected, abs=1e-4 * np.abs(expected).max())


def test_critical_speeds_of_coefficients_that_follow_the_speed() -> None:
    """At each of them the natural frequency with the coefficients of that very speed is the speed."""
    machine = RICH.scaled_machine
    found = critical_speed_table(machine, highest=400.0, coefficients=RICH.coefficients)
    assert len(found) >= 5
    for one in found:
        there = eigenvalues(machine, coefficients=RICH.coefficients(one.speed), spin=one.speed)
        assert np.min(np.abs(there.imag - one.speed)) < 1e-5


def test_what_is_added_moves_the_train_as_identified_unbalance_does() -> None:
    model = model_of(chapter_3())
    added = np.array([1e-3, 0.0, -2e-3j, 0.0])
    step = np.zeros(model.values.size)
    step[-8:] = np.stack([added.real, added.imag], axis=-1).reshape(-1)
    one = forced_response(model, speed=SPEED, added=added)
    other = forced_response(replace(model, values=model.values + step), speed=SPEED)
    assert one.phasor == pytest.approx(other.phasor, rel=1e-10)
    assert one.slope == pytest.approx(other.slope, rel=1e-10)


def test_rows_look_at_any_degree_of_freedom() -> None:
    machine, model = chapter_3(), model_of(chapter_3())
    rotor = assemble_rotor(machine)
    rows = dense([{4 * rotor.node(probe.shaft, probe.station): 1.0} for probe in machine.probes[:4]], rotor.size).T
    places = [Probe(id="x", shaft=probe.shaft, station=probe.station, angle_deg=0.0) for probe in machine.probes[:4]]
    found = forced_response(model, speed=SPEED, output=rows).phasor
    assert found == pytest.approx(station_response(model, speed=SPEED, places=places).response.value, rel=1e-12)
    assert forced_response(model, speed=SPEED).phasor == pytest.approx(dense_response(machine, SPEED, direction=1), rel=1e-8)
