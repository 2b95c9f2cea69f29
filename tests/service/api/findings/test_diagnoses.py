"""Tests what an identification says of its machine, over HTTP: causes with the units of what has moved."""

from datetime import datetime

import pytest
from sqlalchemy import update

from storage.database.engine import Database
from storage.tables.alerting import AlertRow
from tests.api_in_process import Api, problem
from tests.plant import KEY, START, identification, store_identification
from tests.service.monitoring.test_assessment import BASELINE, STIFFER, WEEK, Weeks

NEWEST = f"/machines/{KEY.machine}/diagnosis"


@pytest.fixture
def api(plant: Database) -> Api:
    """An API over a machine whose coupling goes out of alignment."""
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE)
        weeks.file(STIFFER, times=2)
    return Api(plant)


def test_a_diagnosis_says_what_has_moved_in_which_unit(api: Api) -> None:
    found = api.value(NEWEST)
    assert found == api.value(f"/identifications/{BASELINE + 2}/diagnosis")
    assert found["baseline"] == list(range(1, BASELINE + 1))
    (cause,) = found["causes"]
    assert (cause["kind"], cause["element"], cause["form"]) == ("misalignment", "coupling.C1", "parallel")
    assert cause["since"].endswith("Z")
    assert datetime.fromisoformat(cause["since"]).timestamp() == pytest.approx((START + (BASELINE + 1) * WEEK) / 1e9)
    assert cause["first_identification"] == BASELINE + 1
    moved = {one["parameter"]: one for one in cause["moved"]}
    assert {"coupling.C1.kxx", "bearing.B2.kxx"} <= moved.keys()
    stiffer = moved["coupling.C1.kxx"]
    assert stiffer["unit"] == "N/m"
    assert stiffer["lower_per_cent"] < stiffer["per_cent"] < stiffer["upper_per_cent"]
    assert stiffer["sigma"] > 3
    assert {one["unit"] for one in cause["moved"]} <= {"N/m", "N s/m", "N m/rad", "N m s/rad"}


def test_an_unbalance_is_one_vector_in_its_unit(plant: Database) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE)
        weeks.file({"disc.D1.unbalance": 3.0}, times=2)
    (cause,) = Api(plant).value(NEWEST)["causes"]
    assert (cause["kind"], cause["element"]) == ("unbalance", "disc.D1")
    (moved,) = cause["moved"]
    assert (moved["parameter"], moved["unit"]) == ("disc.D1.unbalance", "kg m")
    assert moved["change"] > 0.0
    (part,) = cause["parts"]
    assert (part["name"], part["unit"]) == ("disc.D1.unbalance", "g mm")
    assert part["value"] == pytest.approx(cause["quantities"]["change_g_mm"])
    assert part["lower"] < part["value"] < part["upper"]


def test_where_there_is_no_diagnosis_the_reason_is_said(plant: Database) -> None:
    api = Api(plant)
    assert "no diagnosis" in problem(api.get(NEWEST), 422)["detail"]
    with plant.transaction() as session:
        row = store_identification(session, identification(), run_id=1, measured_at=START)
        number = row.id
    assert "no diagnosis" in problem(api.get(f"/identifications/{number}/diagnosis"), 422)["detail"]
    problem(api.get("/identifications/999/diagnosis"), 404)
    problem(api.get("/machines/none/diagnosis"), 404)


def test_an_alert_rests_on_the_same_cause_with_its_units(api: Api) -> None:
    (alert,) = api.value("/alerts")
    assert alert == api.value(f"/alerts/{alert['id']}")
    (cause,) = api.value(NEWEST)["causes"]
    evidence = alert["evidence"]
    told = cause.pop("advice")
    assert {name: evidence[name] for name in cause} == cause
    assert evidence.keys() - cause.keys() == {"identification", "run_kind", "baseline", "measured_at"}
    assert told == alert["advice"]
    assert alert["message"] == told["what"]
    assert (evidence["identification"], evidence["baseline"]) == (BASELINE + 2, list(range(1, BASELINE + 1)))


def test_an_alert_of_a_rate_says_how_fast(plant: Database) -> None:
    with plant.transaction() as session:
        weeks = Weeks(session)
        weeks.file(times=BASELINE)
        for week in range(14):
            weeks.file({"bearing.B1.kxx": 1.01**week})
    api = Api(plant)
    (alert,) = (one for one in api.value("/alerts") if one["rule"] == "rate_of_change")
    evidence = alert["evidence"]
    assert alert == api.value(f"/alerts/{alert['id']}")
    assert (evidence["kind"], evidence["parameter"]) == ("rate_of_change", "bearing.B1.kxx")
    assert evidence["lower_per_cent"] < evidence["per_week_per_cent"] < evidence["upper_per_cent"]


def test_what_an_older_release_stored_is_answered_as_it_was_stored(api: Api, plant: Database) -> None:
    older = {"coupling": "C1", "shift": 0.12}
    with plant.transaction() as session:
        session.execute(update(AlertRow).values(evidence=older))
    (alert,) = api.value("/alerts")
    assert api.value(f"/alerts/{alert['id']}")["evidence"] == alert["evidence"] == older
