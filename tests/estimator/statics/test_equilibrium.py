"""Trains at rest on their films: the reference arrays, a closed form, and what no rigid motion may change."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.machine.document import DocumentError, Machine, parse_machine
from estimator.statics.equilibrium import FilmTrain, film_train
from estimator.statics.film_coefficients import film_coefficients
from estimator.statics.film_stability import least_damped_whirl, whirl_onset
from estimator.statics.train_statics import MissingFilm
from estimator.units import GRAVITY, rpm_to_rad_per_s
from tests.estimator.statics.films import between_two_bearings, motor_compressor_document
from tests.estimator.trains import few_examples
from tests.film_plant.motor_compressor import CASES, CouplingKind
from tests.paths import DATA

KINDS: tuple[CouplingKind, ...] = ("flexible", "rigid")
SPEED = rpm_to_rad_per_s(3000.0)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("kind", KINDS)
def test_loads_positions_and_coefficients_are_those_of_the_reference_arrays(kind: CouplingKind, case: str) -> None:
    """Asked: 2 % of the load, of the clearance and of a matrix's largest term. The arrays come from another program."""
    machine = parse_machine(motor_compressor_document(kind, case))
    train = film_train(machine)
    clearance = np.array([one.clearance for one in train.bearings])
    with np.load(DATA / "motor-compressor" / "arrays.npz") as arrays:
        speed = arrays["speed"][::3]
        named = {what: arrays[f"{kind}.{case}.{what}"][::3] for what in ("load", "journal_position", "stiffness", "damping")}
    for place, found in enumerate(train.follow(speed)):
        assert found is not None
        load = named["load"][place]
        assert np.all(np.abs(found.force - load) <= 0.02 * np.linalg.norm(load, axis=1)[:, None])
        assert np.all(np.abs(found.position - named["journal_position"][place]) <= 0.02 * clearance[:, None])
        for what, own in (("stiffness", found.stiffness), ("damping", found.damping)):
            true = named[what][place]
            assert np.all(np.abs(own - true) <= 0.02 * np.abs(true).max(axis=(1, 2))[:, None, None])


def test_two_equal_bearings_carry_half_of_the_weight_each() -> None:
    machine = between_two_bearings()
    found = film_train(machine).equilibrium(SPEED)
    assert found is not None
    weight = 200.0 + np.pi / 4 * 0.1**2 * 1.0
    assert found.force[:, 1] == pytest.approx(weight * GRAVITY / 2, rel=1e-6)
    assert np.abs(found.force[:, 0]).max() < 1e-6 * weight
    assert found.position[0] == pytest.approx(found.position[1], rel=1e-6)


@few_examples
@given(st.floats(-1e-3, 1e-3), st.floats(-1e-3, 1e-3), st.floats(-1e-3, 1e-3))
def test_a_rigid_motion_of_all_bearings_changes_no_load(right: float, up: float, tilt: float) -> None:
    """The bearings of the whole train, moved and tilted together, keep their loads: B2's share of the tilt is 0.8 m away."""
    plain = film_train(between_two_bearings())
    moved = np.array([[right, up], [right, up + 0.8 * tilt]])
    other = FilmTrain(plain.statics, plain.bearings, plain.elevation + moved)
    first, second = plain.equilibrium(SPEED), other.equilibrium(SPEED)
    assert first is not None
    assert second is not None
    assert second.force == pytest.approx(first.force, abs=1e-3)


@pytest.mark.long
def test_a_journal_that_turns_the_other_way_rests_in_the_mirror_image() -> None:
    machine = between_two_bearings(profile="elliptical", preload=0.4, turned_deg=15.0)
    mirrored = between_two_bearings(profile="elliptical", preload=0.4, turned_deg=-15.0)
    here = film_train(machine).equilibrium(SPEED)
    there = film_train(mirrored.model_copy(update={"rotation": "negative"})).equilibrium(SPEED)
    assert here is not None
    assert there is not None
    assert there.position == pytest.approx(here.position * [-1.0, 1.0], rel=1e-9)
    assert there.stiffness == pytest.approx(here.stiffness * [[1.0, -1.0], [-1.0, 1.0]], rel=1e-6)


def test_a_lifted_journal_is_a_state_and_no_error() -> None:
    """A rigid coupling, and a motor's inner bearing 0.3 mm too low: its film pulls nothing, or pushes the shaft down."""
    said = motor_compressor_document("rigid")
    said["bearings"][1]["film"]["elevation_y"] -= 3e-4
    found = film_train(parse_machine(said)).equilibrium(SPEED)
    aligned = film_train(parse_machine(motor_compressor_document("rigid"))).equilibrium(SPEED)
    assert found is not None
    assert aligned is not None
    assert found.force[1, 1] < 0.0
    assert found.force[:, 1].sum() == pytest.approx(aligned.force[:, 1].sum(), rel=1e-6)


def test_a_static_load_is_carried_beside_the_weight() -> None:
    said = between_two_bearings().model_dump(mode="json")
    said["static_loads"] = [{"id": "gear", "shaft": "S", "station": 0.5, "force_x": 500.0, "force_y": -1000.0}]
    found = film_train(parse_machine(said)).equilibrium(SPEED)
    plain = film_train(between_two_bearings()).equilibrium(SPEED)
    assert found is not None
    assert plain is not None
    assert found.force - plain.force == pytest.approx(np.array([[-250.0, 500.0]] * 2), rel=1e-6)


def test_stability_is_that_of_the_eigenproblem_and_ends_at_the_onset() -> None:
    machine = parse_machine(motor_compressor_document("flexible"))
    train = film_train(machine)
    onset = whirl_onset(machine, train, first=rpm_to_rad_per_s(1000.0), last=rpm_to_rad_per_s(9000.0))
    assert onset is not None
    for factor, grows in ((0.98, False), (1.02, True)):
        found = train.equilibrium(factor * onset)
        assert found is not None
        mode = least_damped_whirl(machine, found)
        assert mode is not None
        assert (mode.log_decrement < 0.0) is grows
        assert 0.4 < mode.frequency / found.speed < 0.6


def test_film_coefficients_stand_where_the_bearings_terms_are() -> None:
    machine = between_two_bearings()
    found = film_train(machine).equilibrium(SPEED)
    assert found is not None
    values = film_coefficients(machine, found)
    assert values[:8] == pytest.approx([*found.stiffness[0].ravel(), *found.damping[0].ravel()])


def test_a_bearing_without_a_film_is_named() -> None:
    said = motor_compressor_document("flexible")
    del said["bearings"][2]["film"]
    with pytest.raises(MissingFilm, match="B3 have none"):
        film_train(parse_machine(said))


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"radial_clearance": 5e-3}, "more than a tenth of the radius"),
        ({"radial_clearance": -1e-5}, "greater than 0"),
        ({"oil": {"iso_vg": 46}}, "iso_vg needs either temperature_c"),
        ({"oil": {}}, "either viscosity"),
        ({"preload": 0.5}, "goes with a lobed profile"),
    ],
)
def test_wrong_films_are_refused_at_the_door(changed: dict[str, object], message: str) -> None:
    said = between_two_bearings().model_dump(mode="json")
    said["bearings"][0]["film"] |= changed
    with pytest.raises(DocumentError, match=message):
        parse_machine(said)


def test_machine_of_films_keeps_its_document() -> None:
    machine = between_two_bearings()
    assert Machine.model_validate(machine.model_dump(mode="json")) == machine
