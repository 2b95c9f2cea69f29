"""Limits over HTTP: read, set by somebody for a reason, kept in versions, never overwritten unseen, wrong ones refused."""

import threading
from collections.abc import Iterator
from typing import Any

import httpx
import pytest

from benchmarks.serving import served
from service.monitoring.limits_in_force import limits_in_force
from service.monitoring.rules.limits import Limits
from storage.database.engine import Database

URL = "/machines/pump-7/limits"
PATIENT = {"misalignment": {"on_delay": 3, "danger": {"force": 900}}}


@pytest.fixture
def api(plant: Database) -> Iterator[httpx.Client]:
    """A client of a real server over the plant's database."""
    with served(plant) as url, httpx.Client(base_url=url, trust_env=False, timeout=10.0, headers={"if-match": "*"}) as client:
        yield client


def said(limits: Any, *, by: str = "anna") -> dict[str, Any]:
    return {"by": by, "comment": "after the overhaul", "limits": limits}


def problems(answer: httpx.Response, status: int) -> list[str]:
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    return [f"{one['field']}: {one['message']}" for one in answer.json()["errors"]]


def test_limits_are_the_defaults_until_somebody_sets_others(plant: Database, api: httpx.Client) -> None:
    before = api.get(URL)
    assert before.headers["etag"] == '"0"'
    assert (before.json()["version"], before.json()["by"], before.json()["set_at"]) == (0, None, None)
    assert Limits.model_validate(before.json()["limits"]) == Limits()
    answer = api.put(URL, json=said(PATIENT), headers={"If-Match": '"0"'})
    assert (answer.status_code, answer.headers["etag"]) == (200, '"1"')
    after = api.get(URL).json()
    assert after == answer.json()
    assert (after["version"], after["by"], after["comment"]) == (1, "anna", "after the overhaul")
    assert after["limits"]["misalignment"]["on_delay"] == 3
    assert after["limits"]["misalignment"]["alert"] == {"sigma": 3, "per_cent": 3, "tolerance_per_cent": 25} | dict.fromkeys(
        ("force", "rate_per_cent_per_week", "beyond_tolerance")
    )
    with plant.reading() as session:
        assert limits_in_force(session, "pump-7") == Limits.model_validate(PATIENT)


def test_older_limits_stay_readable(api: httpx.Client) -> None:
    api.put(URL, json=said(PATIENT)).raise_for_status()
    api.put(URL, json=said({}, by="ben")).raise_for_status()
    found = api.get(f"{URL}/versions").json()
    assert [(one["version"], one["by"], one["limits"]["misalignment"]["on_delay"]) for one in found] == [
        (2, "ben", 2),
        (1, "anna", 3),
    ]
    assert len(api.get(f"{URL}/versions", params={"limit": 1}).json()) == 1


def test_limits_that_somebody_else_has_changed_are_not_overwritten(api: httpx.Client) -> None:
    api.put(URL, json=said(PATIENT)).raise_for_status()
    stale = api.put(URL, json=said({}), headers={"If-Match": '"0"'})
    assert problems(stale, 412) == []
    assert "version 1 of the limits is in force, not 0" in stale.json()["detail"]
    for wrong in ("1", 'W/"1"', '"one"', '"1", "2"'):
        problems(api.put(URL, json=said({}), headers={"If-Match": wrong}), 412)
    assert api.get(URL).json()["version"] == 1
    assert api.put(URL, json=said({}), headers={"If-Match": "*"}).json()["version"] == 2


def test_of_two_who_set_limits_at_once_one_learns_of_the_other(api: httpx.Client) -> None:
    codes: list[int] = []

    def set_by(name: str) -> None:
        codes.append(api.put(URL, json=said(PATIENT, by=name), headers={"If-Match": '"0"'}).status_code)

    people = [threading.Thread(target=set_by, args=(name,)) for name in ("anna", "ben")]
    for one in people:
        one.start()
    for one in people:
        one.join()
    assert sorted(codes) == [200, 412]
    assert len(api.get(f"{URL}/versions").json()) == 1


@pytest.mark.parametrize(
    ("limits", "message"),
    [
        (
            {"bearing": {"alert": {"per_cent": 9}, "danger": {"per_cent": 8}}},
            "limits.bearing: danger.per_cent 8 lies below alert.per_cent 9: it must lie above",
        ),
        ({"bearing": {"alert": {"per_cent": 0}}}, "limits.bearing.alert.per_cent: 0 %: should be greater than 0"),
        ({"bearing": {"hysteresis": 1}}, "limits.bearing.hysteresis: Input should be less than or equal to 0.9"),
        ({"bearing": {"on_delay": 0}}, "limits.bearing.on_delay: Input should be greater than or equal to 1"),
        (
            {"bearing": {"hysteresys": 0.1}},
            "limits.bearing.hysteresys: there is no such field; did you mean 'hysteresis'?",
        ),
    ],
)
def test_limits_that_contradict_each_other_are_refused_by_field(
    api: httpx.Client, limits: dict[str, Any], message: str
) -> None:
    assert problems(api.put(URL, json=said(limits)), 422) == [message]
    assert api.get(URL).json()["version"] == 0


def test_limits_of_an_element_that_the_machine_has_not_are_refused(api: httpx.Client) -> None:
    wrong = {"elements": {"bearing.B9": {"bearing": {"alert": {"sigma": 4}}}}}
    (message,) = problems(api.put(URL, json=said(wrong)), 422)
    assert message.startswith("limits.elements.bearing.B9: 'bearing.B9' is not an element of machine 'pump-7': bearing.B1, ")


def test_who_and_why_are_needed_and_the_machine_must_be_known(api: httpx.Client) -> None:
    assert problems(api.put(URL, json={"limits": {}}), 422) == ["by: Field required", "comment: Field required"]
    assert problems(api.put(URL, json=said({}) | {"comment": ""}), 422)
    for answer in (
        api.get("/machines/nobody/limits"),
        api.get("/machines/nobody/limits/versions"),
        api.put("/machines/nobody/limits", json=said({})),
    ):
        assert problems(answer, 404) == []
