"""Alignment over HTTP: what is told by itself, and its change against the baseline, as the estimator computes them."""

from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.alignment.alignment_change import alignment_change_quantities
from estimator.alignment.tolerance import allowed_alignment
from estimator.arrays import Floats
from estimator.fit.validation.channel_sensitivity import ChannelEffects
from estimator.machine.document import parse_machine
from estimator.updated_model.derived_quantities import Derived, alignment_quantities
from estimator.updated_model.model import UpdatedModel, expected_model
from service.monitoring.assessment.context import WEEK
from storage.database.engine import Database
from storage.machines import machines
from tests.api_in_process import Api, problem, value
from tests.estimator.diagnosis.test_film_reference import effects as no_errors
from tests.estimator.updated_model.test_alignment_results import NAMES, machine_of, with_known_offset
from tests.plant import KEY, START, identification, store_identification

MACHINE = machine_of()
NARROW = with_known_offset(expected_model(MACHINE), error=10e-6)
KNOWN = np.array([name.startswith("coupling.") for name in NARROW.coordinates]) | (np.diag(NARROW.covariance) == 0.0)
"""Coordinates that runs know, couplings' among them: else no offset would be told."""
MODEL = replace(NARROW, covariance=np.where(np.diag(KNOWN), 1e-8, NARROW.covariance))
BASELINE = 5
MOVED = 60e-6
"""Rise of the driven shaft's two bearings [m]."""


def raised(by: float) -> Floats:
    """The point of a machine whose driven shaft has risen [m]."""
    point = MODEL.values.copy()
    for bearing in ("B3", "B4"):
        point[MODEL.coordinates.index(f"bearing.{bearing}.elevation_y")] += by
    return point


def file(
    database: Database, week: int, point: Floats, *, run_kind: str = "run-down", effects: ChannelEffects | None = None
) -> None:
    outcome = identification(
        estimates=(),
        coordinates=MODEL.coordinates,
        point=point,
        covariance=MODEL.covariance,
        channel_effects=effects,
    )
    with database.transaction() as session:
        store_identification(
            session, outcome, run_id=week, measured_at=START + week * WEEK, run_kind=run_kind, machine_id=MACHINE.id
        )


@pytest.fixture
def api(plant: Database) -> Api:
    """An API over a baseline of aligned runs, and one after it in which the driven shaft has risen."""
    with plant.transaction() as session:
        machines.create(session, MACHINE)
    for week in range(1, BASELINE + 1):
        file(plant, week, raised(0.0))
    file(plant, BASELINE + 1, raised(MOVED))
    return Api(plant)


def by_name(quantities: tuple[Derived, ...]) -> dict[str, Derived]:
    return {one.name: one for one in quantities}


def assert_same(told: dict[str, Any], expected: Derived) -> None:
    assert told["reason"] == expected.reason
    for field in ("value", "lower", "upper"):
        number = getattr(expected, field)
        assert told[field] == (None if number is None else pytest.approx(number, rel=1e-6))


def test_alignment_is_reported_with_its_change_against_the_baseline(api: Api) -> None:
    found = api.value(f"/machines/{MACHINE.id}/alignment")
    assert (found["identification"], found["missing"]) == (BASELINE + 1, None)
    assert found["baseline"]["identifications"] == [1, 2, 3, 4, 5]
    numbers = {one["name"]: one for one in found["numbers"]}
    assert tuple(numbers) == NAMES
    later = UpdatedModel(MODEL.machine, MODEL.coordinates, raised(MOVED), MODEL.covariance)
    alone, changed = by_name(alignment_quantities(later)), by_name(alignment_change_quantities([MODEL] * BASELINE, later))
    for name, one in numbers.items():
        assert_same(one["absolute"], alone[name])
        assert_same(one["change"], changed[name])
    offset = numbers["coupling.C1.offset_vertical"]
    assert (offset["coupling"], offset["quantity"], offset["unit"]) == ("C1", "offset_vertical", "m")
    assert offset["change"]["lower"] < MOVED < offset["change"]["upper"]
    assert offset["allowed"] == pytest.approx(allowed_alignment(MACHINE, "C1").offset)
    assert 0.0 < offset["beyond"] <= 1.0
    assert numbers["coupling.C1.angle_vertical"]["beyond"] is None
    assert "hardly more" in numbers["coupling.C1.angle_vertical"]["absolute"]["reason"]


def test_runs_whose_probe_was_off_are_compared_by_their_estimates_with_its_gain(api: Api) -> None:
    """The alert goes by these, too: the table beside it tells the same."""
    expected = api.value(f"/machines/{MACHINE.id}/alignment")["numbers"]
    beside = replace(no_errors(len(MODEL.coordinates)), point=raised(MOVED), covariance=MODEL.covariance)
    file(api.database, BASELINE + 2, raised(0.0), effects=beside)
    found = api.value(f"/machines/{MACHINE.id}/alignment")
    assert found["identification"] == BASELINE + 2
    assert found["numbers"] == expected


def test_a_baseline_whose_probe_was_off_is_that_of_its_estimates_with_the_gain(plant: Database) -> None:
    with plant.transaction() as session:
        machines.create(session, MACHINE)
    aligned = replace(no_errors(len(MODEL.coordinates)), point=raised(0.0), covariance=MODEL.covariance)
    for week in range(1, BASELINE + 1):
        file(plant, week, raised(MOVED), effects=aligned)
    file(plant, BASELINE + 1, raised(MOVED))
    found = Api(plant).value(f"/machines/{MACHINE.id}/alignment")
    offset = next(one for one in found["numbers"] if one["name"] == "coupling.C1.offset_vertical")
    assert offset["change"]["lower"] < MOVED < offset["change"]["upper"]
    assert offset["change"]["lower"] > 0.0


def test_without_a_baseline_there_is_no_change_and_it_is_said(api: Api) -> None:
    found = api.value(f"/machines/{MACHINE.id}/alignment", identification=2)
    assert found["missing"] == "identification 2 is part of the baseline"
    assert [one["change"] for one in found["numbers"]] == [None] * len(NAMES)
    assert found["numbers"][0]["absolute"]["value"] == pytest.approx(0.0, abs=1e-6)


def test_hot_and_cold_runs_are_reported_against_targets_of_their_own(api: Api) -> None:
    assert {one["target"] for one in api.value(f"/machines/{MACHINE.id}/alignment")["numbers"]} == {None}
    target = {"coupling": "C1", "left_cold": {"offset_vertical": -100e-6, "angle_vertical": 0.0}}
    target["growth"] = {"offset_vertical": 120e-6}
    said = MACHINE.model_dump(mode="json")
    said["operation"]["alignment_targets"] = [target]
    with api.database.transaction() as session:
        machines.revise(session, parse_machine(said))
    file(api.database, BASELINE + 2, raised(0.0), run_kind="run-up")

    def told(which: int) -> dict[str, Any]:
        numbers = api.value(f"/machines/{MACHINE.id}/alignment", identification=which)["numbers"]
        return {one["quantity"]: one["target"] for one in numbers}

    hot, cold = told(BASELINE + 1), told(BASELINE + 2)
    assert (hot["offset_vertical"]["state"], cold["offset_vertical"]["state"]) == ("hot", "cold")
    assert hot["offset_vertical"]["target"] == pytest.approx(20e-6)
    assert hot["offset_vertical"]["off"]["value"] == pytest.approx(MOVED - 20e-6, abs=1e-6)
    assert cold["offset_vertical"]["off"]["value"] == pytest.approx(100e-6, abs=1e-6)
    assert cold["offset_vertical"]["beyond"] > 0.95
    assert hot["angle_vertical"] is None  # of which no growth is stated
    assert "hardly more" in cold["angle_vertical"]["off"]["reason"]
    assert hot["offset_horizontal"] is None


def test_a_train_without_films_has_no_numbers(api: Api) -> None:
    with api.database.transaction() as session:
        store_identification(session, identification(), run_id=100)
    assert value(api.get(f"/machines/{KEY.machine}/alignment"))["numbers"] == []


def test_what_is_not_there_is_refused(api: Api) -> None:
    problem(api.get("/machines/none/alignment"), 404)
    problem(api.get(f"/machines/{KEY.machine}/alignment"), 404)
    problem(api.get(f"/machines/{MACHINE.id}/alignment?identification=99"), 404)
