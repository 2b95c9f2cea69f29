"""Trains on tilting pads: orientation, derivatives of equilibria, modes with the pads' own states, and what is refused."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from estimator.machine.document import DocumentError, parse_machine
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.modal_reduction import EVERYTHING, reduced_basis
from estimator.rotor.parameters import unknowns
from estimator.rotor.shaft_element import NODE_DOFS
from estimator.rotor.system_matrices import system_matrices
from estimator.statics.equilibrium import film_train
from estimator.statics.film_stability import least_damped_whirl
from estimator.statics.films_over_speed import equilibria_near
from estimator.statics.pad_states import state_matrix_with_pads
from estimator.units import rpm_to_rad_per_s
from tests.estimator.statics.films import PADS, between_two_bearings, motor_compressor_document, on_tilting_pads
from tests.estimator.statics.test_film_sensitivity import check_derivatives

SPEED = rpm_to_rad_per_s(3000.0)
FIVE: dict[str, Any] = {"profile": "tilting_pad", "preload": 0.3, "pads": PADS}


@pytest.mark.parametrize(
    ("load", "turned", "expected"), [("on_pad", 0.0, -90.0), ("between_pads", 0.0, -54.0), ("on_pad", 36.0, -54.0)]
)
def test_pivots_lie_where_the_document_says(load: str, turned: float, expected: float) -> None:
    machine = between_two_bearings(**FIVE | {"pads": PADS | {"load": load}, "turned_deg": turned})
    found = film_train(machine).equilibrium(SPEED)
    assert found is not None
    assert found.film[0].pads is not None
    x, y = found.film[0].pads.axis[0]
    assert np.degrees(np.arctan2(y, x)) == pytest.approx(expected)


def test_the_load_between_four_pads_moves_the_journal_straight_down() -> None:
    pads = {"number": 4, "arc_deg": 80.0, "load": "between_pads"}
    found = film_train(between_two_bearings(profile="tilting_pad", pads=pads)).equilibrium(SPEED)
    assert found is not None
    assert abs(found.position[0, 0]) < 1e-9 * abs(found.position[0, 1])
    (kxx, kxy), (kyx, kyy) = found.stiffness[0]
    assert kxx == pytest.approx(kyy, rel=1e-6)
    assert abs(kxy) + abs(kyx) < 1e-6 * kxx


def test_a_journal_that_turns_the_other_way_rests_in_the_mirror_image() -> None:
    machine, mirrored = (between_two_bearings(**FIVE | {"turned_deg": turned}) for turned in (10.0, -10.0))
    here = film_train(machine).equilibrium(SPEED)
    negative = mirrored.model_copy(update={"rotation": "negative"})
    there = film_train(negative).equilibrium(SPEED)
    assert here is not None
    assert there is not None
    assert abs(here.position[0, 0]) > 1e-9
    assert there.position == pytest.approx(here.position * [-1.0, 1.0], rel=1e-9)
    assert there.stiffness == pytest.approx(here.stiffness * [[1.0, -1.0], [-1.0, 1.0]], rel=1e-6)
    roots = [np.linalg.eigvals(state_matrix_with_pads(*one, EVERYTHING)) for one in ((machine, here), (negative, there))]
    slow, other = (np.sort(one[np.abs(one) < 10.0 * SPEED].real) for one in roots)
    assert slow.size > 10
    assert other == pytest.approx(slow, rel=1e-6)


def test_derivatives_of_equilibria_are_those_of_differences() -> None:
    check_derivatives(film_train(parse_machine(on_tilting_pads(motor_compressor_document("flexible")))), SPEED)


def test_equilibria_at_many_speeds_at_once_are_those_one_by_one() -> None:
    train = film_train(parse_machine(on_tilting_pads(motor_compressor_document("flexible"))))
    speeds = np.array([rpm_to_rad_per_s(one) for one in (1500.0, 3000.0, 4500.0)])
    single = [train.equilibrium(float(one)) for one in speeds]
    start = np.stack([one.position * 1.02 for one in single if one is not None])
    found = equilibria_near(train, speeds, start)
    assert found is not None
    for one, other in zip(found, single, strict=True):
        assert other is not None
        assert one.position == pytest.approx(other.position, rel=1e-6, abs=1e-12)
        assert one.film[0].static_stiffness == pytest.approx(other.film[0].static_stiffness, rel=1e-5, abs=1.0)


def test_modes_with_the_pads_states_are_exact_at_their_own_frequency() -> None:
    """With the pads reduced at the mode's own eigenvalue, the dynamic stiffness of the train is singular."""
    machine = parse_machine(on_tilting_pads(motor_compressor_document("flexible"), preload=0.1))
    found = film_train(machine).equilibrium(SPEED)
    assert found is not None
    roots = np.linalg.eigvals(state_matrix_with_pads(machine, found, EVERYTHING))
    slow = roots[(roots.imag > 1.0) & (roots.imag < 2.0 * SPEED)]
    listed = unknowns(machine, assemble_rotor(machine)).coefficients
    values = np.array([0.0 if one.element.startswith("bearing.") else one.expected for one in listed])
    matrices, rotor = system_matrices(machine, coefficients=values), assemble_rotor(machine)
    for root in slow:
        whole = matrices.dynamic_stiffness(root, spin=SPEED)
        for bearing, film in zip(machine.bearings, found.film, strict=True):
            assert film.pads is not None
            first = NODE_DOFS * rotor.node(bearing.shaft, bearing.station)
            whole[first : first + 2, first : first + 2] += film.pads.reduced(root)
        scaled = whole / np.sqrt(np.outer(np.abs(np.diag(whole)), np.abs(np.diag(whole))))
        assert np.linalg.svd(scaled, compute_uv=False)[-1] < 1e-7
    assert slow.size >= 3


def test_the_reduced_mesh_has_the_same_least_damped_mode() -> None:
    machine = parse_machine(on_tilting_pads(motor_compressor_document("flexible"), preload=0.1))
    found = film_train(machine).equilibrium(SPEED)
    assert found is not None
    whole, small = (
        np.linalg.eigvals(state_matrix_with_pads(machine, found, basis))
        for basis in (EVERYTHING, reduced_basis(machine, 2 * SPEED))
    )
    mode = least_damped_whirl(machine, found)
    assert mode is not None
    nearest = small[
        np.argmin(np.abs(small.imag - mode.frequency) + np.abs(small.real + mode.log_decrement * mode.frequency / 2 / np.pi))
    ]
    assert nearest.imag == pytest.approx(mode.frequency, rel=1e-3)
    assert np.abs(whole - nearest).min() < 1e-3 * abs(nearest)


def test_tilting_pads_do_not_whirl_where_a_plain_bearing_does() -> None:
    plain = parse_machine(motor_compressor_document("flexible"))
    padded = parse_machine(on_tilting_pads(motor_compressor_document("flexible")))
    speed = rpm_to_rad_per_s(6000.0)
    decrements = []
    for machine in (plain, padded):
        found = film_train(machine).equilibrium(speed)
        assert found is not None
        mode = least_damped_whirl(machine, found)
        assert mode is not None
        decrements.append(mode.log_decrement)
    assert decrements[0] < 0.0 < decrements[1]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda film: film.pop("pads"), r"profile tilting_pad needs pads: \{number"),
        (lambda film: film.update(profile="plain", preload=0.0), "pads go with profile tilting_pad, not with plain"),
        (lambda film: film["pads"].update(arc_deg=80), "5 pads of 80° overlap"),
        (lambda film: film["pads"].update(pivot=0.3), "pivot.*0.4"),
        (lambda film: film["pads"].update(number=2), "number.*3"),
        (lambda film: film.update(preload=0.85), "preload 0.85 of tilting pads: it is 0 to 0.8"),
        (lambda film: film.update(preload=1.0), "preload.*less than 1"),
        (lambda film: film["pads"].update(load="below"), "on_pad"),
    ],
)
def test_wrong_pads_are_refused_at_the_door(change: Callable[[dict[str, Any]], object], message: str) -> None:
    said = between_two_bearings(**FIVE).model_dump(mode="json")
    change(said["bearings"][0]["film"])
    with pytest.raises(DocumentError, match=message):
        parse_machine(said)
