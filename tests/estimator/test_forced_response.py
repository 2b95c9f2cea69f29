"""Response of a model with everything that a document can hold: slopes against differences, and its parts' meanings."""

import copy
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from models import model_of
from trains import chapter_3, chapter_3_document, dense_response

from estimator.condensation import condense
from estimator.coordinates import Coordinates
from estimator.critical_speed import critical_speed_table
from estimator.forced_response import forced_response
from estimator.machine import Probe, parse_machine
from estimator.misalignment_force import coupling_forces
from estimator.modes import eigenvalue_slopes, eigenvalues, modes
from estimator.parameters import dense, unknowns
from estimator.rotor import assemble_rotor
from estimator.station_response import station_response
from estimator.system_matrices import system_matrices
from estimator.updated_model import UpdatedModel, with_exact_probes

SPEED = np.array([60.0, 140.0, 250.0])


def rich_document() -> dict[str, Any]:
    """Chapter 3 with a seal, all coupling terms, uncertain E and ρ, a bow, equivalent loads, rules, speed dependence."""
    document = copy.deepcopy(chapter_3_document())
    bearings, coupling = document["bearings"], document["couplings"][0]
    bearings[0]["speed_dependence"] = {"form": "piecewise", "knots_rpm": [500, 1500, 3000]}
    bearings[2]["speed_dependence"] = {"form": "polynomial", "knots_rpm": [500, 3000], "coefficients": ["kxx", "cxy"]}
    lateral = {"kxx": 2e4, "kxy": 4e3, "kyx": -4e3, "kyy": 2e4, "cxx": 90.0, "cxy": 1.0, "cyx": -1.0, "cyy": 90.0}
    document["seals"] = [{"id": "G", "shaft": "S1", "station": 0.5, **lateral, "mxx": 0.2, "myy": 0.3}]
    coupling |= {"k_phixy": 1e3, "k_phiyx": 2e3, "c_phix": 5.0, "c_phiy": 6.0, "kx_phiy": 3e4, "ky_phix": -2e4}
    coupling["driver_half"] = {"mass": 0.5, "diametral_inertia": 1e-3, "polar_inertia": 2e-3}
    coupling["load"] = {"force_spread": 10.0, "moment_spread": 2.0}
    document["materials"]["steel"] |= {"young_modulus_spread": 0.02, "density_spread": 0.03, "internal_damping": 1e-6}
    document["shafts"][0]["bow_spread"] = 1e-5
    document["parameters"] = [
        {"names": "bearing.B4.*", "tied_to": "bearing.B2"},
        {"names": "seal.G.kxy", "fixed": True},
        {"names": "disc.D4.unbalance", "fixed": True},
    ]
    for probe in document["probes"]:
        probe |= {"gain_spread": 0.02, "run_out_spread": 1e-6}
    return document


@pytest.fixture(scope="module")
def rich() -> UpdatedModel:
    """A random state of that machine near its document."""
    machine = with_exact_probes(parse_machine(rich_document()))
    coordinates = Coordinates.of(condense(machine, speed=np.ones(1), direction=np.ones(1)), unbalance_scale=1e-2)
    theta = coordinates.centre + 0.1 * np.random.default_rng(4).standard_normal(coordinates.size)
    return UpdatedModel(machine, coordinates.names, coordinates.unit * theta, np.diag((0.01 * coordinates.unit) ** 2))


def differences(model: UpdatedModel, function: Any) -> np.ndarray:
    """Derivatives (..., n) of a function of the model by its coordinates."""
    columns = []
    for place, size in enumerate(np.sqrt(np.diag(model.covariance))):
        step = np.zeros(model.values.size)
        step[place] = 1e-2 * size
        ahead, behind = (function(replace(model, values=model.values + sign * step)) for sign in (1, -1))
        columns.append((ahead - behind) / (2e-2 * size))
    return np.stack(columns, axis=-1)


def test_the_rich_machine_has_a_coordinate_of_every_kind(rich: UpdatedModel) -> None:
    for name in ("bearing.B1.kxx@1500rpm", "bearing.B3.cxy@3000rpm", "bearing.B3.kyy", "seal.G.mxx", "coupling.C1.kx_phiy"):
        assert name in rich.coordinates
    for name in ("shaft.S1.bow.real", "coupling.C1.moment_x.imaginary", "material.steel.young_modulus"):
        assert name in rich.coordinates
    assert not any(name.startswith(("probe", "bearing.B4", "seal.G.kxy", "disc.D4")) for name in rich.coordinates)


def test_slopes_of_the_response_are_those_of_small_changes(rich: UpdatedModel) -> None:
    found = forced_response(rich, speed=SPEED)
    expected = differences(rich, lambda model: forced_response(model, speed=SPEED).phasor)
    size = np.sqrt(np.diag(rich.covariance))
    largest = np.abs(expected * size).max()
    assert found.slope * size == pytest.approx(expected * size, abs=1e-4 * largest)


def test_bands_of_coupling_forces_are_those_of_small_changes(rich: UpdatedModel) -> None:
    (found,) = coupling_forces(rich, speed=SPEED)
    names = ("force_x", "force_y", "moment_x", "moment_y")

    def loads(model: UpdatedModel) -> np.ndarray:
        (force,) = coupling_forces(model, speed=SPEED)
        return np.array([getattr(force, name).value for name in names])

    for name, slope in zip(names, differences(rich, loads), strict=True):
        parts = np.stack([slope.real, slope.imag], axis=-2)
        expected = parts @ rich.covariance @ np.swapaxes(parts, -1, -2)
        assert getattr(found, name).covariance == pytest.approx(expected, abs=1e-3 * np.abs(expected).max())


def test_matrices_and_condensation_agree_on_the_rich_machine(rich: UpdatedModel) -> None:
    """The response to the discs' unbalances alone, from the full matrices of the scaled machine."""
    other = np.array([".bow." in name or ".force_" in name or ".moment_" in name for name in rich.coordinates])
    model = replace(rich, values=np.where(other, 0.0, rich.values))
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


def test_eigenvalues_follow_every_kind_of_coefficient(rich: UpdatedModel) -> None:
    machine, spin = rich.scaled_machine, 200.0
    coefficients = rich.coefficients(spin)
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


def test_critical_speeds_of_coefficients_that_follow_the_speed(rich: UpdatedModel) -> None:
    """At each of them the natural frequency with the coefficients of that very speed is the speed."""
    machine = rich.scaled_machine
    found = critical_speed_table(machine, highest=400.0, coefficients=rich.coefficients)
    assert len(found) >= 5
    for one in found:
        there = eigenvalues(machine, coefficients=rich.coefficients(one.speed), spin=one.speed)
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
