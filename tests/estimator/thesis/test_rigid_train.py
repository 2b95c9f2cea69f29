"""The rigid train of Chapter 2 against printed frequencies, a Lagrangian written out by hand, and physical principles."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.arrays import Complexes
from estimator.rotor.condensation import CondensedTrain
from estimator.rotor.response import response, sensitivity
from estimator.thesis.misalignment_force import misalignment_force
from estimator.thesis.rigid_train import (
    condensed,
    mass,
    names,
    natural_frequencies,
    printed_train,
    stiffness_and_damping,
    unbalances_of,
)

TRAIN = printed_train()
PRINTED_FREQUENCIES = [161, 209, 290, 353, 359, 652, 1170, 1558]


def at(speed: list[float], direction: float = 1.0) -> CondensedTrain:
    return condensed(TRAIN, speed=np.array(speed), direction=np.full(len(speed), direction))


def response_of(train: CondensedTrain) -> Complexes:
    return response(train, coefficients=TRAIN.coefficients, excitations=TRAIN.unbalances)


def value(name: str) -> float:
    return float(TRAIN.values[names().index(name)])


def test_natural_frequencies_are_the_printed_ones_within_0_9_percent() -> None:
    assert natural_frequencies(TRAIN) == pytest.approx(PRINTED_FREQUENCIES, rel=0.009)


def test_printed_shaft_inertia_misses_the_printed_frequencies_by_5_percent() -> None:
    found = natural_frequencies(replace(TRAIN, shaft_inertia=(0.0996, 0.0996)))
    assert found == pytest.approx([160, 207, 288, 345, 348, 621, 1113, 1483], rel=0.003)
    assert np.max(np.abs(found / PRINTED_FREQUENCIES - 1)) > 0.045


def test_discs_counted_twice_miss_the_printed_frequencies_by_30_percent() -> None:
    """Eq. 2.2 as printed: I_1 with the discs' m l̄², l̄ = 0.25 m."""
    inertia = (0.0498 + (5 + 3) * 0.0625, 0.0498 + (2 + 6) * 0.0625)
    found = natural_frequencies(replace(TRAIN, shaft_inertia=inertia))
    assert 0.25 < np.max(np.abs(found / PRINTED_FREQUENCIES - 1)) < 0.35


def test_names_are_those_of_table_2_1() -> None:
    found = names()
    assert len(found) == len(set(found)) == 50
    assert found[:2] == ("bearing.B1.kxx", "bearing.B1.kxy")
    assert found[16:22] == tuple(f"coupling.C.{name}" for name in ("kxx", "kxy", "kyx", "kyy", "k_phix", "k_phiy"))
    assert found[22] == "bearing.B1.cxx"
    assert found[38:42] == tuple(f"coupling.C.{name}" for name in ("cxx", "cxy", "cyx", "cyy"))
    assert found[42:44] == ("disc.D1.unbalance.real", "disc.D1.unbalance.imaginary")


def test_assumed_values_are_those_of_tables_2_4_to_2_6() -> None:
    assert value("bearing.B2.kyx") == 1.39e5
    assert value("bearing.B4.kyy") == 2.56e5
    assert value("bearing.B3.cxy") == 75.0
    assert value("coupling.C.k_phiy") == 2.2e5
    assert value("coupling.C.cyy") == 295.0
    assert value("disc.D1.unbalance.real") == pytest.approx(9.5e-3 * np.cos(np.deg2rad(36)))
    assert value("disc.D3.unbalance.imaginary") == pytest.approx(7.9e-3 * np.sin(np.deg2rad(240)))


def test_mass_matrix_is_that_of_the_printed_formulas() -> None:
    """M_11, M_12, M_22, M_33, M_34, M_44 below Eq. 2.9, with I without the discs' m l̄²."""
    m, s = (5.0, 3.0, 2.0, 6.0), 0.765
    first, second = 2.48e-5 + 1.40e-5 + 0.0498, 1.01e-5 + 1.88e-5 + 0.0498
    found = mass(TRAIN)
    expected = np.zeros((4, 4))
    expected[0, 0] = (9 * m[0] + m[1] + 4 * s + 16 * first) / 16
    expected[1, 1] = (m[0] + 9 * m[1] + 4 * s + 16 * first) / 16
    expected[0, 1] = expected[1, 0] = (3 * m[0] + 3 * m[1] + 4 * s - 16 * first) / 16
    expected[2, 2] = (9 * m[2] + m[3] + 4 * s + 16 * second) / 16
    expected[3, 3] = (m[2] + 9 * m[3] + 4 * s + 16 * second) / 16
    expected[2, 3] = expected[3, 2] = (3 * m[2] + 3 * m[3] + 4 * s - 16 * second) / 16
    assert found[:4, :4] == pytest.approx(expected)
    assert found[4:, 4:] == pytest.approx(expected)
    assert not found[:4, 4:].any()


def test_kinetic_energy_of_any_motion() -> None:
    """½ q̇ᵀ M q̇ against the discs, shafts and tilts of Eq. 2.1-2.2, one by one."""
    rng = np.random.default_rng(0)
    span = (0.8, 1.3)
    train = replace(TRAIN, span=span)
    for _ in range(5):
        q = rng.standard_normal(8)
        energy = 0.0
        for plane in (q[:4], q[4:]):
            for shaft in (0, 1):
                near, far = plane[2 * shaft], plane[2 * shaft + 1]
                energy += 0.5 * TRAIN.disc_mass[2 * shaft] * (0.75 * near + 0.25 * far) ** 2
                energy += 0.5 * TRAIN.disc_mass[2 * shaft + 1] * (0.25 * near + 0.75 * far) ** 2
                energy += 0.5 * TRAIN.shaft_mass[shaft] * (0.5 * (near + far)) ** 2
                inertia = TRAIN.shaft_inertia[shaft] + sum(TRAIN.disc_inertia[2 * shaft : 2 * shaft + 2])
                energy += 0.5 * inertia * ((near - far) / span[shaft]) ** 2
        assert 0.5 * q @ mass(train) @ q == pytest.approx(energy, rel=1e-12)


def test_virtual_work_of_springs_and_dampers() -> None:
    """δηᵀ K η of Eq. 2.4 and δηᵀ C η̇ of Eq. 2.5, written out with the displacements of Eq. 2.1."""
    rng = np.random.default_rng(1)
    span = (0.8, 1.3)
    stiffness, damping = stiffness_and_damping(replace(TRAIN, span=span))

    def across(plane: np.ndarray) -> tuple[float, float]:
        gap = (-0.25 * plane[0] + 1.25 * plane[1]) - (1.25 * plane[2] - 0.25 * plane[3])
        return gap, (plane[0] - plane[1]) / span[0] - (plane[3] - plane[2]) / span[1]

    for matrix, letter in ((stiffness, "k"), (damping, "c")):
        q, virtual = rng.standard_normal(8), rng.standard_normal(8)
        work = 0.0
        for bearing in range(4):
            here, there = (q[bearing], q[4 + bearing]), (virtual[bearing], virtual[4 + bearing])
            for i, a in enumerate("xy"):
                for j, b in enumerate("xy"):
                    work += value(f"bearing.B{bearing + 1}.{letter}{a}{b}") * here[j] * there[i]
        gap, gap_virtual = ([across(v[:4])[0], across(v[4:])[0]] for v in (q, virtual))
        for i, a in enumerate("xy"):
            for j, b in enumerate("xy"):
                work += value(f"coupling.C.{letter}{a}{b}") * gap[j] * gap_virtual[i]
        if letter == "k":
            work += value("coupling.C.k_phix") * across(q[:4])[1] * across(virtual[:4])[1]
            work += value("coupling.C.k_phiy") * across(q[4:])[1] * across(virtual[4:])[1]
        assert virtual @ matrix @ q == pytest.approx(work, rel=1e-12)


def test_symmetric_coefficients_give_a_symmetric_positive_energy() -> None:
    coefficients = TRAIN.coefficients.copy()
    for first in (*range(0, 20, 4), *range(22, 42, 4)):
        coefficients[first + 1] = coefficients[first + 2] = coefficients[first + 1 : first + 3].mean()
    for matrix in stiffness_and_damping(replace(TRAIN, coefficients=coefficients)):
        assert matrix == pytest.approx(matrix.T)
        assert np.linalg.eigvalsh(matrix).min() > 0


def test_response_solves_the_equations_of_motion() -> None:
    """Eq. 2.10 with a force vector written out by hand."""
    omega = 185.0
    stiffness, damping = stiffness_and_damping(TRAIN)
    u = TRAIN.unbalances
    in_x = omega**2 * np.array(
        [0.75 * u[0] + 0.25 * u[1], 0.25 * u[0] + 0.75 * u[1], 0.75 * u[2] + 0.25 * u[3], 0.25 * u[2] + 0.75 * u[3]]
    )
    expected = np.linalg.solve(stiffness + 1j * omega * damping - omega**2 * mass(TRAIN), np.concatenate([in_x, -1j * in_x]))
    assert response_of(at([omega]))[0] == pytest.approx(expected, rel=1e-11)


def test_rotation_against_is_the_thesis_s_negative_speed() -> None:
    """Eq. 2.17 puts -ω into Eq. 2.10: the conjugate of the response that the mirrored unbalance gives."""
    omega = 240.0
    stiffness, damping = stiffness_and_damping(TRAIN)
    weights = np.array([[0.75, 0.25, 0, 0], [0.25, 0.75, 0, 0], [0, 0, 0.75, 0.25], [0, 0, 0.25, 0.75]])
    in_x = omega**2 * weights @ TRAIN.unbalances
    force = np.concatenate([in_x, -1j * in_x])
    negative = np.linalg.solve(stiffness - 1j * omega * damping - omega**2 * mass(TRAIN), force)
    assert response_of(at([omega], -1.0))[0] == pytest.approx(negative.conj(), rel=1e-11)


def test_free_rotors_turn_about_their_balanced_axis() -> None:
    """Far above all frequencies each rotor moves as if free: M q = -F/ω²."""
    omega = 1e9
    train = at([omega])
    force = train.force[0] @ TRAIN.values[42:]
    assert response_of(train)[0] == pytest.approx(-np.linalg.solve(mass(TRAIN), force) / omega**2, rel=1e-5)


def test_energy_that_damping_takes_is_what_the_unbalance_feeds() -> None:
    """Per radian: Im(q* f) = ω q* C_sym q + the circulation of the cross-coupled stiffness."""
    omega = 209.0
    train = at([omega])
    q = response_of(train)[0]
    force = train.force[0] @ TRAIN.values[42:]
    stiffness, damping = stiffness_and_damping(TRAIN)
    taken = np.imag(q.conj() @ (stiffness + 1j * omega * damping) @ q)
    assert np.imag(q.conj() @ force) == pytest.approx(taken, rel=1e-10)


def test_sensitivity_against_central_differences() -> None:
    train = at([150.0, 480.0])
    slope = sensitivity(train, coefficients=TRAIN.coefficients, excitations=TRAIN.unbalances).by_parameter
    for k in (0, 17, 20, 25, 40):
        shifted = []
        for sign in (1, -1):
            coefficients = TRAIN.coefficients.copy()
            coefficients[k] *= 1 + sign * 1e-5
            shifted.append(response(train, coefficients=coefficients, excitations=TRAIN.unbalances))
        expected = (shifted[0] - shifted[1]) / (2e-5 * TRAIN.coefficients[k])
        assert np.abs(slope[..., k] - expected).max() < 1e-6 * np.abs(expected).max()


def test_misalignment_force_is_that_of_eq_2_12() -> None:
    speed = [100.0, 700.0]
    train = at(speed)
    q = response_of(train)
    found = misalignment_force(train, coefficients=TRAIN.coefficients, displacement=q)
    gap_x = -0.25 * q[:, 0] + 1.25 * q[:, 1] - 1.25 * q[:, 2] + 0.25 * q[:, 3]
    gap_y = -0.25 * q[:, 4] + 1.25 * q[:, 5] - 1.25 * q[:, 6] + 0.25 * q[:, 7]
    rate = 1j * np.array(speed)
    expected = np.stack(
        [
            2.12e5 * gap_x + 1.11e5 * gap_y + rate * (225 * gap_x + 20 * gap_y),
            1.31e5 * gap_x + 1.99e5 * gap_y + rate * (50 * gap_x + 295 * gap_y),
            2.5e5 * (q[:, 0] - q[:, 1] + q[:, 2] - q[:, 3]),
            2.2e5 * (q[:, 4] - q[:, 5] + q[:, 6] - q[:, 7]),
        ],
        axis=1,
    )
    assert found == pytest.approx(expected, rel=1e-10)


def test_coupling_force_balances_inertia_and_bearings_of_one_rotor() -> None:
    """Newton on rotor 1 alone, in x and y: what the coupling takes is what bearings, inertia and unbalance leave."""
    omega = 330.0
    train = at([omega])
    q = response_of(train)
    force = misalignment_force(train, coefficients=TRAIN.coefficients, displacement=q)[0]
    q, fed = q[0], train.force[0] @ TRAIN.values[42:]
    for plane, axis in ((0, "x"), (1, "y")):
        rows = slice(4 * plane, 4 * plane + 2)
        bearings = sum(
            (value(f"bearing.B{b + 1}.k{axis}{other}") + 1j * omega * value(f"bearing.B{b + 1}.c{axis}{other}")) * q[4 * j + b]
            for b in (0, 1)
            for j, other in enumerate("xy")
        )
        left_over = fed[rows].sum() + omega**2 * (mass(TRAIN)[rows] @ q).sum() - bearings
        # The weights of x_c1 add up to one and those of a tilt to nothing, so that only the force remains.
        assert left_over == pytest.approx(force[plane], rel=1e-9)


def test_unbalances_of_magnitude_and_angle() -> None:
    assert unbalances_of((2.0, 3.0), (90.0, 180.0)) == pytest.approx([2j, -3])
