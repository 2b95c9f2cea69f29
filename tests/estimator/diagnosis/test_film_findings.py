"""Changes of trains on oil films: rigid motions behind a coupling, bearings that settle by themselves, sizes."""

import math

import numpy as np
import pytest

from estimator.diagnosis.change_columns import ChangeColumns
from estimator.diagnosis.film_findings import (
    moved_alignments,
    oil_size,
    oils,
    rigid_motion,
    settlement_size,
    settlements,
    wear_size,
    wears,
)
from estimator.diagnosis.finding_kind import BaselineValues, Cause
from estimator.machine.document import Machine, parse_machine
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.parameters import unknowns
from estimator.statics.alignment import coupling_alignments
from tests.estimator.statics.films import motor_compressor_document
from tests.estimator.statics.test_alignment import long_train, three_bearings

TWO_SHAFTS = parse_machine(motor_compressor_document("flexible"))
NUMBERS = ("clearance", "viscosity", "elevation_x", "elevation_y")


def columns_of(machine: Machine, *, supplies: tuple[str, ...] = ()) -> ChangeColumns:
    names = [f"bearing.{one.id}.{number}" for one in machine.bearings for number in NUMBERS]
    if supplies:
        names = [name for name in names if "viscosity" not in name] + [f"oil.{one}.viscosity_factor" for one in supplies]
    unknown = unknowns(machine, assemble_rotor(machine))
    return ChangeColumns(machine, unknown, names, typical=np.zeros(len(names)), amplitude={})


def cause(names: tuple[str, ...], change: list[float]) -> Cause:
    size = len(names)
    return Cause("any", "machine", 9.0, names, np.array(change), 1e-4 * np.eye(size), 9.0, (9.0,))


@pytest.mark.parametrize("machine", [TWO_SHAFTS, long_train(), long_train(stations=three_bearings(long_train()))])
def test_what_lies_behind_a_coupling_moves_as_one_body_and_leaves_the_others_aligned(machine: Machine) -> None:
    alignments = coupling_alignments(machine)
    for number, coupling in enumerate(machine.couplings):
        offset, angle = rigid_motion(machine, coupling)
        for place, one in enumerate(alignments):
            assert one.offset @ offset == pytest.approx(float(place == number), abs=1e-9)
            assert one.angle @ angle == pytest.approx(float(place == number), abs=1e-9)
            assert one.angle @ offset == pytest.approx(0.0, abs=1e-9)
            assert one.offset @ angle == pytest.approx(0.0, abs=1e-9)


def test_a_shaft_on_two_bearings_at_the_end_of_a_train_has_no_settlement_of_its_own() -> None:
    assert list(settlements(columns_of(TWO_SHAFTS))) == []
    between = {f"bearing.{one.id}" for one in long_train().bearings if one.shaft == long_train().shafts[1].id}
    assert {one.element for one in settlements(columns_of(long_train()))} == between
    three = long_train(stations=three_bearings(long_train()))
    assert len(list(settlements(columns_of(three)))) == 3


def test_only_bearings_on_films_wear() -> None:
    columns = columns_of(TWO_SHAFTS)
    assert [one.element for one in wears(columns)] == ["bearing.B1", "bearing.B2", "bearing.B3", "bearing.B4"]
    of_films = [name for name in columns.names if "elevation" in name or not name.startswith("bearing.B1.")]
    beside = ChangeColumns(TWO_SHAFTS, columns.unknowns, of_films, typical=np.zeros(len(of_films)), amplitude={})
    assert [one.element for one in wears(beside)] == ["bearing.B2", "bearing.B3", "bearing.B4"]


def test_misalignment_moves_elevations_alone() -> None:
    columns = columns_of(TWO_SHAFTS)
    (found,) = moved_alignments(columns)
    assert found.element == "coupling.C1"
    moved = {columns.names[place] for variant in found.variants for place in np.flatnonzero(variant.any(axis=1))}
    assert moved == {f"bearing.{bearing}.elevation_{axis}" for bearing in ("B3", "B4") for axis in "xy"}


def test_each_bearing_can_wear_and_all_share_their_oil() -> None:
    columns = columns_of(TWO_SHAFTS)
    assert [one.element for one in wears(columns)] == ["bearing.B1", "bearing.B2", "bearing.B3", "bearing.B4"]
    (oil,) = oils(columns)
    (together,) = oil.variants
    assert np.count_nonzero(together) == 4
    two = columns_of(TWO_SHAFTS, supplies=("A", "B"))
    (found,) = oils(two)
    assert [np.count_nonzero(one) for one in found.variants] == [2, 1, 1]


def test_trains_without_films_have_no_such_changes() -> None:
    machine = long_train()
    unknown = unknowns(machine, assemble_rotor(machine))
    names = [one.name for one in unknown.coefficients]
    columns = ChangeColumns(machine, unknown, names, typical=np.ones(len(names)), amplitude={})
    assert [list(one(columns)) for one in (moved_alignments, settlements, wears, oils)] == [[], [], [], []]


def test_sizes_are_those_of_the_cause() -> None:
    baseline = BaselineValues({"bearing.B2.clearance": math.log(100e-6)}, {})
    worn = wear_size(cause(("bearing.B2.clearance",), [math.log(1.2)]), baseline)
    assert worn.per_cent == pytest.approx(20.0)
    assert worn.quantities["before_um"] == pytest.approx(100.0)
    assert worn.quantities["after_um"] == pytest.approx(120.0)
    oil = oil_size(cause(("bearing.B1.viscosity", "bearing.B2.viscosity"), [math.log(2.0)] * 2), baseline)
    assert oil.per_cent == pytest.approx(100.0)
    settled = settlement_size(cause(("bearing.N1.elevation_x", "bearing.N1.elevation_y"), [0.0, -100e-6]), baseline)
    assert settled.quantities["vertical_um"] == pytest.approx(-100.0)
    assert settled.tolerance_per_cent == pytest.approx(200.0)
