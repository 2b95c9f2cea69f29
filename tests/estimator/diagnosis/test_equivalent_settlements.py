"""Bearings whose settlement would be the same as a misalignment: one where the angle is known, more where it is not."""

import numpy as np
import pytest

from estimator.arrays import Floats
from estimator.diagnosis.equivalent_settlements import equivalent_settlements
from estimator.diagnosis.film_findings import rigid_motion
from estimator.diagnosis.finding_kind import Cause
from estimator.machine.document import Machine, parse_machine
from estimator.statics.alignment import coupling_alignments
from tests.estimator.statics.films import motor_compressor_document
from tests.estimator.statics.test_alignment import long_train

TWO_SHAFTS = parse_machine(motor_compressor_document("flexible"))


def seen(machine: Machine, elevations: Floats, *, offset: float, angle: float, coupling: int = 0) -> Cause:
    """Return what a diagnosis tells of vertical elevations that it knows by offset [m] and angle [rad] of a coupling so
    well."""
    alignment = coupling_alignments(machine)[coupling]
    own = np.stack(rigid_motion(machine, machine.couplings[coupling]), axis=1)
    behind = np.flatnonzero(own[:, 0])
    change = own[behind] @ np.array([alignment.offset @ elevations, alignment.angle @ elevations])
    spread = own[behind] @ np.diag([offset**2, angle**2]) @ own[behind].T
    names = tuple(f"bearing.{machine.bearings[place].id}.elevation_y" for place in behind)
    element = f"coupling.{machine.couplings[coupling].id}"
    return Cause("misalignment", element, 99.0, names, change, spread + 1e-16 * np.eye(len(names)), 9.0, (9.0,))


@pytest.mark.parametrize("number", [0, 1, 2, 3])
def test_where_offset_and_angle_are_known_it_is_the_bearing_that_settled(number: int) -> None:
    settled = np.zeros(4)
    settled[number] = -80e-6
    (found,) = equivalent_settlements(TWO_SHAFTS, seen(TWO_SHAFTS, settled, offset=1e-6, angle=1e-6))
    assert (found.bearing, found.plane) == (f"B{number + 1}", "vertical")
    assert found.elevation == pytest.approx(-80e-6, rel=0.01)


def test_where_the_angle_is_unknown_more_than_one_may_have_settled() -> None:
    settled = np.array([0.0, 0.0, -80e-6, 0.0])
    found = equivalent_settlements(TWO_SHAFTS, seen(TWO_SHAFTS, settled, offset=3e-6, angle=500e-6))
    assert [(one.bearing, one.elevation > 0) for one in found] == [
        ("B1", False),
        ("B2", True),
        ("B3", False),
        ("B4", True),
    ]


def test_a_parallel_offset_is_no_single_bearings_settlement() -> None:
    lifted = np.array([0.0, 0.0, 100e-6, 100e-6])
    assert equivalent_settlements(TWO_SHAFTS, seen(TWO_SHAFTS, lifted, offset=1e-6, angle=1e-6)) == ()


def test_what_is_hardly_seen_has_no_equivalents() -> None:
    lifted = np.array([0.0, 0.0, 2e-6, 0.0])
    assert equivalent_settlements(TWO_SHAFTS, seen(TWO_SHAFTS, lifted, offset=3e-6, angle=500e-6)) == ()


def test_a_bearing_that_would_move_another_coupling_too_is_none() -> None:
    machine = long_train()
    settled = np.array([float(one.shaft == machine.shafts[0].id) for one in machine.bearings]) * np.arange(
        len(machine.bearings)
    )
    settled = -80e-6 * (settled == settled.max())
    found = equivalent_settlements(machine, seen(machine, settled, offset=1e-6, angle=1e-6))
    ends = {one.id for one in machine.bearings if one.shaft == machine.shafts[0].id}
    assert {one.bearing for one in found} <= ends
    assert len(found) == 1
