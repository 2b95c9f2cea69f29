"""Mode shapes: those of a uniform simply supported shaft and of a rigid rotor in closed form, and the eigenproblem itself."""

import math

import numpy as np
import pytest

from estimator.machine.document import parse_machine
from estimator.modes.eigenmodes import eigenvalue_slopes, eigenvalues, modes
from estimator.modes.mode_shapes import ModeShape, mode_shapes
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.system_matrices import system_matrices
from tests.estimator.rigid_rotor import LENGTH, bounce, conical, rigid_rotor
from tests.estimator.trains import chapter_3, dense_elements, one_disc_document

INERTIA = {"diametral": 0.04, "polar": 0.03}


def whole(shape: ModeShape) -> np.ndarray:
    """All degrees of freedom (N,) of a mode shape."""
    columns = [np.stack([one.x, one.y, one.theta_x, one.theta_y], axis=-1).reshape(-1) for one in shape.shafts]
    return np.concatenate(columns)


def test_shapes_solve_the_eigenproblem() -> None:
    machine, spin = chapter_3(), 200.0
    rotor = assemble_rotor(machine)
    stiffness, damping = dense_elements(machine)
    found = mode_shapes(machine, spin=spin, highest_frequency=600.0)
    assert len(found) >= 8
    for shape in found:
        root = shape.eigenvalue
        elastic = (rotor.stiffness + stiffness) @ whole(shape)
        rest = root * (damping + spin * rotor.gyroscopic) @ whole(shape) + root**2 * rotor.mass @ whole(shape)
        assert np.abs(elastic + rest).max() < 1e-8 * np.abs(elastic).max()


def test_largest_node_is_at_the_end_of_its_axis_at_first() -> None:
    for shape in mode_shapes(chapter_3(), spin=200.0, highest_frequency=600.0):
        major = np.concatenate([one.orbit.semi_major for one in shape.shafts])
        x, y = (np.concatenate([getattr(one, name) for one in shape.shafts]) for name in "xy")
        assert major.max() == pytest.approx(1.0)
        node = int(np.argmax(major))
        assert math.hypot(x[node].real, y[node].real) == pytest.approx(1.0)


def test_shaft_on_pinned_ends_bends_in_a_sine() -> None:
    """Slender, light disc, stiff bearings: shear, rotary inertia and support move the shape by some 1e-3."""
    document = one_disc_document(
        mass=1e-6, diametral_inertia=0.0, polar_inertia=0.0, kxx=1e10, kyy=1.1e10, element_length=0.05
    )
    first = mode_shapes(parse_machine(document), spin=0.0, highest_frequency=500.0)
    assert len(first) == 2
    for shape in first:
        (shaft,) = shape.shafts
        assert shaft.orbit.semi_major == pytest.approx(np.sin(math.pi * shaft.station), abs=2e-3)
        slope = np.hypot(np.abs(shaft.theta_x), np.abs(shaft.theta_y))
        assert slope == pytest.approx(math.pi * np.abs(np.cos(math.pi * shaft.station)), abs=2e-2)


def test_rigid_rotor_whirls_in_circles() -> None:
    found = mode_shapes(rigid_rotor(**INERTIA), spin=300.0, highest_frequency=600.0)
    by_frequency = {shape.frequency: shape for shape in found}
    for forward, sign in ((True, 1.0), (False, -1.0)):
        expected = conical(300.0, **INERTIA, forward=forward)
        shape = by_frequency[min(by_frequency, key=lambda value: abs(value - expected))]
        assert shape.frequency == pytest.approx(expected, rel=1e-4)
        (shaft,) = shape.shafts
        assert shape.whirl == pytest.approx(sign, abs=1e-6)
        assert shaft.orbit.semi_major == pytest.approx(np.abs(shaft.station / (LENGTH / 2) - 1), abs=1e-4)
        assert shaft.orbit.semi_minor == pytest.approx(sign * shaft.orbit.semi_major, abs=1e-6)
    assert sum(abs(shape.frequency / bounce() - 1) < 1e-4 for shape in found) == 2


def test_whirl_at_negative_spin_is_recognised_by_the_spin() -> None:
    up = mode_shapes(rigid_rotor(**INERTIA), spin=300.0, highest_frequency=600.0)
    down = mode_shapes(rigid_rotor(**INERTIA), spin=-300.0, highest_frequency=600.0)
    assert [one.frequency for one in down] == pytest.approx([one.frequency for one in up], rel=1e-7)
    conical_whirl = [[one.whirl for one in found if abs(one.whirl) > 0.999] for found in (up, down)]
    assert conical_whirl[0][0] == pytest.approx(conical_whirl[1][0])


def test_positive_damping_takes_energy_from_every_mode() -> None:
    for spin in (0.0, 150.0, 500.0):
        document = one_disc_document(disc_station=0.3, kxy=0.0, kyx=0.0, cxx=200.0, cyy=500.0, kxx=1e6, kyy=3e6)
        matrices = system_matrices(parse_machine(document))
        found = modes(matrices, spin=spin)
        taken = np.sum(np.conj(found.shape) * (matrices.damping @ found.shape), axis=0).real
        assert np.all(taken >= 0)
        assert np.all(found.eigenvalue.real < 0)
        # The quadratic form xᴴ Z x = 0: its imaginary part balances damping against growth and gyroscopic moments.
        balance = [
            np.vdot(x, matrices.dynamic_stiffness(root, spin=spin) @ x) / np.vdot(x, matrices.stiffness @ x)
            for root, x in zip(found.eigenvalue[:6], found.shape[:, :6].T, strict=True)
        ]
        assert np.abs(balance).max() < 1e-8


def test_slopes_of_the_eigenvalues_are_those_of_small_changes() -> None:
    machine, spin = chapter_3(), 250.0
    coefficients = np.array([200.0 if c == 0 else c for c in _expected()])
    found = modes(system_matrices(machine, coefficients=coefficients), spin=spin)
    slopes = eigenvalue_slopes(machine, found)[:8]
    for number in (0, 3, 5, 12, 30, 35, 40, 41):
        step = 1e-4 * abs(coefficients[number])
        shifted = []
        for sign in (1, -1):
            changed = coefficients.copy()
            changed[number] += sign * step
            shifted.append(eigenvalues(machine, coefficients=changed, spin=spin)[:8])
        expected = (shifted[0] - shifted[1]) / (2 * step)
        assert slopes[:, number] == pytest.approx(expected, rel=1e-4, abs=1e-6 * np.abs(slopes[:, number]).max() + 1e-12)


def _expected() -> list[float]:
    machine = chapter_3()
    parts = [*machine.bearings, *machine.couplings]
    names = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy", "k_phix", "k_phiy")
    return [float(getattr(part, name)) for part in parts for name in names if hasattr(part, name)]
