"""Natural frequencies and critical speeds.

References: |λ| of the Chapter 3 train at standstill = 122, 143, 162, 176, 283, 336, 403, 432 rad/s within 1, which an
independent program (ROSS) finds too; the generalised eigenvalue problem written down in this file (relative 1e-8); the
Jeffcott rotor's damped frequency in closed form (1e-6). A critical speed satisfies Im λ = Ω within 1e-4 rad/s.
"""

import math

import numpy as np
import pytest
import scipy.linalg
from numpy.typing import NDArray

from estimator.machine.document import Machine, parse_machine
from estimator.modes.critical_speed import critical_speeds
from estimator.modes.eigenmodes import eigenvalues, natural_frequencies
from estimator.rotor.assembly import assemble_rotor
from tests.estimator.trains import chapter_3, chapter_3_document, dense_elements, mirrored, one_disc_document, truth

PRINTED = np.array([122.0, 143.0, 162.0, 176.0, 283.0, 336.0, 403.0, 432.0])


def pencil(machine: Machine, spin: float) -> NDArray[np.complex128]:
    """Eigenvalues of λ B z = A z with z = (q, dq/dt), those with positive imaginary part by ascending imaginary part."""
    rotor = assemble_rotor(machine)
    stiffness, damping = dense_elements(machine)
    size = rotor.size
    a = np.block([[np.zeros((size, size)), np.eye(size)], [-rotor.stiffness - stiffness, -damping - spin * rotor.gyroscopic]])
    roots = np.asarray(scipy.linalg.eigvals(a, scipy.linalg.block_diag(np.eye(size), rotor.mass)), dtype=complex)
    roots = roots[roots.imag > 1e-6 * np.abs(roots)]
    return np.asarray(roots[np.argsort(roots.imag)])


def test_chapter_3_at_standstill() -> None:
    assert np.abs(eigenvalues(chapter_3())[:8]) == pytest.approx(PRINTED, abs=1.0)


@pytest.mark.parametrize("spin", [0.0, 150.0, -400.0])
def test_eigenvalues_are_those_of_the_pencil(spin: float) -> None:
    found, expected = eigenvalues(chapter_3(), spin=spin)[:12], pencil(chapter_3(), spin)[:12]
    assert found == pytest.approx(expected, rel=1e-8)


def test_chapter_3_has_damped_modes_in_ascending_order() -> None:
    found = eigenvalues(chapter_3(), spin=200.0)
    assert np.all(found.imag > 0)
    assert np.all(np.diff(found.imag) >= 0)
    assert np.all(found.real < 0), "stable at this speed"
    assert np.array_equal(natural_frequencies(chapter_3(), spin=200.0), found.imag)


def test_given_coefficients_replace_the_nominal_ones() -> None:
    machine = chapter_3()
    coefficients = truth(machine)[0]
    assert np.array_equal(eigenvalues(machine, coefficients=coefficients), eigenvalues(machine))
    document = chapter_3_document()
    document["bearings"][0]["kxx"] *= 2
    changed = coefficients.copy()
    changed[0] *= 2
    found = eigenvalues(machine, coefficients=changed)[:8]
    assert found == pytest.approx(eigenvalues(parse_machine(document))[:8], rel=1e-9)
    assert np.abs(found / eigenvalues(machine)[:8] - 1).max() > 1e-3


def test_mirrored_train_has_the_same_modes_at_the_opposite_spin() -> None:
    other = parse_machine(mirrored(chapter_3_document()))
    found = eigenvalues(other, spin=-300.0)[:12]
    assert found == pytest.approx(eigenvalues(chapter_3(), spin=300.0)[:12], rel=1e-8)


def test_overdamped_modes_are_left_out() -> None:
    settings = {"diameter": 0.1, "density": 1.0, "kxx": 1e4, "cxx": 3000.0, "kyy": 1e4, "cyy": 10.0}
    machine = parse_machine(one_disc_document(mass=5.0, **settings))
    found = eigenvalues(machine)
    # Along y 2 × 1e4 N/m carry 5 kg; along x the critical damping of 2 √(km) = 632 N s/m is far exceeded.
    near = [one for one in found if abs(abs(one) - math.sqrt(2e4 / 5.0)) < 5.0]
    assert len(near) == 1
    assert np.count_nonzero(np.abs(pencil(machine, 0.0)) > 0) == found.size


STIFFNESS, DAMPING, MASS = 2e5, 40.0, 5.0


def jeffcott() -> Machine:
    """A disc on a rigid shaft of no mass to speak of, 2e5 N/m and 40 N s/m in all; far above it the tilting of the disc."""
    return parse_machine(
        one_disc_document(
            length=0.2,
            diameter=0.2,
            density=1e-2,
            mass=MASS,
            diametral_inertia=1e-3,
            polar_inertia=0.0,
            kxx=STIFFNESS / 2,
            kyy=STIFFNESS / 2,
            cxx=DAMPING / 2,
            cyy=DAMPING / 2,
            element_length=0.1,
        )
    )


def test_jeffcott_rotor_has_the_closed_form_eigenvalue_twice() -> None:
    decay = DAMPING / (2 * MASS)
    expected = -decay + 1j * math.sqrt(STIFFNESS / MASS - decay**2)
    # The shaft weighs 6e-5 kg, which lowers √(k/m) by 6e-6.
    assert eigenvalues(jeffcott())[:2] == pytest.approx([expected, expected], rel=2e-5)


def test_jeffcott_rotor_has_its_critical_speed_twice() -> None:
    expected = math.sqrt(STIFFNESS / MASS - (DAMPING / (2 * MASS)) ** 2)
    assert critical_speeds(jeffcott(), highest=400.0) == pytest.approx([expected, expected], rel=2e-5)


@pytest.mark.parametrize("highest", [150.0, 300.0, 600.0])
@pytest.mark.parametrize("turned", [False, True], ids=["positive", "negative"])
def test_every_critical_speed_meets_the_synchronous_line_and_none_is_missed(highest: float, turned: bool) -> None:
    machine = parse_machine(mirrored(chapter_3_document())) if turned else chapter_3()
    found = critical_speeds(machine, highest=highest)
    assert np.all(np.diff(found) > 0)
    assert np.all((found > 0) & (found <= highest))
    for speed in found:
        curves = pencil(machine, machine.direction * speed).imag
        assert np.min(np.abs(curves - speed)) < 1e-4
    # Every curve starts above the line, and here each crosses it at most once.
    below = np.count_nonzero(pencil(machine, machine.direction * highest).imag < highest)
    assert found.size == below


def test_gyroscopic_moments_move_critical_speeds_but_not_by_much_here() -> None:
    found = critical_speeds(chapter_3(), highest=440.0)
    assert found.size == 8
    assert found == pytest.approx(PRINTED, rel=0.03)


def test_no_critical_speed_below_the_first() -> None:
    assert critical_speeds(chapter_3(), highest=100.0).size == 0
