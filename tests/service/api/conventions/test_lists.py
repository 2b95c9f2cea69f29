"""Lists in parts: each part once, whatever comes meanwhile; cursors and ranges that are none."""

from collections.abc import Iterator
from typing import Any

import pytest

from storage.alerts import deliveries
from storage.findings import jobs
from storage.machines import fleet, machines
from tests.api_in_process import Api, fields, value
from tests.plant import KEY, SECOND, START, identification, machine, store_identification
from tests.service.api.conventions.asked import ANNA, NOTE


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
            jobs.enqueue(session, KEY.machine, scope=jobs.GATHERED, run_ids=[number, 99])
    for word in ("one", "two"):
        api("POST", f"/machines/{KEY.machine}/timeline", 201, json=NOTE | {"text": word, "kind": "maintenance"})
        suppression = ANNA | {"kind": "out_of_service", "comment": word}
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
        (one,) = fleet.list_all(session)
    assert (one.id, one.name, one.plant) == (KEY.machine, "Pump 7", KEY.plant)
