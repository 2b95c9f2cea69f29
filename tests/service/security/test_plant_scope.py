"""Tests what a principal of one plant gets beyond what paths and queries name: bodies, streams, side effects, deletions."""

import asyncio
import re
from typing import Any

import pytest
from sqlalchemy import func, select, text

from service.alerts.transitions import AlertFinding, raise_alert
from service.api.alerts.event_stream import stream
from service.delivery.signing import new_secret
from service.security.principal import Principal
from service.security.role import Role
from storage.alerts import deliveries
from storage.database.engine import Database
from storage.database.plant_scope import PlantScope, UnscopedStatement
from storage.findings import jobs
from storage.machines import machines
from storage.measurements import quarantine
from storage.tables.alerting import AlertEventRow, DeliveryRow, SubscriptionRow
from storage.tables.base import Base
from storage.tables.machines import MachineRow
from storage.tables.measurements import QuarantineRow
from tests.api_in_process import PREFIX, Api, problem, value
from tests.plant import KEY, START, document
from tests.service.security.conftest import Filled, bearer
from tests.service.security.two_plants import HIDDEN, HIDDEN_PLANT, leaks

WHOLE = {
    "api_keys", "browser_sessions", "audit", "audit_head", "quarantine_counts", "idempotency_keys",
    "replicas", "leases", "change_counts",
}  # fmt: skip
"""Tables whose rows belong to no plant: nobody of one plant sees them."""
ANY_TAG = {"If-Match": "*"}


def test_every_table_has_its_rule(store: Database) -> None:
    """Of a table without a rule there is nothing to be seen."""
    scope = PlantScope(store, frozenset({KEY.plant}))
    with scope.reading() as session, store.reading() as whole:
        for mapper in Base.registry.mappers:
            rows, seen = (one.scalar(select(func.count()).select_from(mapper.class_)) for one in (whole, session))
            table = mapper.class_.__tablename__
            if table in WHOLE:
                assert seen == 0, table
            elif rows:
                assert 0 < (seen or 0) < rows, table


def test_what_is_not_about_mapped_classes_is_refused(store: Database) -> None:
    with PlantScope(store, frozenset({KEY.plant})).reading() as session:
        for statement in (text("SELECT * FROM machines"), select(MachineRow.__table__.c.id)):
            with pytest.raises(UnscopedStatement):
                session.execute(statement)


def test_nothing_of_another_plant_can_be_named_in_a_body(api: Api, filled: Filled) -> None:
    headers = bearer(filled.keys["own"]) | ANY_TAG
    own = f"{PREFIX}/machines/{KEY.machine}"
    said: dict[str, Any] = {"since": "2026-01-01T00:00:00Z", "reason": "why", "by": "x"}
    answer = api.ask(
        "POST", f"{own}/baselines", json=said | {"identifications": [filled.hidden.identification_id]}, headers=headers
    )
    assert answer.status_code in (404, 409), answer.text
    assert not leaks(answer.text)
    capture = {"band_rpm": [400, 800], "run": filled.hidden.run_id}
    assert not leaks(problem(api.ask("POST", f"{own}/slow-roll", json=capture, headers=headers), 404)["detail"])


@pytest.mark.parametrize("place", ["machines/%00", "machines/a%0Ab", "alerts/" + "9" * 5000, "runs/" + "9" * 19])
def test_what_can_be_nothings_name_is_refused_as_for_everybody(api: Api, filled: Filled, place: str) -> None:
    everybody, own = (api.ask("GET", f"{PREFIX}/{place}", headers=bearer(filled.keys[key])) for key in ("admin", "own"))
    assert (everybody.status_code, own.status_code) == (422, 422)
    assert own.json()["errors"] == everybody.json()["errors"]


def test_a_machine_is_made_only_in_ones_own_plants(api: Api, filled: Filled) -> None:
    headers = bearer(filled.keys["own"])
    refused = api.ask("POST", f"{PREFIX}/machines", json=document(id="fan-3", plant=HIDDEN_PLANT), headers=headers)
    assert KEY.plant not in problem(refused, 403)["detail"]
    taken = api.ask("POST", f"{PREFIX}/machines", json=document(id=HIDDEN), headers=headers)
    assert not leaks(problem(taken, 409)["detail"].replace(HIDDEN, "…"))
    value(api.ask("POST", f"{PREFIX}/machines", json=document(id="fan-3"), headers=headers), 201)
    with api.database.reading() as session:
        assert machines.get(session, "fan-3").plant == KEY.plant


def test_the_list_of_machines_that_is_kept_is_each_ones_own(api: Api, filled: Filled) -> None:
    """Kept in memory: asked by one, it must not be given to another."""
    for _ in range(2):
        for key, expected in (("admin", {KEY.machine, HIDDEN}), ("own", {KEY.machine}), ("hidden", {HIDDEN})):
            headers = bearer(filled.keys[key])
            machines = value(api.ask("GET", PREFIX + "/machines", headers=headers))
            assert {one["id"] for one in machines} == expected
            fleet = value(api.ask("GET", PREFIX + "/fleet", headers=headers))
            assert {one["id"] for one in fleet["machines"]} == expected


def test_answers_that_are_kept_are_not_given_to_another_plant(api: Api, filled: Filled) -> None:
    ids = filled.hidden
    for path in (
        f"/identifications/{ids.identification_id}/bode",
        f"/identifications/{ids.identification_id}/model/critical-speeds",
        f"/machines/{HIDDEN}/trends?parameter=coupling.C1.kxx",
    ):
        assert api.ask("GET", PREFIX + path, headers=bearer(filled.keys["admin"])).status_code in (200, 409), path
        problem(api.ask("GET", PREFIX + path, headers=bearer(filled.keys["own"])), 404)


def test_a_purge_leaves_the_other_plants_entries(api: Api, filled: Filled) -> None:
    value(api.ask("DELETE", f"{PREFIX}/quarantine", headers=bearer(filled.keys["own"])))
    with api.database.reading() as session:
        left = session.scalars(select(QuarantineRow.machine_id)).all()
        assert left == [HIDDEN]
        assert quarantine.counts(session) == {"undecodable": 2}


def test_what_one_plant_does_is_reported_to_subscriptions_that_it_does_not_see(api: Api, filled: Filled) -> None:
    with api.database.transaction() as session:
        central = deliveries.subscribe(session, kind="zenoh", name="centre", target="", secret=None).id
    said = {"by": "anna", "comment": ""}
    path = f"{PREFIX}/alerts/{filled.own.alert_id}/acknowledge"
    value(api.ask("POST", path, json=said, headers=bearer(filled.keys["own"]) | ANY_TAG))
    with api.database.reading() as session:
        newest = session.scalar(select(func.max(AlertEventRow.id)))
        told = session.scalars(select(DeliveryRow.subscription_id).where(DeliveryRow.event_id == newest)).all()
        assert sorted(told) == sorted([central, filled.own.subscription_id])


def test_a_subscription_of_one_plant_tells_of_that_plant(api: Api, filled: Filled) -> None:
    headers = bearer(filled.keys["own"])
    said = {"kind": "zenoh", "name": "mine"}
    assert value(api.ask("POST", f"{PREFIX}/subscriptions", json=said, headers=headers), 201)["plants"] == [KEY.plant]
    wide = said | {"name": "wide", "plants": [KEY.plant, HIDDEN_PLANT]}
    problem(api.ask("POST", f"{PREFIX}/subscriptions", json=wide, headers=headers), 403)
    both = value(api.ask("POST", f"{PREFIX}/subscriptions", json=wide, headers=bearer(filled.keys["admin"])), 201)
    problem(api.ask("GET", f"{PREFIX}/subscriptions/{both['id']}", headers=headers), 404)
    taken = api.ask("POST", f"{PREFIX}/subscriptions", json={"kind": "zenoh", "name": "wide"}, headers=headers)
    problem(taken, 409)
    with api.database.transaction() as session:
        finding = AlertFinding({}, filled.hidden.identification_id, START)
        event = raise_alert(session, HIDDEN, rule="unbalance", element="disc.D1", finding=finding).id
        session.flush()
        names = session.scalars(select(SubscriptionRow.name).join(DeliveryRow).where(DeliveryRow.alert_id == event)).all()
    assert sorted(names) == ["orchard network", "wide"]


def test_who_has_some_plants_cannot_have_something_signed_with_a_secret_that_they_name(
    api: Api, filled: Filled, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It may be that of another plant's receiver, to whom they could then send what was signed."""
    monkeypatch.setenv("RUNDOWN_WEBHOOK_SECRET_CENTRE", new_secret())
    said = {"kind": "webhook", "name": "x", "target": "https://x.example/", "secret_env": "RUNDOWN_WEBHOOK_SECRET_CENTRE"}
    told = problem(api.ask("POST", f"{PREFIX}/subscriptions", json=said, headers=bearer(filled.keys["own"])), 403)
    assert "all plants" in told["detail"]
    made = api.ask("POST", f"{PREFIX}/subscriptions", json=said, headers=bearer(filled.keys["admin"]))
    assert made.json()["secret"] is None


def test_the_event_stream_tells_of_ones_own_plants_and_ends_with_the_key(api: Api, filled: Filled) -> None:
    broadcaster, visibility = api.app.state.broadcaster, api.app.state.visibility
    who = Principal("own", Role.VIEWER, frozenset({KEY.plant}), "key", "key x")
    good = [True]

    async def still() -> bool:
        return good[0]

    async def read() -> list[str]:
        found = []
        events = stream(broadcaster, 0, sees=lambda event: visibility.sees(who, event.machine), still_valid=still)
        async for part in events:
            if part.startswith(b"id:"):
                found.append(part.decode())
            if len(found) == 1 and good[0]:
                good[0] = False  # the key is revoked; whatever comes next ends it
                with api.database.transaction() as session:
                    finding = AlertFinding({}, filled.own.identification_id, START)
                    raise_alert(session, KEY.machine, rule="unbalance", element="disc.D1", finding=finding)
        return found

    found = asyncio.run(asyncio.wait_for(read(), 10.0))
    assert len(found) == 1
    assert KEY.machine in found[0]
    assert not leaks("".join(found))


def test_samples_for_another_plants_machine_are_refused_like_those_for_none(api: Api, filled: Filled) -> None:
    headers = bearer(filled.keys["own"]) | {"Content-Type": "application/json"}
    answers = [
        problem(api.ask("POST", f"{PREFIX}/machines/{name}/samples", content=b"{}", headers=headers), 404)["detail"]
        for name in (HIDDEN, "nothing-1")
    ]
    assert answers == [f"no machine {HIDDEN}", "no machine nothing-1"]


def test_a_misspelt_machine_gets_those_like_it_which_the_client_may_list(api: Api, filled: Filled) -> None:
    def told(key: str, name: str) -> str:
        return str(problem(api.ask("GET", f"{PREFIX}/machines/{name}", headers=bearer(filled.keys[key])), 404)["detail"])

    for key in ("viewer", "admin", "own"):
        assert told(key, KEY.machine[:-1]) == f"no machine {KEY.machine[:-1]}; did you mean '{KEY.machine}'?"
    assert told("viewer", HIDDEN[:-1]) == f"no machine {HIDDEN[:-1]}; did you mean '{HIDDEN}'?"
    for key in ("own", "hidden"):
        other = HIDDEN if key == "own" else KEY.machine
        assert told(key, other[:-1]) == f"no machine {other[:-1]}"
    assert told("viewer", "wholly-other") == "no machine wholly-other: GET /api/v1/machines lists those there are"


def test_a_source_which_may_not_list_machines_is_told_no_names(api: Api, filled: Filled) -> None:
    headers = bearer(filled.keys["source"]) | {"Content-Type": "application/json"}
    path = f"{PREFIX}/machines/{KEY.machine[:-1]}/samples"
    assert KEY.machine not in api.ask("POST", path, content=b"{}", headers=headers).text


def test_health_tells_the_unknown_no_more_than_that(api: Api, filled: Filled) -> None:
    api.parts["ingest"] = "machine quince-9 is broken"
    unknown = api.ask("GET", f"{PREFIX}/health")
    assert not leaks(unknown.text)
    assert unknown.json() == {
        "healthy": False,
        "ready": False,
        "version": "",
        "parts": {"ingest": "not ok", "identifying": "ok", "stream": "ok", "database": "ok"},
        "jobs": {},
        "database": "",
        "warnings": [],
    }
    assert "quince" in api.ask("GET", f"{PREFIX}/health", headers=bearer(filled.keys["viewer"])).text
    assert not leaks(api.ask("GET", f"{PREFIX}/health", headers=bearer(filled.keys["own"])).text)


def test_the_metrics_count_ones_own_plants_only(api: Api, filled: Filled) -> None:
    """Also what is counted without naming a machine."""
    with api.database.transaction() as session:
        failed = jobs.enqueue(session, HIDDEN, scope=jobs.VARIANT, run_ids=[filled.hidden.run_id], options={"starts": 3})
        assert failed is not None
        jobs.finish(failed, state=jobs.FAILED, error="NotEnoughData: too few")

    def counts(key: str) -> dict[str, float]:
        told = api.ask("GET", "/metrics", headers=bearer(filled.keys[key])).text
        assert key != "own" or not leaks(told)
        line = r"^rundown_(identification_jobs|deliveries|rejected)\S*?\{\w+=\"(\w+)\"\} (\S+)$"
        lines = re.findall(line, told, re.MULTILINE)
        return {f"{name} {label}": float(value) for name, label, value in lines if float(value)}

    own = counts("own")
    assert "identification_jobs failed" not in own
    assert (own["identification_jobs done"], counts("hidden")["identification_jobs failed"]) == (6, 1)
    assert (counts("admin")["identification_jobs done"], counts("admin")["identification_jobs failed"]) == (12, 1)
    assert own["deliveries pending"] == counts("hidden")["deliveries pending"] == counts("admin")["deliveries pending"] / 2
    assert "rejected undecodable" not in own
