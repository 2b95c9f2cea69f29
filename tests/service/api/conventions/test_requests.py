"""Tests what is asked for in a way that means nothing: methods, times, parameters, bodies; and what is too large."""

import base64
import json
import re
import zlib
from collections.abc import Iterator
from typing import Any

import pytest

from service.http.body_limit import LARGEST_BODY
from tests.api_in_process import PREFIX, Api, fields, problem
from tests.plant import KEY, document
from tests.service.api.conventions.asked import ALERT, NOTE, TIMELINE


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


def test_a_parameter_that_counts_once_is_given_once(api: Api) -> None:
    asked = 0
    for path, item in api.value("/openapi.json")["paths"].items():
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


def test_a_text_that_not_every_store_takes_is_refused_by_each(api: Api) -> None:
    machine = api.ask("POST", f"{PREFIX}/machines", json=document(id="fan-2", name="a\x00b"))
    assert [(one["field"], one["message"]) for one in problem(machine, 422)["errors"]] == [("name", "a text has no NUL in it")]
    hook = {"kind": "webhook", "name": "a", "target": "http://plant.example/\x00"}
    assert fields(api.ask("POST", f"{PREFIX}/subscriptions", json=hook)) == ["target"]
