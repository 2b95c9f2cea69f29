"""A reduced train against its whole mesh: the same modes, shapes and critical speeds; small meshes are left alone."""

import numpy as np
import pytest
from msgspec import structs

from benchmarks.estimator.large_trains import off
from estimator.machine.document import Machine, parse_machine
from estimator.modes.campbell import campbell
from estimator.modes.critical_speed import critical_speed_table, synchronous_crossings, undamped_critical_speeds
from estimator.modes.eigenmodes import Modes, modes
from estimator.modes.mode_shapes import mode_shapes
from estimator.modes.nominal_critical_speeds import nominal_critical_speeds
from estimator.modes.snapshot_reduction import projected_matrices, snapshot_basis
from estimator.rotor import modal_reduction
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.modal_reduction import EVERYTHING, modal_basis
from estimator.rotor.system_matrices import system_matrices, system_matrices_over_speed
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model import critical_speed_tracking
from estimator.updated_model.critical_speed_tracking import followed_crossings
from estimator.updated_model.modal_uncertainty import crossing_slopes, modes_at
from estimator.updated_model.model import UpdatedModel, expected_model
from tests.estimator.long_trains import TRAINS, overhung, plain
from tests.estimator.trains import Floats, chapter_3

SAME = 1e-6
"""Relative difference of eigenvalues that the reduction may make."""


@pytest.fixture(scope="module", params=TRAINS)
def machine(request: pytest.FixtureRequest) -> Machine:
    return parse_machine(TRAINS[request.param]())


def highest_of(machine: Machine) -> float:
    return 2.5 * rpm_to_rad_per_s(machine.speed_range.maximum_rpm)


def felt(found: Modes, highest: float) -> list[int]:
    """Modes up to a frequency [rad/s] that are not overdamped."""
    return np.flatnonzero((found.eigenvalue.imag < highest) & (found.damping_ratio < 0.9)).tolist()


def expected_at(machine: Machine, speed: float) -> Floats:
    return expected_model(machine).coefficients(speed)


@pytest.mark.parametrize("part", [0.0, 0.5, 1.25])
def test_modes_are_those_of_the_whole_mesh(machine: Machine, part: float) -> None:
    highest, speed = highest_of(machine), part * rpm_to_rad_per_s(machine.speed_range.maximum_rpm)
    basis, coefficients = modal_basis(machine, highest), expected_at(machine, speed)
    whole = system_matrices(machine, coefficients=coefficients)
    reduced = system_matrices(machine, coefficients=coefficients, basis=basis)
    assert reduced.mass.shape[0] < whole.mass.shape[0] / 2
    expected, found = modes(whole, spin=speed), modes(reduced, spin=speed)
    assert len(felt(found, highest)) == len(felt(expected, highest)) > 8
    for mode in felt(expected, highest):
        root = expected.eigenvalue[mode]
        nearest = int(np.argmin(np.abs(found.eigenvalue - root)))
        assert abs(found.eigenvalue[nearest] - root) < SAME * abs(root)
        one, other = expected.shape[:, mode], basis.expanded(found.shape[:, [nearest]])[:, 0]
        alike = abs(np.vdot(one, whole.mass @ other)) ** 2 / np.vdot(other, whole.mass @ other).real
        assert alike == pytest.approx(1.0, abs=1e-6)


def test_undamped_critical_speeds_are_those_of_the_whole_mesh(machine: Machine) -> None:
    highest = rpm_to_rad_per_s(machine.speed_range.maximum_rpm)
    at = system_matrices_over_speed(machine)(highest / 2)
    expected = undamped_critical_speeds(at, direction=machine.direction)
    found = nominal_critical_speeds(machine)
    assert found.size > 2
    assert found == pytest.approx(expected[expected <= highest], rel=SAME)


def test_the_table_is_that_of_the_whole_mesh(machine: Machine) -> None:
    model = expected_model(machine)
    highest = rpm_to_rad_per_s(machine.speed_range.maximum_rpm)
    found = critical_speed_table(machine, highest=highest, coefficients=model.coefficients)
    whole = system_matrices_over_speed(machine, coefficients=model.coefficients)
    assert len(found) > 3
    for one in found:
        crowd = modes(whole(one.speed), spin=one.speed)
        nearest = crowd.eigenvalue[np.argmin(np.abs(crowd.eigenvalue - one.eigenvalue))]
        assert abs(nearest - one.eigenvalue) < SAME * abs(nearest)


@pytest.mark.long
def test_a_large_train_is_searched_for_the_crossings_that_a_small_one_has(machine: Machine) -> None:
    highest = rpm_to_rad_per_s(machine.speed_range.maximum_rpm)
    model = expected_model(machine)
    basis = modal_basis(machine, highest)
    matrices = system_matrices_over_speed(machine, coefficients=model.coefficients, basis=basis)
    expected = [one for one in synchronous_crossings(matrices, direction=1, highest=highest) if one.damping_ratio < 0.9]
    found = critical_speed_table(machine, highest=highest, coefficients=model.coefficients)
    assert [one.speed for one in found] == pytest.approx([one.speed for one in expected], rel=1e-8)
    assert [one.damping_ratio for one in found] == pytest.approx([one.damping_ratio for one in expected], abs=1e-8)
    assert [one.whirl for one in found] == pytest.approx([one.whirl for one in expected], abs=1e-5)


def test_between_the_speeds_of_the_snapshots_modes_are_right_as_well(machine: Machine) -> None:
    highest, fastest = highest_of(machine), rpm_to_rad_per_s(machine.speed_range.maximum_rpm)
    model = expected_model(machine)
    basis = snapshot_basis(model.matrices, direction=1, fastest=fastest, highest=highest)
    narrow = projected_matrices(model.matrices, basis)
    for speed in (0.2 * fastest, 0.77 * fastest):
        expected, found = modes(model.matrices(speed), spin=speed), modes(narrow(speed), spin=speed)
        for mode in felt(expected, highest):
            root = expected.eigenvalue[mode]
            assert np.min(np.abs(found.eigenvalue - root)) < SAME * abs(root)


def test_campbell_curves_are_those_of_the_modes() -> None:
    machine = parse_machine(overhung())
    highest, fastest = highest_of(machine), rpm_to_rad_per_s(machine.speed_range.maximum_rpm)
    diagram = campbell(machine, speed=np.linspace(0.0, fastest, 6), highest_frequency=highest)
    for step, speed in enumerate(diagram.speed.tolist()):
        expected = modes(system_matrices(machine), spin=speed)
        curves = diagram.eigenvalue[step][~np.isnan(diagram.eigenvalue[step])]
        for mode in felt(expected, highest):
            root = expected.eigenvalue[mode]
            assert np.min(np.abs(curves - root)) < SAME * abs(root)
    table = critical_speed_table(machine, highest=fastest)
    assert [one.speed for one in diagram.critical_speeds] == pytest.approx([one.speed for one in table], rel=SAME)


def test_mode_shapes_are_reported_at_every_node() -> None:
    machine = parse_machine(overhung())
    speed = rpm_to_rad_per_s(3000.0)
    found = mode_shapes(machine, spin=speed, highest_frequency=2 * speed)
    expected = modes(system_matrices(machine), spin=speed)
    stations = assemble_rotor(machine).stations
    assert len(found) > 4
    for one in found:
        mode = int(np.argmin(np.abs(expected.eigenvalue - one.eigenvalue)))
        largest = 0.0
        for shaft in one.shafts:
            assert shaft.station.tolist() == stations[shaft.shaft].tolist()
            largest = max(largest, float(np.max(shaft.orbit.semi_major)))
        assert largest == pytest.approx(1.0)
        whole = np.concatenate([np.stack([s.x, s.y, s.theta_x, s.theta_y], axis=1).reshape(-1) for s in one.shafts])
        factor = np.vdot(expected.shape[:, mode], whole) / np.vdot(expected.shape[:, mode], expected.shape[:, mode])
        assert whole == pytest.approx(factor * expected.shape[:, mode], abs=1e-3)


def near(document: dict[str, object]) -> UpdatedModel:
    """The model of a document that is off by up to 10 %, as if identified: with uncertainty, at the true values."""
    machine = parse_machine(off(document, seed=1))
    true, start = expected_model(parse_machine(document)), expected_model(machine)
    size = start.values.size
    return structs.replace(start, values=true.values, covariance=1e-4 * np.eye(size))


def test_followed_critical_speeds_and_their_slopes_are_those_of_the_whole_mesh(monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as patch:
        patch.setattr(modal_reduction, "SMALL", 10**6)
        critical_speed_tracking._nominal.cache_clear()
        expected = followed_crossings(near(plain()))
        slopes = crossing_slopes(near(plain()), expected.modes)
    critical_speed_tracking._nominal.cache_clear()
    model = near(plain())
    assert model.basis is not EVERYTHING
    found = followed_crossings(model)
    assert found.number.tolist() == expected.number.tolist()
    assert found.modes.eigenvalue == pytest.approx(expected.modes.eigenvalue, rel=SAME)
    assert found.pairs == expected.pairs
    size = np.max(np.abs(slopes), axis=1, keepdims=True)
    assert np.max(np.abs(crossing_slopes(model, found.modes) - slopes) / size) < 1e-3


def test_the_same_machine_has_the_same_coordinates_at_all_values() -> None:
    model = near(plain())
    assert structs.replace(model, values=1.1 * model.values).basis is model.basis
    assert modes_at(model, speed=100.0).shape.shape[0] == model.matrices(100.0).mass.shape[0]


def test_a_small_mesh_is_left_as_it_is() -> None:
    machine = chapter_3()
    assert modal_basis(machine, 500.0) is EVERYTHING
    assert expected_model(machine).matrices(1.0).mass.shape[0] == assemble_rotor(machine).size
    vectors = np.ones((assemble_rotor(machine).size, 2))
    for same in (EVERYTHING.project, EVERYTHING.expanded, EVERYTHING.coordinates):
        assert same(vectors) is vectors
    assert EVERYTHING.reduced(assemble_rotor(machine)) is assemble_rotor(machine)


def test_coordinates_undo_the_expansion() -> None:
    basis = modal_basis(parse_machine(plain()), 500.0)
    assert basis.plane is not None
    there = np.random.default_rng(0).standard_normal((2 * basis.plane.shape[1], 3))
    assert basis.coordinates(basis.expanded(there)) == pytest.approx(there, rel=1e-6, abs=1e-8)


def test_a_speed_that_no_machine_has_takes_no_more_modes_than_are_sensible() -> None:
    basis = modal_basis(parse_machine(plain()), 1e9)
    assert basis.plane is None or basis.plane.shape[1] < modal_reduction.MAXIMUM_MODES + 200
