"""Critical speeds against closed forms of a rigid rotor and against looking at every speed.

The rigid rotor's shaft has a mass of 6e-5 kg and bends by some 1e-5 of the bearings' deflection: 1e-4 is asked.
"""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.machine.document import Machine, parse_machine
from estimator.modes.critical_speed import critical_speed_table, synchronous_crossings, undamped_critical_speeds
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.system_matrices import system_matrices, system_matrices_over_speed
from tests.estimator.rigid_rotor import bounce, rigid_rotor, tilting_stiffness
from tests.estimator.trains import chapter_3, chapter_3_document, dense_elements, mirrored

DISC = {"diametral": 0.05, "polar": 0.03}
"""Thick: forward precession overtakes it."""
THIN = {"diametral": 0.05, "polar": 0.09}
"""Thin: gyroscopic moments raise the forward conical frequency faster than the speed."""


def test_thick_rigid_rotor_has_four_critical_speeds() -> None:
    expected = [
        bounce(),
        bounce(),
        math.sqrt(tilting_stiffness() / (0.05 + 0.03)),
        math.sqrt(tilting_stiffness() / (0.05 - 0.03)),
    ]
    found = critical_speed_table(rigid_rotor(**DISC), highest=1000.0)
    assert [one.speed for one in found] == pytest.approx(sorted(expected), rel=1e-4)
    by_speed = {round(one.speed): one for one in found}
    assert by_speed[round(expected[2])].whirl == pytest.approx(-1.0, abs=1e-6)
    assert by_speed[round(expected[3])].whirl == pytest.approx(1.0, abs=1e-6)


def test_thin_rigid_rotor_has_no_forward_conical_critical_speed() -> None:
    found = critical_speed_table(rigid_rotor(**THIN), highest=1000.0)
    backward = math.sqrt(tilting_stiffness() / (0.05 + 0.09))
    assert [one.speed for one in found] == pytest.approx(sorted([backward, bounce(), bounce()]), rel=1e-4)


def test_undamped_critical_speeds_are_those_of_the_rigid_rotor() -> None:
    found = undamped_critical_speeds(system_matrices(rigid_rotor(**DISC)), direction=1)
    conical = [math.sqrt(tilting_stiffness() / (0.05 + sign * 0.03)) for sign in (1, -1)]
    assert found[:4] == pytest.approx(sorted([bounce(), bounce(), *conical]), rel=1e-4)


def test_damped_rigid_rotor_has_its_closed_form() -> None:
    """Bounce: λ² m + 2cλ + 2k = 0, so that the critical speed is √(2k/m - (c/m)²), ζ = c / √(2km)."""
    damping = 100.0
    found = critical_speed_table(rigid_rotor(**DISC, damping=damping), highest=250.0)
    near = [one for one in found if abs(one.speed - bounce()) < 10]
    assert len(near) == 2
    for one in near:
        assert one.speed == pytest.approx(math.sqrt(bounce() ** 2 - (damping / 5.0) ** 2), rel=1e-4)
        assert one.damping_ratio == pytest.approx(damping / 5.0 / bounce(), rel=1e-3)
        assert one.log_decrement == pytest.approx(2 * math.pi * damping / 5.0 / one.speed, rel=1e-3)
        assert one.eigenvalue.imag == pytest.approx(one.speed, rel=1e-8)


def dense_crossings(machine: Machine, highest: float, steps: int, lowest: float = 0.0) -> np.ndarray:
    """Crossings by looking at the frequencies, in ascending order, at every one of many speeds, linear between them."""
    rotor = assemble_rotor(machine)
    stiffness, damping = dense_elements(machine)
    inverse = np.linalg.inv(rotor.mass)
    size = rotor.size
    speeds = np.linspace(lowest, highest, steps + 1)
    gaps = []
    for speed in speeds:
        resistance = damping + machine.direction * speed * rotor.gyroscopic
        upper = np.hstack([np.zeros((size, size)), np.eye(size)])
        state = np.vstack([upper, np.hstack([-inverse @ (rotor.stiffness + stiffness), -inverse @ resistance])])
        gaps.append(np.sort(np.abs(np.linalg.eigvals(state).imag))[::2] - speed)
    above = np.array(gaps)
    at, mode = np.nonzero(above[:-1] * above[1:] < 0)
    part = above[at, mode] / (above[at, mode] - above[at + 1, mode])
    return np.sort(speeds[at] + part * (speeds[1] - speeds[0]))


@pytest.mark.parametrize("turned", [False, True], ids=["positive", "negative"])
def test_all_crossings_of_a_damped_train_are_found(turned: bool) -> None:
    machine = parse_machine(mirrored(chapter_3_document())) if turned else chapter_3()
    found = synchronous_crossings(system_matrices_over_speed(machine), direction=machine.direction, highest=600.0)
    assert np.array([one.speed for one in found]) == pytest.approx(dense_crossings(machine, 600.0, 300), abs=1e-2)


def test_a_mode_that_dips_below_the_line_and_comes_back_is_found() -> None:
    """A train far from any real one, drawn until that happened: near 158 rad/s, within 2 rad/s."""
    rng = np.random.default_rng(28)
    document = chapter_3_document()
    for part in (*document["bearings"], *document["couplings"]):
        for name in list(part):
            if name.startswith(("k", "c")) and isinstance(part[name], float):
                part[name] *= float(np.exp(rng.normal(0, 1.2))) * (rng.choice([-1, 1]) if name[1:3] in ("xy", "yx") else 1)
    for disc in document["discs"]:
        disc["polar_inertia"] *= 3 * float(np.exp(rng.normal(0.5, 1)))
        disc["diametral_inertia"] *= 3 * float(np.exp(rng.normal(0, 1)))
    machine = parse_machine(document)
    seen = dense_crossings(machine, 170.0, 100, lowest=140.0)
    assert len(seen) == 2
    found = synchronous_crossings(system_matrices_over_speed(machine), direction=1, highest=700.0)
    assert [one.speed for one in found if 140.0 < one.speed < 170.0] == pytest.approx(seen, abs=0.02)


def test_without_damping_one_problem_gives_all_of_them() -> None:
    full = system_matrices(chapter_3())
    # Symmetric, so that without damping every mode is neutral and the closed problem has real answers only.
    symmetric = (full.stiffness + full.stiffness.T) / 2
    matrices = replace(full, damping=np.zeros_like(full.damping), stiffness=symmetric)
    closed = undamped_critical_speeds(matrices, direction=1)
    found = [one.speed for one in synchronous_crossings(lambda _: matrices, direction=1, highest=2000.0)]
    assert found == pytest.approx(closed[closed < 2000.0], rel=1e-7)
    assert len(found) > 8


def test_each_undamped_critical_speed_makes_the_dynamic_stiffness_singular() -> None:
    matrices = system_matrices(rigid_rotor(**DISC))
    undamped = replace(matrices, damping=np.zeros_like(matrices.damping))
    for speed in undamped_critical_speeds(undamped, direction=1)[:4]:
        values = np.linalg.svd(undamped.dynamic_stiffness(1j * speed, spin=speed), compute_uv=False)
        near = np.linalg.svd(undamped.dynamic_stiffness(1.05j * speed, spin=1.05 * speed), compute_uv=False)
        assert values[-1] < 1e-5 * near[-1]


def test_the_highest_speed_must_be_positive() -> None:
    with pytest.raises(ValueError, match="highest speed must be positive"):
        critical_speed_table(chapter_3(), highest=0.0)
