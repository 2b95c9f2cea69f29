"""Machines and the documents that describe them: listed, created, revised, refused."""

import json
from datetime import datetime
from typing import Any

import pytest

from service.api.machines import routes
from storage.database.engine import Database
from storage.machines import machines
from tests.api_in_process import PREFIX, Api, fields, problem
from tests.plant import (
    document,
    machine,
)


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


def test_revisions_of_large_documents_come_in_parts(plant: Database, api: Api, monkeypatch: pytest.MonkeyPatch) -> None:
    """Sixty revisions of 0.8 MB took 7 s and 200 MB of memory, and there may be a thousand."""
    with plant.transaction() as session:
        for number in range(5):
            machines.revise(session, machine(name=f"Pump {number}"))
    monkeypatch.setattr(routes, "LARGEST_PAGE", int(2.5 * len(json.dumps(api.value("/machines/pump-7")["document"]))))
    path, found = f"{PREFIX}/machines/pump-7/revisions", list[int]()
    while path:
        answer = api.ask("GET", path)
        assert len(answer.json()) <= 3
        found += [one["revision"] for one in answer.json()]
        path = answer.headers.get("link", "").partition(">")[0].removeprefix("<")
    assert found == [1, 2, 3, 4, 5, 6]
    monkeypatch.setattr(routes, "LARGEST_PAGE", 1)
    assert len(api.value("/machines/pump-7/revisions")) == 1


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


@pytest.mark.parametrize("method", ["POST", "PUT"])
@pytest.mark.parametrize(
    ("path", "value", "field"),
    [
        ("element_length", 1e-5, "element_length"),
        ("shafts.0.sections", [{"length": 0.005, "outer_diameter": 0.02, "material": "steel"}] * 200, "shafts"),
    ],
)
def test_a_document_that_is_too_large_is_refused_with_the_field(
    api: Api, method: str, path: str, value: Any, field: str
) -> None:
    given = changed(path, value)
    given["shafts"] += [{"id": f"long-{number}", "sections": given["shafts"][0]["sections"]} for number in range(5)]
    where = f"{PREFIX}/machines" + ("/pump-7" if method == "PUT" else "")
    (error,) = problem(api.ask(method, where, json=given), 422)["errors"]
    assert error["field"] == field
    assert "at most" in error["message"]
    assert api.value("/machines/pump-7")["revision"] == 1


def test_a_document_that_was_stored_when_more_was_taken_is_read(api: Api, plant: Database) -> None:
    large = machine(id="fan-2", element_length=1e-3)
    with plant.transaction() as session:
        machines.create(session, large)
    assert api.value("/machines/fan-2")["document"]["element_length"] == 1e-3
    with plant.reading() as session:
        assert machines.document(session, "fan-2") == large


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


def test_pedestals_are_drawn_under_their_bearings(api: Api) -> None:
    said = document()
    made = {"id": "P3", "bearing": "B3", "kxx": 2e8, "kyy": 4e8, "cxx": 2e4, "cyy": 3e4, "mxx": 900.0, "myy": 900.0}
    api("POST", "/machines", 201, json=said | {"id": "pump-8", "pedestals": [made]})
    drawn = api.value("/machines/pump-8/drawing")
    under = {one["element"]: one["at"] for one in drawn["bearings"]}["bearing.B3"]
    assert drawn["pedestals"] == [{"element": "pedestal.P3", "shaft": "S2", "at": under}]
