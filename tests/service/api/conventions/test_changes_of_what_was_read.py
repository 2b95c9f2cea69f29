"""Changing what one has read: ETags, If-Match, If-None-Match."""

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

from tests.api_in_process import PREFIX, Api, problem
from tests.plant import KEY, document
from tests.service.api.conventions.asked import ALERT, ANNA, IN_FORCE, TOMORROW, without_if_match

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
