"""What holds for all of the API: lists in parts, changes of what was read, keys for asking once, sizes, stages, its file."""

import base64
import contextlib
import json
import re
import zlib
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import select, update
from sqlalchemy.exc import DBAPIError

from service import alerting
from service.alerting import Finding
from service.api import openapi
from service.api.body_size import LARGEST_BODY
from service.api.patterns import WORDS
from storage import deliveries, fleet, idempotency, jobs, machines, suppressions
from storage.database import Database
from storage.tables import IdempotencyKeyRow, TimelineRow
from tests.asking import PREFIX, Api, fields, problem, value
from tests.plant import KEY, SECOND, START, document, identification, machine, store_identification
from tests.refusing import refuse

ROOT = Path(__file__).parents[2]
NOTE = {"at": "2026-01-01T00:00:00Z", "text": "looked", "by": "anna"}
TIMELINE = f"{PREFIX}/machines/{KEY.machine}/timeline"
ALERT = f"{PREFIX}/alerts/1"
ANNA = {"by": "anna"}
TOMORROW = (datetime.now(UTC) + timedelta(days=1)).isoformat()
IN_FORCE = f"{PREFIX}/machines/{KEY.machine}/slow-roll/in-force"


@pytest.fixture
def api(plant: Database) -> Api:
    """Over a machine with identifications, of which one raised an alert, and a subscription."""
    with plant.transaction() as session:
        for number in range(7):
            row = store_identification(session, identification(), run_id=number, measured_at=START + number * SECOND)
        finding = Finding("it moves", {}, row.id, START)
        alerting.raise_alert(session, KEY.machine, rule="misalignment", element="coupling.C1", finding=finding)
        deliveries.subscribe(session, kind="zenoh", name="plant", target="", secret=None)
        asleep = {"kind": "out_of_service", "rule": "misfit", "element": None, "until": None, "by": "anna", "comment": ""}
        suppressions.add(session, KEY.machine, **asleep)
    return Api(plant)


def without_if_match(api: Api) -> Api:
    del api.http.headers["if-match"]
    return api


# --- lists in parts -------------------------------------------------------------------------------------------------


def parts(api: Api, path: str, **asked: Any) -> Iterator[list[Any]]:
    """Every part of a list, by following the Link header."""
    answer = api.get(path, **asked)
    while True:
        yield value(answer)
        following = answer.links.get("next")
        if following is None:
            return
        answer = api.ask("GET", following["url"])


@pytest.mark.parametrize("limit", [1, 2, 7, 8])
def test_a_list_in_parts_is_the_whole_list(api: Api, limit: int) -> None:
    path = f"/machines/{KEY.machine}/identifications"
    whole = api.value(path)
    assert len(whole) == 7
    found = list(parts(api, path, limit=limit))
    assert [one for part in found for one in part] == whole
    assert {len(part) for part in found[:-1]} <= {limit}
    assert found[-1]


def test_what_is_added_meanwhile_is_not_shown_twice(api: Api) -> None:
    path = f"/machines/{KEY.machine}/identifications"
    whole = [one["id"] for one in api.value(path)]
    walk = parts(api, path, limit=3)
    first = next(walk)
    with api.database.transaction() as session:
        store_identification(session, identification(), run_id=90, measured_at=START + 90 * SECOND)
    rest = [one["id"] for part in walk for one in part]
    assert [one["id"] for one in first] + rest == whole


def test_every_list_goes_on(api: Api) -> None:
    """Each list of the API with two rows or more, in parts of one."""
    with api.database.transaction() as session:
        machines.create(session, machine(id="fan-2"))
        machines.revise(session, machine(name="New"))
        deliveries.subscribe(session, kind="email", name="shift", target="smtp://h/a@b.c/d@e.f", secret=None)
        for number in (1, 2):
            jobs.ask(session, KEY.machine, scope=jobs.GATHERED, run_ids=[number, 99])
    for word in ("one", "two"):
        api("POST", f"/machines/{KEY.machine}/timeline", 201, json=NOTE | {"text": word, "kind": "maintenance"})
        suppression = ANNA | {"kind": "out_of_service", "rule": word}
        api("POST", f"/machines/{KEY.machine}/suppressions", 201, json=suppression)
        api("POST", "/alerts/1/comments", json=ANNA | {"comment": word})
    of_machine = ("revisions", "identifications", "jobs", "timeline", "suppressions", "baselines")
    for path in (
        "/machines",
        "/subscriptions",
        "/alert-events",
        "/alerts/1/events",
        *(f"/machines/{KEY.machine}/{name}" for name in of_machine),
    ):
        found = [one for part in parts(api, path, limit=1) for one in part]
        assert len(found) >= 2, path
        assert found == api.value(path), path
    pieces = [one["id"] for part in parts(api, "/fleet", limit=1) for one in part["machines"]]  # type: ignore[call-overload]
    assert pieces == ["fan-2", KEY.machine]


@pytest.mark.parametrize(
    "cursor", ["x", "!!!!", "W10", "WyJpaSIsIDEsICJ4Il0", "WyJpaSIsIDFd", "A" * 201, "WyJpaSIsIHRydWUsIDFd"]
)
def test_a_cursor_that_is_none_of_this_list_is_refused(api: Api, cursor: str) -> None:
    assert fields(api.get("/alerts", cursor=cursor)) == ["query.cursor"]


def test_a_cursor_of_another_list_is_refused(api: Api) -> None:
    link = api.get(f"/machines/{KEY.machine}/identifications", limit=1).links["next"]["url"]
    cursor = link.split("cursor=")[1].split("&")[0]
    for other in (
        "/machines",
        f"/machines/{KEY.machine}/runs",
        f"/machines/{KEY.machine}/timeline",
        "/machines/fan-2/identifications",
    ):
        assert fields(api.get(other, cursor=cursor)) == ["query.cursor"], other


@pytest.mark.parametrize("path", ["runs", "identifications", "samples", "states", "timeline", "trends"])
def test_a_range_whose_ends_are_exchanged_is_refused(api: Api, path: str) -> None:
    asked = {"from": "2026-02-01T00:00:00Z", "to": "2026-01-01T00:00:00Z"}
    asked |= {"parameter": "x"} if path == "trends" else {}
    answer = api.get(f"/machines/{KEY.machine}/{path}", **asked)
    assert fields(answer) == ["query.from"]
    assert "exchange" in answer.json()["errors"][0]["message"]


def test_machines_are_listed_without_reading_their_documents(api: Api) -> None:
    with api.database.reading() as session:
        (one,) = fleet.every(session)
    assert (one.id, one.name, one.plant) == (KEY.machine, "Pump 7", KEY.plant)


def test_a_method_that_is_not_there_is_answered_with_those_that_are(api: Api) -> None:
    one, all_of_them, change = f"/machines/{KEY.machine}", "/machines", "/alerts/1/reset"
    for path, known in ((one, "GET, HEAD, PUT"), (all_of_them, "GET, HEAD, POST"), (change, "POST")):
        answer = api.ask("PATCH", PREFIX + path)
        assert known in problem(answer, 405)["detail"]
        assert answer.headers["allow"] == known


@pytest.mark.parametrize("moment", ["0.5", "1700000000", "2026-01-01", "yesterday"])
def test_a_time_is_written_as_one(api: Api, moment: str) -> None:
    assert fields(api.get("/fleet", since=moment)) == ["query.since"]
    assert fields(api.ask("POST", TIMELINE, json=NOTE | {"at": moment})) == ["at"]
    assert fields(api.ask("POST", TIMELINE, json=NOTE | {"at": 1_700_000_000})) == ["at"]


# --- changing what was read -----------------------------------------------------------------------------------------

CHANGES = [
    ("POST", ALERT, f"{ALERT}/acknowledge", ANNA),
    ("POST", ALERT, f"{ALERT}/shelve", ANNA | {"until": TOMORROW}),
    ("PUT", f"{PREFIX}/machines/{KEY.machine}", f"{PREFIX}/machines/{KEY.machine}", document(name="New")),
    ("POST", f"{PREFIX}/subscriptions/1", f"{PREFIX}/subscriptions/1/disable", None),
    ("POST", f"{PREFIX}/suppressions/1", f"{PREFIX}/suppressions/1/end", ANNA),
    ("PUT", IN_FORCE, IN_FORCE, {"version": None}),
]


@pytest.mark.parametrize(("method", "read", "path", "body"), CHANGES)
def test_a_change_says_what_it_changes(api: Api, method: str, read: str, path: str, body: Any) -> None:
    without_if_match(api)
    before = api.ask("GET", read)
    tag = before.headers["etag"]
    assert tag.startswith('"')
    assert "If-Match" in problem(api.ask(method, path, json=body), 428)["detail"]
    for wrong in ('"0123"', f"W/{tag}", tag.strip('"'), ""):
        assert "read it again" in problem(api.ask(method, path, json=body, headers={"if-match": wrong}), 412)["detail"]
    assert api.ask("GET", read).json() == before.json()


def test_an_alert_is_acknowledged_as_it_was_read(api: Api) -> None:
    without_if_match(api)
    tag = api.ask("GET", ALERT).headers["etag"]
    answer = api.ask("POST", f"{ALERT}/acknowledge", json=ANNA, headers={"if-match": f'"other", {tag}'})
    assert answer.json()["state"] == "acknowledged"
    assert answer.headers["etag"] == api.ask("GET", ALERT).headers["etag"] != tag


def test_of_two_people_who_read_the_same_only_one_decides(api: Api) -> None:
    without_if_match(api)
    tag = api.ask("GET", ALERT).headers["etag"]

    def decide(name: str) -> int:
        return api.ask("POST", f"{ALERT}/acknowledge", json={"by": name}, headers={"if-match": tag}).status_code

    with ThreadPoolExecutor(2) as people:
        asked = [people.submit(decide, name) for name in ("anna", "ben")]
        assert sorted(one.result() for one in asked) == [200, 412]


def test_a_machine_is_revised_as_it_was_read(api: Api) -> None:
    without_if_match(api)
    path = f"{PREFIX}/machines/{KEY.machine}"
    tag = api.ask("GET", path).headers["etag"]
    first = api.ask("PUT", path, json=document(name="One"), headers={"if-match": tag})
    assert first.json()["revision"] == 2
    problem(api.ask("PUT", path, json=document(name="Two"), headers={"if-match": tag}), 412)
    again = api.ask("PUT", path, json=document(name="Two"), headers={"if-match": first.headers["etag"]})
    assert again.json()["revision"] == 3


def test_who_has_an_answer_already_is_told_so(api: Api) -> None:
    for path in (ALERT, f"{PREFIX}/machines/{KEY.machine}", f"{PREFIX}/machines/{KEY.machine}/limits"):
        whole = api.ask("GET", path)
        tag = whole.headers["etag"]
        for known in (tag, f"W/{tag}", f'"other", {tag}', "*"):
            again = api.ask("GET", path, headers={"if-none-match": known})
            assert (again.status_code, again.content, again.headers["etag"]) == (304, b"", tag)
            assert api.ask("HEAD", path, headers={"if-none-match": known}).status_code == 304
        assert api.ask("GET", path, headers={"if-none-match": '"other"'}).content == whole.content
    unchanged = api.ask("GET", ALERT).headers["etag"]
    api.ask("POST", f"{ALERT}/acknowledge", json=ANNA)
    assert api.ask("GET", ALERT, headers={"if-none-match": unchanged}).status_code == 200


# --- what is asked for in vain --------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", ["/machines", f"/machines/{KEY.machine}", "/alerts/1/events", "/sources", "/health"])
def test_a_parameter_that_nobody_knows_is_refused(api: Api, path: str) -> None:
    answer = api.get(path, nonsense="1")
    assert fields(answer) == ["query.nonsense"]
    assert "knows no such parameter" in answer.json()["errors"][0]["message"]


def test_what_no_store_could_look_for_is_refused(api: Api) -> None:
    assert fields(api.ask("GET", f"{PREFIX}/quarantine?machine=%00")) == ["query.machine"]
    which = zlib.crc32(f"{PREFIX}/sources".encode())
    for text in ("a\ud800", "a\x00", "a\n"):
        cursor = base64.urlsafe_b64encode(json.dumps([which, text, "b", 1]).encode()).decode().rstrip("=")
        assert fields(api.get("/sources", cursor=cursor)) == ["query.cursor"]


@pytest.mark.parametrize(
    ("path", "body", "field"),
    [
        (f"{ALERT}/acknowledge", {"by": "anna", "coment": "typo"}, "coment"),
        (f"{ALERT}/comments", {"by": "anna", "comment": "  "}, "comment"),
        (f"{ALERT}/shelve", {"by": "anna", "until": "2999-01-01T00:00:00Z"}, "until"),
        (TIMELINE, NOTE | {"note": "typo"}, "note"),
        (TIMELINE, NOTE | {"text": "\n"}, "text"),
        (f"{PREFIX}/subscriptions", {"kind": "zenoh", "name": "x", "secret": "mine"}, "secret"),
    ],
)
def test_what_would_be_dropped_without_a_word_is_refused(api: Api, path: str, body: dict[str, Any], field: str) -> None:
    assert fields(api.ask("POST", path, json=body)) == [field]


# --- asking once ----------------------------------------------------------------------------------------------------


def notes(api: Api) -> int:
    with api.database.reading() as session:
        return len(session.scalars(select(TimelineRow)).all())


def test_what_is_asked_twice_under_a_key_is_done_once(api: Api) -> None:
    headers = {"Idempotency-Key": "0b5c"}
    first = api.ask("POST", TIMELINE, json=NOTE, headers=headers)
    second = api.ask("POST", TIMELINE, json=NOTE, headers=headers)
    assert (first.status_code, second.status_code) == (201, 201)
    assert first.json() == second.json()
    assert "idempotency-replayed" not in first.headers
    assert second.headers["idempotency-replayed"] == "true"
    assert second.headers["content-type"] == first.headers["content-type"]
    assert notes(api) == 1
    api.ask("POST", TIMELINE, json=NOTE, headers={"Idempotency-Key": "another"})
    assert notes(api) == 2


def test_what_was_done_and_could_not_be_answered_is_not_done_again(api: Api) -> None:
    with api.database.transaction() as session:
        refuse(session, "idempotency_keys", write="UPDATE")
    headers = {"Idempotency-Key": "0b5c"}
    with contextlib.suppress(DBAPIError):  # over a network the answer breaks off
        api.ask("POST", TIMELINE, json=NOTE, headers=headers)
    assert notes(api) == 1
    again = problem(api.ask("POST", TIMELINE, json=NOTE, headers=headers), 409)
    assert "not known what became of it" in again["detail"]
    assert notes(api) == 1


def test_a_created_machine_is_answered_with_its_place_and_tag_again(api: Api) -> None:
    headers = {"Idempotency-Key": "fan"}
    answers = [api.ask("POST", f"{PREFIX}/machines", json=document(id="fan-2"), headers=headers) for _ in range(2)]
    assert [one.status_code for one in answers] == [201, 201]
    assert answers[0].headers["location"] == answers[1].headers["location"]
    assert answers[0].headers["etag"] == answers[1].headers["etag"]


@pytest.mark.parametrize(("path", "body"), [(TIMELINE, NOTE | {"text": "other"}), (f"{ALERT}/acknowledge", ANNA)])
def test_a_key_is_of_one_request(api: Api, path: str, body: Any) -> None:
    headers = {"Idempotency-Key": "0b5c"}
    api.ask("POST", TIMELINE, json=NOTE, headers=headers)
    assert "another request" in problem(api.ask("POST", path, json=body, headers=headers), 422)["detail"]
    assert notes(api) == 1


def test_a_refusal_is_kept_too_and_a_mistake_may_be_mended(api: Api) -> None:
    headers = {"Idempotency-Key": "reset"}
    for _ in range(2):  # an alert that is not latched cannot be reset
        answer = api.ask("POST", f"{ALERT}/reset", json=ANNA, headers=headers)
        problem(answer, 409)
    assert answer.headers["idempotency-replayed"] == "true"
    mended = {"Idempotency-Key": "mended"}
    assert fields(api.ask("POST", TIMELINE, json={"text": "x"}, headers=mended))
    assert api.ask("POST", TIMELINE, json=NOTE, headers=mended).status_code == 201


def test_a_key_stays_good_after_a_refusal_that_can_be_mended(api: Api) -> None:
    without_if_match(api)
    headers = {"Idempotency-Key": "0b5c"}
    path = f"{PREFIX}/machines/fan-2/timeline"
    problem(api.ask("POST", path, json=NOTE, headers=headers), 404)
    api.ask("POST", f"{PREFIX}/machines", json=document(id="fan-2"))
    assert api.ask("POST", path, json=NOTE, headers=headers).status_code == 201
    headers = {"Idempotency-Key": "seen"}
    problem(api.ask("POST", f"{ALERT}/acknowledge", json=ANNA, headers=headers | {"if-match": '"old"'}), 412)
    tag = api.ask("GET", ALERT).headers["etag"]
    answer = api.ask("POST", f"{ALERT}/acknowledge", json=ANNA, headers=headers | {"if-match": tag})
    assert answer.json()["state"] == "acknowledged"


def test_a_key_under_way_is_a_conflict(api: Api) -> None:
    with api.database.transaction() as session:
        idempotency.claim(session, "0b5c", "of something else")
    answer = api.ask("POST", TIMELINE, json=NOTE, headers={"Idempotency-Key": "0b5c"})
    problem(answer, 422)
    api.ask("POST", TIMELINE, json=NOTE, headers={"Idempotency-Key": "killed"})
    with api.database.transaction() as session:  # as a kill in the middle leaves it
        session.execute(update(IdempotencyKeyRow).where(IdempotencyKeyRow.key == "killed").values(status=None))
    answer = api.ask("POST", TIMELINE, json=NOTE, headers={"Idempotency-Key": "killed"})
    assert "under way" in problem(answer, 409)["detail"]
    assert answer.headers["retry-after"] == "1"


def test_at_once_under_one_key_is_done_once(api: Api) -> None:
    def ask(_: int) -> int:
        return api.ask("POST", TIMELINE, json=NOTE, headers={"Idempotency-Key": "0b5c"}).status_code

    with ThreadPoolExecutor(4) as crowd:
        found = list(crowd.map(ask, range(8)))
    assert set(found) <= {201, 409}
    assert 201 in found
    assert notes(api) == 1


def test_a_key_is_forgotten_after_a_day(api: Api) -> None:
    headers = {"Idempotency-Key": "0b5c"}
    api.ask("POST", TIMELINE, json=NOTE, headers=headers)
    with api.database.transaction() as session:
        session.execute(
            update(IdempotencyKeyRow).values(created_at=IdempotencyKeyRow.created_at - 24 * 3600 * SECOND - SECOND)
        )
    assert "idempotency-replayed" not in api.ask("POST", TIMELINE, json=NOTE, headers=headers).headers
    assert notes(api) == 2


@pytest.mark.parametrize("key", ["", " ", "a" * 256, "tab\there", "two words", b"\xe4"])
def test_a_key_that_is_none_is_refused(api: Api, key: str | bytes) -> None:
    name = b"Idempotency-Key" if isinstance(key, bytes) else "Idempotency-Key"
    problem(api.ask("POST", TIMELINE, json=NOTE, headers={name: key}), 400)


def test_an_error_inside_leaves_no_key(api: Api, monkeypatch: pytest.MonkeyPatch) -> None:
    headers = {"Idempotency-Key": "0b5c"}
    with monkeypatch.context() as broken:
        broken.setattr("service.baselining.note", None)
        problem(api.ask("POST", TIMELINE, json=NOTE, headers=headers), 500)
    assert api.ask("POST", TIMELINE, json=NOTE, headers=headers).status_code == 201


@pytest.mark.parametrize(
    ("path", "content", "field", "words"),
    [
        (f"{PREFIX}/machines", b'{"id": fan}', "body", "no JSON from character 7 on: Expecting value"),
        (f"{PREFIX}/machines", b"[]", "body", "Input should be"),
        (f"{PREFIX}/subscriptions", b'{"kind": "zenoh", "name": "a", "target": "x"}', "body", "target: zenoh needs none"),
        (TIMELINE, b'{"at": "2026-01-01T00:00:00", "by": "anna", "text": "x"}', "at", "a moment needs its zone"),
    ],
)
def test_what_is_wrong_with_a_body_is_said_in_words(api: Api, path: str, content: bytes, field: str, words: str) -> None:
    answer = api.ask("POST", path, content=content, headers={"content-type": "application/json"})
    (one,) = problem(answer, 422)["errors"]
    assert one["field"] == field
    assert one["message"].startswith(words)


# --- sizes ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("keyed", [False, True])
@pytest.mark.parametrize("announced", [False, True])
def test_a_body_may_not_be_endless(api: Api, announced: bool, keyed: bool) -> None:
    def pieces() -> Iterator[bytes]:
        for _ in range(LARGEST_BODY // 2**16 + 1):
            yield b" " * 2**16

    content = b" " * (LARGEST_BODY + 1) if announced else pieces()
    headers = {"content-type": "application/json"} | ({"Idempotency-Key": "large"} if keyed else {})
    answer = api.ask("POST", f"{PREFIX}/machines", content=content, headers=headers)
    assert str(LARGEST_BODY) in problem(answer, 413)["detail"]


# --- stages ---------------------------------------------------------------------------------------------------------


def stages(api: Api) -> dict[str, dict[str, Any]]:
    found = api.value("/health/stages")["stages"]
    assert [one["stage"] for one in found] == [
        "data_acquisition",
        "data_manipulation",
        "state_detection",
        "health_assessment",
        "prognostic_assessment",
        "advisory_generation",
    ]
    return {one["stage"]: one for one in found}


def test_each_stage_says_how_it_is_doing(api: Api) -> None:
    found = stages(api)
    assert found["data_acquisition"]["state"] == "idle"
    assert found["data_acquisition"]["figures"]["machines_now"] == 1
    assert (found["state_detection"]["state"], found["state_detection"]["figures"]) == (
        "ok",
        {"identifications": 7, "accepted": 7},
    )
    assert found["health_assessment"]["state"] == "idle"
    assert found["prognostic_assessment"]["state"] == "idle"
    assert found["advisory_generation"]["figures"]["open_alerts_now"] == 1
    api.parts["identifying"] = "its thread has ended"
    found = stages(api)
    for stage in ("data_manipulation", "state_detection", "health_assessment"):
        assert found[stage]["state"] == "failed"
        assert "its thread has ended" in found[stage]["words"]


def test_what_is_not_all_right_is_degraded(api: Api) -> None:
    with api.database.transaction() as session:
        store_identification(session, identification(accepted=False), run_id=77)
        job = jobs.ask(session, KEY.machine, scope=jobs.RUN, run_ids=[78])
        assert job is not None
        jobs.finish(job, state=jobs.FAILED, error="NotEnoughData")
        (delivery,) = deliveries.of_subscription(session, 1, limit=1) or [None]
        if delivery is not None:
            delivery.next_try_at = START
    api.parts["stream"] = "no router answers"
    found = stages(api)
    assert {name: one["state"] for name, one in found.items()} == {
        "data_acquisition": "degraded",
        "data_manipulation": "degraded",
        "state_detection": "degraded",
        "health_assessment": "idle",
        "prognostic_assessment": "idle",
        "advisory_generation": "ok" if delivery is None else "degraded",
    }


# --- the document of the API ----------------------------------------------------------------------------------------


OF_ITSELF = ("/health", "/ready", "/alive")
"""What the service says of itself is the answer also where it is not well."""


def test_every_error_is_described_as_a_problem(api: Api) -> None:
    described = api.value("/openapi.json")
    assert described["openapi"].startswith("3.1")
    assert not {"HTTPValidationError", "ValidationError"} & described["components"]["schemas"].keys()
    assert "HTTPValidationError" not in json.dumps(described)
    for path, item in described["paths"].items():
        for method, operation in item.items():
            for code, response in operation["responses"].items():
                if code == "default" or (int(code) >= 400 and not path.endswith(OF_ITSELF)):
                    assert list(response["content"]) == ["application/problem+json"], (method, path, code)
            if method == "post":
                assert "Idempotency-Key" in {one["name"] for one in operation["parameters"]}


def test_the_committed_document_is_that_of_the_application() -> None:
    """A change of the API is seen in review: `python -m service.api.openapi docs/openapi.json` renews the file."""
    committed = (ROOT / "docs" / "openapi.json").read_text(encoding="utf-8")
    assert committed == openapi.text(), "docs/openapi.json is not up to date: python -m service.api.openapi docs/openapi.json"


def test_every_pattern_is_said_in_words() -> None:
    document = json.loads((ROOT / "docs" / "openapi.json").read_text())
    assert set(patterns(document)) == set(WORDS)


def patterns(part: Any) -> Iterator[str]:
    """Every pattern of a document."""
    if isinstance(part, dict):
        if isinstance(part.get("pattern"), str):
            yield part["pattern"]
        part = list(part.values())
    for one in part if isinstance(part, list) else []:
        yield from patterns(one)


def test_a_text_of_another_pattern_is_refused_in_words(api: Api) -> None:
    answer = api.get(f"/machines/{KEY.machine}/trends", parameter="nope")
    (error,) = problem(answer, 422)["errors"]
    assert "such as bearing.B1.kxx" in error["message"]


def test_a_parameter_that_counts_once_is_given_once(api: Api) -> None:
    document = json.loads((ROOT / "docs" / "openapi.json").read_text())
    asked = 0
    for path, item in document["paths"].items():
        place = re.sub(r"\{\w+\}", "1", path.replace("{machine_id}", KEY.machine))
        for one in item.get("get", {}).get("parameters", []):
            if one["in"] == "query":
                answer = api.ask("GET", place, params=[(one["name"], "1"), (one["name"], "1")])
                wrong = answer.json()["errors"] if answer.status_code == 422 else []
                said = " ".join(error["message"] for error in wrong)
                several = "array" in json.dumps(one["schema"])
                assert ("given 2 times" in said) != several, (place, one["name"], said)
                asked += 1
    assert asked > 50
