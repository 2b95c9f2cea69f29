"""Changes of loads: no surer than they can be solved for, and none of a shaft that nothing joins to the one that moved."""

import copy

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.alignment.load_change import LoadChange, load_changes
from estimator.diagnosis.alignment_size import has_moved
from estimator.fit.estimates import CONFIDENCE_95
from estimator.machine.document import Machine, parse_machine
from estimator.updated_model.bearing_loads import WEIGHT_ERROR
from estimator.updated_model.model import expected_model
from tests.estimator.statics.films import motor_compressor_document
from tests.estimator.updated_model.test_alignment_results import SPREAD

SUNK = ("bearing.B3.elevation_y", "bearing.B4.elevation_y")
SURER = 0.1
"""Part that a run leaves of what is believed beforehand."""


def with_a_lone_shaft() -> Machine:
    """The motor and compressor, and a copy of the second shaft on B5 and B6 that no coupling joins."""
    said = motor_compressor_document("flexible", "aligned")
    said["shafts"].append(copy.deepcopy(said["shafts"][-1]) | {"id": "lone"})
    last = [one for one in said["bearings"] if one["shaft"] == "S2"]
    said["bearings"] += [copy.deepcopy(one) | {"id": f"B{number}", "shaft": "lone"} for number, one in enumerate(last, 5)]
    for bearing in said["bearings"]:
        bearing["speed_dependence"] = {"form": "journal", "elevation_spread": SPREAD}
    return parse_machine(said)


@pytest.fixture(scope="module")
def changes() -> dict[str, LoadChange]:
    """Changes of the loads by a shaft that sinks by 300 µm."""
    model = expected_model(with_a_lone_shaft())
    coordinates = model.coordinates_at(np.ones(1))
    surer = replace(model, covariance=np.diag((SURER * coordinates.spread * coordinates.unit) ** 2))
    moved = coordinates.centre.copy()
    for name in SUNK:
        at = coordinates.names.index(name)
        moved[at] -= 300e-6 / coordinates.unit[at]
    return {one.name: one for one in load_changes([surer] * 3, replace(surer, values=coordinates.point(moved)))}


def test_a_shaft_that_nothing_joins_keeps_its_loads(changes: dict[str, LoadChange]) -> None:
    for number in (5, 6):
        lone = changes[f"bearing.B{number}.load_vertical"]
        assert abs(lone.value) <= CONFIDENCE_95 * lone.error
        assert not has_moved(lone)


def test_bearings_beside_the_coupling_carry_more_or_less(changes: dict[str, LoadChange]) -> None:
    assert changes["bearing.B2.load_vertical"].value * changes["bearing.B3.load_vertical"].value < 0.0
    assert all(one.error >= 1e-6 * one.carried > 0.0 for one in changes.values())


def test_a_direction_that_carries_next_to_nothing_has_no_part(changes: dict[str, LoadChange]) -> None:
    for name, one in changes.items():
        small = abs(one.before) < 0.1 * one.carried
        assert (one.part is None) == small
        assert small or one.part == pytest.approx(one.value / abs(one.before)), name
    assert any(one.part is None for one in changes.values())
    assert any(one.part is not None for one in changes.values())


def test_what_is_less_than_masses_are_known_to_has_not_moved() -> None:
    small = LoadChange("bearing.B1.load_vertical", value=0.9 * WEIGHT_ERROR, error=1e-9, before=1.0, carried=1.0)
    assert not has_moved(small)
    assert has_moved(of_size(small, 1.1 * WEIGHT_ERROR))


def of_size(one: LoadChange, value: float) -> LoadChange:
    """Return a change of another size."""
    return LoadChange(one.name, value=value, error=one.error, before=one.before, carried=one.carried)
