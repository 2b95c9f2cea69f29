"""Asking once: what is asked again under a key is not done again."""

import contextlib
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from sqlalchemy import select, update
from sqlalchemy.exc import DBAPIError

from storage.operation import idempotency
from storage.tables.machines import TimelineRow
from storage.tables.operation import IdempotencyKeyRow
from tests.api_in_process import PREFIX, Api, fields, problem
from tests.failing_writes import refuse
from tests.plant import SECOND, document
from tests.service.api.conventions.asked import ALERT, ANNA, NOTE, TIMELINE, without_if_match


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
        broken.setattr("service.monitoring.baseline_changes.note", None)
        problem(api.ask("POST", TIMELINE, json=NOTE, headers=headers), 500)
    assert api.ask("POST", TIMELINE, json=NOTE, headers=headers).status_code == 201
