"""The API over a real database: every endpoint's answers and errors, all errors in one shape, and never a NaN."""

import json
import math
import re
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sqlalchemy import update

from service.alerting import Finding, Person, acknowledge, clear_alert, raise_alert
from service.collection import Collector
from service.journal import Journal
from storage import jobs
from storage import samples as sample_store
from storage.database import Database
from storage.quarantine import Rejection
from storage.samples import SourceKey
from storage.tables import AlertRow, RunRow
from tests.asking import PREFIX, Api, fields, problem
from tests.databases import Databases, opened
from tests.plant import (
    SECOND,
    START,
    arrived,
    batch,
    document,
    identification,
    machine,
    samples,
    store_identification,
    sweep_rpm,
)

MOMENT = datetime.fromtimestamp(START // SECOND, UTC)


@pytest.fixture
def api(plant: Database) -> Api:
    """Over a database that knows the machine and nothing else."""
    return Api(plant)


@pytest.fixture(scope="module")
def story_template(databases: Databases, plant_template: str, tmp_path_factory: pytest.TempPathFactory) -> str:
    """URL of a database with a story to tell."""
    url = databases.copy(plant_template, tmp_path_factory.mktemp("story") / "story.db")
    database = Database(url)
    tell(database)
    database.close()
    return url


@pytest.fixture(scope="module")
def told(databases: Databases, story_template: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Api]:
    """Over the story, which no test changes."""
    with opened(databases, story_template, tmp_path_factory.mktemp("told") / "told.db") as database:
        yield Api(database)


@pytest.fixture
def changing(databases: Databases, story_template: str, tmp_path: Path) -> Iterator[Api]:
    """Over a story of the test's own."""
    with opened(databases, story_template, tmp_path / "rundown.db") as database:
        yield Api(database)


def tell(database: Database) -> None:
    """A run-down, an open run-up, three identifications of which one was not accepted, an alert, a queued and a failed job."""
    rpm = [*sweep_rpm(2990.0, 310.0), 250.0, *sweep_rpm(310.0, 1500.0)]
    one = batch(rpm, sequence=3)
    one.amplitude[0][1] = None
    journal = Journal(database, Collector())
    journal.store([arrived(one)], [Rejection(START, "some/key", "pump-7", "bad_frame", "no frame", b"\xff\x00noise")])
    with database.transaction() as session:
        for number, (factor, accepted) in enumerate([(1.0, True), (1.1, False), (1.2, True)]):
            outcome = identification(
                {"coupling.C1.kxx": factor}, unknown=["bearing.B1.kxy"], accepted=accepted, condition_number=math.inf
            )
            row = store_identification(session, outcome, run_id=100 + number, measured_at=START + number * 3600 * SECOND)
        gathered = identification({"coupling.C1.kxx": 1.5})
        store_identification(session, gathered, run_id=200, scope=jobs.GATHERED, run_kind="gathered")
        failed = jobs.ask(session, "pump-7", scope=jobs.GATHERED, run_ids=[1, 2])
        assert failed is not None
        jobs.finish(failed, state=jobs.FAILED, error="NotEnoughData: too few")
        finding = Finding(
            "Coupling C1 is going out of alignment", {"shift": math.nan, "parts": [math.inf, 1.0]}, row.id, row.measured_at
        )
        raise_alert(session, "pump-7", rule="misalignment", element="coupling.C1", finding=finding)


# --- machines -------------------------------------------------------------------------------------------------------


def test_machines_are_listed(api: Api) -> None:
    (one,) = api.value("/machines")
    assert (one["id"], one["plant"], one["name"], one["revision"]) == ("pump-7", "plant-1", "Pump 7", 1)
    assert datetime.fromisoformat(one["created_at"]).tzinfo is not None


def test_a_machine_is_created_and_read_back(api: Api) -> None:
    given = document(id="fan-2")
    answer = api.ask("POST", f"{PREFIX}/machines", json=given)
    assert answer.status_code == 201
    assert answer.headers["location"] == f"{PREFIX}/machines/fan-2"
    body = api.value("/machines/fan-2")
    assert body == answer.json()
    assert (body["id"], body["revision"]) == ("fan-2", 1)
    assert machine(id="fan-2") == type(machine()).model_validate(body["document"])


def test_a_machine_is_created_once(api: Api) -> None:
    assert "pump-7" in problem(api.ask("POST", f"{PREFIX}/machines", json=document()), 409)["detail"]


def test_a_document_is_revised_and_every_revision_stays(api: Api) -> None:
    answer = api.ask("PUT", f"{PREFIX}/machines/pump-7", json=document(name="New"))
    assert answer.status_code == 200
    assert answer.json()["revision"] == 2
    assert api.ask("PUT", f"{PREFIX}/machines/pump-7", json=document(name="New")).json()["revision"] == 2
    assert [one["document"]["name"] for one in api.value("/machines/pump-7/revisions")] == ["Pump 7", "New"]
    assert api.value("/machines/pump-7")["document"]["name"] == "New"


def test_a_revision_must_be_of_that_machine_and_plant(api: Api) -> None:
    problem(api.ask("PUT", f"{PREFIX}/machines/fan-2", json=document(id="fan-2")), 404)
    problem(api.ask("PUT", f"{PREFIX}/machines/pump-7", json=document(plant="plant-2")), 409)
    (error,) = problem(api.ask("PUT", f"{PREFIX}/machines/pump-7", json=document(id="fan-2")), 422)["errors"]
    assert error["field"] == "id"
    assert "fan-2" in error["message"]


def changed(path: str, value: Any) -> dict[str, Any]:
    """The document with one thing in it replaced, such as `bearings.1.shaft`."""
    given = document(noise={"relative": 0.01, "floor": 0.0})
    *way, last = [int(part) if part.isdigit() else part for part in path.split(".")]
    place: Any = given
    for part in way:
        place = place[part]
    place[last] = value
    return given


@pytest.mark.parametrize("method", ["POST", "PUT"])
@pytest.mark.parametrize(
    ("path", "value", "field"),
    [
        ("name", "", "name"),
        ("id", "pump 7", "id"),
        ("speed_range.minimum_rpm", -1, "speed_range.minimum_rpm"),
        ("speed_range.minimum_rpm", 4000, "speed_range"),
        ("shafts.1.sections.0.length", "long", "shafts[1].sections[0].length"),
        ("bearings.2.kxx", -5.0, "bearings[2].kxx"),
        ("bearings.2.colour", "red", "bearings[2].colour"),
        ("discs.0.unbalance", {"magnitude": 1.0}, "discs[0].unbalance.angle_deg"),
        # Between the document's parts:
        ("shafts.1.sections.0.material", "brass", "shafts[1].sections[0].material"),
        ("bearings.2.shaft", "S9", "bearings[2].shaft"),
        ("bearings.2.station", 0.7, "bearings[2].station"),
        ("couplings.0.driven", "S9", "couplings[0].driven"),
    ],
)
def test_a_wrong_document_is_refused_with_the_field(api: Api, method: str, path: str, value: Any, field: str) -> None:
    where = f"{PREFIX}/machines" + ("/pump-7" if method == "PUT" else "")
    assert fields(api.ask(method, where, json=changed(path, value))) == [field]
    assert api.value("/machines/pump-7")["revision"] == 1


def test_every_wrong_field_is_named(api: Api) -> None:
    given = changed("bearings.2.shaft", "S9")
    given["probes"][0]["station"] = 9.0
    given["discs"][1]["id"] = "D1"
    answer = api.ask("POST", f"{PREFIX}/machines", json=given)
    assert sorted(fields(answer)) == ["bearings[2].shaft", "discs[0].id", "discs[1].id", "probes[0].station"]


@pytest.mark.parametrize("where", ["materials.steel.poisson_ratio", "bearings.0.kxy", "noise.relative", "element_length"])
@pytest.mark.parametrize("number", ["NaN", "Infinity", "1e999"])
def test_a_document_holds_finite_numbers_only(api: Api, where: str, number: str) -> None:
    body = json.dumps(changed(where, "here")).replace('"here"', number)
    answer = api.ask("POST", f"{PREFIX}/machines", content=body, headers={"content-type": "application/json"})
    assert fields(answer)


@pytest.mark.parametrize("body", [b"", b"{", b"[]", b"null", b'"text"', b"\xff\xfe", b"[" * 100_000])
def test_a_body_that_is_no_document_is_refused(api: Api, body: bytes) -> None:
    answer = api.ask("POST", f"{PREFIX}/machines", content=body, headers={"content-type": "application/json"})
    assert answer.status_code in (400, 422)
    problem(answer, answer.status_code)


# --- measurements ---------------------------------------------------------------------------------------------------


def test_newest_samples(told: Api) -> None:
    body = told.value("/machines/pump-7/samples", limit=2)
    assert body["machine"] == "pump-7"
    assert body["channels"] == ["B2X", "B2Y", "B3X", "B3Y"]
    assert body["speed_rpm"][-1] == pytest.approx(1500.0)
    assert body["direction"] == ["positive"] * 2
    assert [len(column) for column in body["amplitude_um_pp"]] == [2] * 4
    assert body["amplitude_um_pp"][0] == pytest.approx([100.0] * 2)
    assert body["phase_lag_deg"][0] == pytest.approx([30.0] * 2)
    assert datetime.fromisoformat(body["time"][-1]) == MOMENT + timedelta(seconds=80)


def test_samples_before_those_that_were_read(told: Api) -> None:
    whole = told.value("/machines/pump-7/samples", limit=10_000)["time"]
    newest = told.value("/machines/pump-7/samples", limit=5)["time"]
    before = datetime.fromisoformat(newest[0]) - timedelta(microseconds=1)
    older = told.value("/machines/pump-7/samples", limit=7, to=before.isoformat())["time"]
    assert older + newest == whole[-12:]
    asked = {"from": whole[3], "to": whole[8]}
    assert told.value("/machines/pump-7/samples", **asked)["time"] == whole[3:9]


def test_samples_are_read_through_revisions_that_describe_the_same_machine(changing: Api) -> None:
    before = changing.value("/machines/pump-7/samples")
    assert before["revisions"] == [1]
    changing("PUT", "/machines/pump-7", json=document(name="New"))
    after = changing.value("/machines/pump-7/samples")
    assert after["revisions"] == [1, 2]
    assert len(after["time"]) > 0
    assert after | {"revisions": [1]} == before
    other = document(name="New")
    other["bearings"][0]["kxx"] = 1.23e6
    changing("PUT", "/machines/pump-7", json=other)
    none = changing.value("/machines/pump-7/samples")
    assert (none["time"], none["revisions"]) == ([], [3])
    assert changing.value("/machines/pump-7/samples", revision=2)["time"] == before["time"]
    detail = problem(changing.get("/machines/pump-7/samples", revision=9), 404)["detail"]
    assert detail == "no revision 9 of machine 'pump-7': GET /api/v1/machines/<id>/revisions lists them"
    assert "no machine nobody: " in problem(changing.get("/machines/nobody/samples", revision=1), 404)["detail"]


def test_what_a_source_sends_beside_the_1x_is_shown_where_it_is_asked_for(plant: Database, api: Api) -> None:
    held = samples(2)
    held.scatter[:, 1] = 1e-6
    held.second[:, 2] = 2e-6 * np.exp(-1j * np.radians(40.0))
    with plant.transaction() as session:
        key = SourceKey("pump-7", "monitor", 1)
        sample_store.add_block(session, key, revision=1, first_sequence=0, samples=held)
    plain = api.value("/machines/pump-7/samples")
    assert [plain[name] for name in ("amplitude_2x_um_pp", "phase_2x_lag_deg", "scatter_um_pp", "status")] == [None] * 4
    whole = api.value("/machines/pump-7/samples", include=["2x", "scatter", "status"])
    assert whole["status"] == [["not_available"] * 2, *[["good"] * 2] * 3]
    assert whole["scatter_um_pp"] == [[None] * 2, [pytest.approx(2.0)] * 2, [None] * 2, [None] * 2]
    assert whole["amplitude_2x_um_pp"] == [[None] * 2, [None] * 2, [pytest.approx(4.0)] * 2, [None] * 2]
    assert whole["phase_2x_lag_deg"][2] == pytest.approx([40.0] * 2)
    for commas in ("2x,scatter,status", ["2x,scatter", "status"]):
        assert api.value("/machines/pump-7/samples", include=commas) == whole
    for wrong in ("3x", "2x,3x", "2x,", "2x,scatter,status,2x"):
        problem(api.get("/machines/pump-7/samples", include=wrong), 422)


def test_of_a_machine_without_samples_there_are_none(api: Api) -> None:
    body = api.value("/machines/pump-7/samples")
    assert (body["time"], body["speed_rpm"]) == ([], [])
    assert body["amplitude_um_pp"] == [[], [], [], []]


def test_runs_are_listed_newest_first(told: Api) -> None:
    up, down = told.value("/machines/pump-7/runs")
    assert (down["kind"], down["state"], down["samples"]) == ("run-down", "closed", 40)
    assert down["speed_maximum_rpm"] == pytest.approx(2990.0)
    assert (up["kind"], up["state"], up["ended_at"], up["samples"]) == ("run-up", "open", None, None)
    assert datetime.fromisoformat(down["started_at"]) == MOMENT
    assert told.value(f"/runs/{down['id']}") == down


@pytest.mark.parametrize(
    ("limits", "kinds"),
    [
        ({}, ["run-up", "run-down"]),
        ({"limit": 1}, ["run-up"]),
        ({"from": MOMENT + timedelta(seconds=1)}, ["run-up"]),
        ({"to": MOMENT}, ["run-down"]),
        ({"to": MOMENT.replace(tzinfo=None)}, ["run-down"]),
        ({"to": MOMENT.astimezone(UTC) - timedelta(microseconds=1)}, []),
        ({"from": datetime(1, 1, 1, tzinfo=UTC), "to": datetime(9999, 12, 31, tzinfo=UTC)}, ["run-up", "run-down"]),
    ],
)
def test_runs_of_a_time_range(told: Api, limits: dict[str, Any], kinds: list[str]) -> None:
    asked = {name: value.isoformat() if isinstance(value, datetime) else value for name, value in limits.items()}
    assert [one["kind"] for one in told.value("/machines/pump-7/runs", **asked)] == kinds


def test_phasors_of_a_closed_and_of_an_open_run(told: Api) -> None:
    up, down = told.value("/machines/pump-7/runs")
    closed, opened = told.value(f"/runs/{down['id']}/phasors"), told.value(f"/runs/{up['id']}/phasors")
    assert len(closed["time"]) == 40
    assert closed["amplitude_um_pp"][1][0] is None
    assert closed["phase_lag_deg"][1][0] is None
    assert closed["amplitude_um_pp"][0][0] == pytest.approx(100.0)
    assert len(opened["time"]) == 40
    assert opened["speed_rpm"][0] == pytest.approx(310.0)


# --- identifications ------------------------------------------------------------------------------------------------


def test_identifications_are_listed_newest_first(told: Api) -> None:
    found = told.value("/machines/pump-7/identifications")
    assert [one["accepted"] for one in found] == [True, False, True, True]
    assert [one["scope"] for one in found] == ["run", "run", "gathered", "run"]
    assert found[0]["options"] == {"starts": 10, "seed": 0}
    assert math.isfinite(found[0]["condition_number"])
    moment = (MOMENT + timedelta(hours=1)).isoformat()
    assert len(told.value("/machines/pump-7/identifications", **{"from": moment, "to": moment})) == 1
    assert len(told.value("/machines/pump-7/identifications", limit=2)) == 2


def test_an_identification_with_its_estimates(told: Api) -> None:
    newest = told.value("/machines/pump-7/identifications")[0]
    body = told.value(f"/identifications/{newest['id']}")
    assert {name: body[name] for name in newest} == newest
    by_name = {one["parameter"]: one for one in body["estimates"]}
    assert by_name["coupling.C1.kxx"]["value"] == pytest.approx(2.4e6)
    assert by_name["coupling.C1.kxx"]["unit"] == "N/m"
    unknown = by_name["bearing.B1.kxy"]
    assert [unknown[name] for name in ("value", "standard_error", "lower", "upper")] == [None] * 4
    assert "uncertain" in unknown["reason"]
    unbalance = by_name["disc.D2.unbalance"]
    assert unbalance["imaginary"] == -5e-4
    assert unbalance["angle_deg"] == pytest.approx(360 - math.degrees(math.atan(0.5)))
    size = math.hypot(unbalance["value"], unbalance["imaginary"])
    assert unbalance["magnitude"] == pytest.approx(size)
    assert unbalance["lower"] < unbalance["magnitude"] < unbalance["upper"]
    assert unbalance["angle_half_width_deg"] == pytest.approx(math.degrees(math.asin(unbalance["upper"] / size - 1)))
    assert by_name["coupling.C1.kxx"]["angle_deg"] is None
    assert (body["coordinates"], body["covariance"]) == (None, None)


def test_the_covariance_comes_when_asked_for(told: Api) -> None:
    newest = told.value("/machines/pump-7/identifications")[0]
    body = told.value(f"/identifications/{newest['id']}", covariance=True)
    size = len(body["coordinates"])
    assert size == len(body["estimates"]) + 2
    assert [len(row) for row in body["covariance"]] == [size] * size
    assert body["covariance"][0][0] == 1e-4


def test_jobs_are_listed_newest_first(told: Api) -> None:
    found = told.value("/machines/pump-7/jobs")
    assert (found[0]["state"], found[0]["error"]) == ("failed", "NotEnoughData: too few")
    assert (found[-1]["state"], found[-1]["finished_at"], found[-1]["attempts"]) == ("queued", None, 0)
    assert len(told.value("/machines/pump-7/jobs", limit=1)) == 1


# --- alerts ---------------------------------------------------------------------------------------------------------


def test_alerts_of_all_machines_and_of_one(told: Api) -> None:
    (one,) = told.value("/alerts")
    assert (one["machine"], one["rule"], one["element"], one["state"]) == (
        "pump-7",
        "misalignment",
        "coupling.C1",
        "unacknowledged",
    )
    assert one["closed_at"] is None
    assert one["identification"] == told.value("/machines/pump-7/identifications")[0]["id"]
    assert told.value("/machines/pump-7/alerts") == [one]
    assert told.value(f"/alerts/{one['id']}") == one


def test_only_open_alerts_when_asked_for(changing: Api) -> None:
    with changing.database.transaction() as session:
        row = session.get(AlertRow, changing.value("/alerts")[0]["id"])
        assert row is not None
        acknowledge(session, row, Person("anna"))
        clear_alert(session, row)
    for path in ("/alerts", "/machines/pump-7/alerts"):
        assert changing.value(path, open=True) == []
        (one,) = changing.value(path)
        assert one["state"] == "normal"
        assert one["closed_at"] is not None


def test_a_number_that_is_none_is_null_in_the_evidence_too(told: Api) -> None:
    assert told.value("/alerts")[0]["evidence"]["shift"] is None


# --- operations -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("part", "state", "health", "ready"),
    [("ingest", "ok", 200, 200), ("ingest", "its thread has ended", 503, 503), ("stream", "no router answers", 200, 503)],
)
def test_health_and_readiness(api: Api, part: str, state: str, health: int, ready: int) -> None:
    api.parts[part] = state
    for path, status in (("/health", health), ("/ready", ready)):
        answer = api.get(path)
        assert answer.status_code == status
        body = answer.json()
        assert body["parts"] == {**api.parts, "database": "ok"}
        assert body["healthy"] == (health == 200)
        assert body["ready"] == (ready == 200)
        assert body["version"]


@pytest.mark.parametrize(("state", "alive"), [("ok", True), ("the database is locked", True), ("its thread has ended", False)])
def test_only_what_a_new_start_mends_is_a_reason_for_one(api: Api, state: str, alive: bool) -> None:
    api.parts["ingest"] = state
    answer = api.get("/alive")
    assert (answer.status_code, answer.json()) == (200 if alive else 503, {"alive": alive})


def test_health_counts_jobs(told: Api) -> None:
    assert told.value("/health")["jobs"] == {"queued": 1, "done": 4, "failed": 1}


def test_sources(told: Api) -> None:
    (one,) = told.value("/sources")
    assert (one["machine"], one["source"], one["epoch"]) == ("pump-7", "monitor", 1)
    assert (one["next_sequence"], one["received"], one["duplicates"], one["lost"]) == (84, 81, 0, 3)
    assert datetime.fromisoformat(one["newest_sample_at"]) == MOMENT + timedelta(seconds=80)


def test_quarantine(told: Api) -> None:
    body = told.value("/quarantine")
    assert body["counts"] == {"bad_frame": 1}
    (entry,) = body["entries"]
    assert (entry["reason"], entry["machine"], entry["size"]) == ("bad_frame", "pump-7", 7)
    assert "noise" in entry["payload"]
    assert told.value("/quarantine", reason="bad_frame", machine="pump-7", limit=1)["entries"] == [entry]
    assert told.value("/quarantine", reason="too_large")["entries"] == []
    assert told.value("/quarantine", machine="pump-8")["entries"] == []


# --- errors ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "path",
    [f"/machines/nobody{rest}" for rest in ("", "/revisions", "/samples", "/runs", "/identifications", "/jobs", "/alerts")]
    + ["/machines/nobody/trends?parameter=a.b", "/runs/9", "/runs/9/phasors", "/identifications/9", "/alerts/9"]
    + [f"/{kind}/{2**62}" for kind in ("runs", "identifications", "alerts")]
    + ["/nothing", "/machines/pump-7/nothing"],
)
def test_what_is_not_there_is_a_404(told: Api, path: str) -> None:
    problem(told.get(path), 404)


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
def test_a_wrong_request_is_a_422_that_names_the_parameter(told: Api, path: str, field: str) -> None:
    assert fields(told.get(path)) == [field]


@pytest.mark.parametrize("path", ["runs", "identifications", "trends?parameter=bearing.B1.kxx"])
@pytest.mark.parametrize("limit", ["from=0001-01-01T00:00:00Z", "to=9999-12-31T23:59:59Z", "from=2400-01-01T00:00:00"])
def test_a_time_far_away_is_a_time_like_any_other(told: Api, path: str, limit: str) -> None:
    assert told.get(f"/machines/pump-7/{path}{'&' if '?' in path else '?'}{limit}").status_code == 200


def test_a_method_that_is_not_offered_is_a_405_with_those_that_are(told: Api) -> None:
    answer = told.ask("DELETE", f"{PREFIX}/machines/pump-7")
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
    problem(changing.get(f"/runs/{down['id']}/phasors"), 500)


# --- the document of the API ----------------------------------------------------------------------------------------


def test_documentation_needs_no_other_host(told: Api) -> None:
    answer = told.get("/docs")
    assert answer.status_code == 200
    assert re.findall(r"(?:https?:)?//[\w.-]+\.\w+[^\s\"']*", answer.text) == []
    own = re.findall(r"(?:src|href)=\"([^\"]+)\"", answer.text)
    assert own
    for address in own:
        assert told.ask("GET", address).status_code == 200, address


def operations(api: Api) -> list[tuple[str, str, dict[str, Any]]]:
    return [
        (method, path, operation)
        for path, item in api.value("/openapi.json")["paths"].items()
        for method, operation in item.items()
    ]


def test_operation_ids_are_unique_and_names(told: Api) -> None:
    ids = [operation["operationId"] for _, _, operation in operations(told)]
    assert len(ids) == len(set(ids))
    assert all(re.fullmatch(r"[a-z_]+", one) for one in ids)


def test_every_operation_says_what_it_does(told: Api) -> None:
    for method, path, operation in operations(told):
        assert operation["description"], (method, path)
        assert path.startswith(PREFIX) or path == "/metrics"
