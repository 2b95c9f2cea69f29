"""Tests that the answer says what is wrong with a request, always in one shape."""

import json
import re

import pytest
from sqlalchemy import update

from service.api.conventions.many_problems import MOST_PROBLEMS
from storage.database.engine import Database
from storage.tables.measurements import RunRow
from tests.api_in_process import PREFIX, Api, fields, problem
from tests.databases import Databases
from tests.plant import machine


@pytest.mark.parametrize(
    "path",
    [f"/machines/nobody{rest}" for rest in ("", "/revisions", "/samples", "/runs", "/identifications", "/jobs", "/alerts")]
    + ["/machines/nobody/trends?parameter=a.b", "/runs/9", "/runs/9/phasors", "/identifications/9", "/alerts/9"]
    + [f"/{kind}/{2**62}" for kind in ("runs", "identifications", "alerts")]
    + ["/nothing", "/machines/pump-7/nothing"],
)
def test_what_is_not_there_is_a_404(filled: Api, path: str) -> None:
    problem(filled.get(path), 404)


@pytest.mark.parametrize(
    ("path", "field"),
    [
        ("/machines/pump 7", "path.machine_id"),
        ("/machines/pump-7/runs?limit=0", "query.limit"),
        ("/machines/pump-7/runs?limit=1001", "query.limit"),
        ("/machines/pump-7/runs?from=yesterday", "query.from"),
        ("/machines/pump-7/identifications?to=yesterday", "query.to"),
        ("/machines/pump-7/jobs?limit=x", "query.limit"),
        ("/machines/pump-7/samples?limit=10001", "query.limit"),
        ("/machines/pump-7/alerts?open=perhaps", "query.open"),
        ("/machines/pump-7/trends", "query.parameter"),
        ("/machines/pump-7/trends?parameter=a.b&scope=all", "query.scope"),
        ("/runs/-1", "path.run_id"),
        ("/runs/x", "path.run_id"),
        (f"/runs/{2**63}", "path.run_id"),
        ("/identifications/x", "path.identification_id"),
        ("/alerts/x", "path.alert_id"),
        ("/alerts?limit=0", "query.limit"),
        ("/quarantine?limit=0", "query.limit"),
    ],
)
def test_a_wrong_request_is_a_422_that_names_the_parameter(filled: Api, path: str, field: str) -> None:
    assert fields(filled.get(path)) == [field]


@pytest.mark.parametrize("path", ["runs", "identifications", "trends?parameter=bearing.B1.kxx"])
@pytest.mark.parametrize("limit", ["from=0001-01-01T00:00:00Z", "to=9999-12-31T23:59:59Z", "from=2400-01-01T00:00:00"])
def test_a_time_far_away_is_a_time_like_any_other(filled: Api, path: str, limit: str) -> None:
    assert filled.get(f"/machines/pump-7/{path}{'&' if '?' in path else '?'}{limit}").status_code == 200


def test_a_method_that_is_not_offered_is_a_405_with_those_that_are(filled: Api) -> None:
    answer = filled.ask("DELETE", f"{PREFIX}/machines/pump-7")
    problem(answer, 405)
    assert answer.headers.get("allow")


def test_a_database_that_does_not_answer_is_a_503(api: Api, plant: Database, databases: Databases) -> None:
    plant.close()
    databases.take_away(plant.url)
    health = api.get("/health")
    assert health.status_code == 503
    assert re.search("was deleted or replaced|does not answer", health.json()["parts"]["database"])
    problem(api.get("/machines"), 503)


def test_stored_data_that_cannot_be_read_is_a_problem_too(changing: Api) -> None:
    with changing.database.transaction() as session:
        session.execute(update(RunRow).where(RunRow.state == "closed").values(data=b"\0"))
    down = changing.value("/machines/pump-7/runs")[1]
    problem(changing.get(f"/runs/{down['id']}/phasors"), 503)


def test_of_very_many_problems_the_first_are_listed(filled: Api) -> None:
    document = machine().model_dump(mode="json")
    document["shafts"][0]["sections"] = [{}] * 200
    errors = problem(filled.ask("POST", f"{PREFIX}/machines", json=document), 422)["errors"]
    assert len(errors) == MOST_PROBLEMS + 1
    assert errors[0] == {"field": "shafts[0].sections[0].length", "message": "Field required"}
    assert errors[-1] == {
        "field": "document",
        "message": f"there are more than {MOST_PROBLEMS} problems: mend those that are listed first",
    }


def test_of_thousands_only_the_first_of_each_list_are_looked_at(filled: Api) -> None:
    """Or the service would answer nobody meanwhile: 12,000 took most of a second."""
    document = machine().model_dump(mode="json")
    document["shafts"] = [{"id": "A", "sections": [{"length": 1.0, "outer_diameter": 0.1}] * 200} for _ in range(6)]
    document["shafts"][0]["id"] = json.loads('{"x": ' * 500 + "0" + "}" * 500)
    document["speed_range"] = {}
    errors = problem(filled.ask("POST", f"{PREFIX}/machines", json=document), 422)["errors"]
    told_of = [error["field"] for error in errors]
    assert "speed_range.minimum_rpm" in told_of
    assert "shafts[5].sections[19].material" in told_of
    assert len(errors) < MOST_PROBLEMS
    assert re.fullmatch(r"12\d\d problems in all: those of the first 20 of each list are told", errors[-1]["message"])
