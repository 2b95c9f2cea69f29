"""Tests what people and programs do to alerts over HTTP, and the stream of events, from a real server."""

import asyncio
import ipaddress
import json
import threading
import time
from collections.abc import Callable, Iterator
from datetime import UTC, datetime, timedelta
from typing import Any

import httpx
import pytest
from sqlalchemy import text

from benchmarks.serving import served
from service.alerts import transitions
from service.alerts.transitions import AlertFinding
from service.api.alerts import event_stream
from service.api.alerts.event_stream import Broadcaster, StreamEvent, stream
from storage.alerts import alerts
from storage.database.engine import Database
from storage.tables.alerting import AlertRow
from tests.api_in_process import Api, refused
from tests.plant import START, identification, store_identification, wait_until

ANNA = {"by": "anna", "comment": "looked at it"}


@pytest.fixture
def api(plant: Database) -> Iterator[httpx.Client]:
    """A client of a real server over the plant's database."""
    with served(plant) as url, httpx.Client(base_url=url, trust_env=False, timeout=10.0, headers={"if-match": "*"}) as client:
        yield client


def raised(database: Database, element: str = "coupling.C1", *, latching: bool = False) -> int:
    with database.transaction() as session:
        known = alerts.find(session, machine_id=None, only_open=False, limit=1)
        number = (
            known[0].identification_id
            if known
            else store_identification(session, identification(), run_id=1, measured_at=START).id
        )
        finding = AlertFinding({}, number, START, latching=latching)
        return transitions.raise_alert(session, "pump-7", rule="misalignment", element=element, finding=finding).id


def cleared(database: Database, alert: int) -> None:
    with database.transaction() as session:
        transitions.clear_alert(session, session.get_one(AlertRow, alert))


def soon(**ahead: float) -> str:
    return (datetime.now(UTC) + timedelta(**ahead)).isoformat()


def test_an_alert_is_acknowledged_and_its_history_says_by_whom(plant: Database, api: httpx.Client) -> None:
    alert = raised(plant)
    answer = api.post(f"/alerts/{alert}/acknowledge", json=ANNA)
    assert answer.status_code == 200
    assert (answer.json()["state"], answer.json()["events"]) == ("acknowledged", 2)
    events = api.get(f"/alerts/{alert}/events").json()
    assert [(one["kind"], one["by"], one["comment"]) for one in events] == [
        ("raised", "rundown", ""),
        ("acknowledged", "anna", "looked at it"),
    ]
    told = refused(api.post(f"/alerts/{alert}/acknowledge", json=ANNA | {"by": "ben"}), 409)
    assert ("acknowledged already" in told, "acknowledged by anna, 20" in told) == (True, True)
    cleared(plant, alert)
    assert "closed" in refused(api.post(f"/alerts/{alert}/acknowledge", json=ANNA), 409)
    assert api.get(f"/alerts/{alert}").json()["state"] == "normal"


def test_alerts_are_reported_in_the_language_of_who_asks(plant: Database, api: httpx.Client) -> None:
    alert = raised(plant)
    german = {"accept-language": "de-DE,de;q=0.9,en;q=0.5"}
    for path in ("/alerts", "/machines/pump-7/alerts"):
        for headers, language, said in (
            (german, "de", "Ausrichtfehler an Kupplung C1"),
            ({}, "en", "Misalignment of coupling C1"),
        ):
            answer = api.get(path, headers=headers)
            assert answer.json()[0]["message"] == said
            assert answer.headers["content-language"] == language
            assert "Accept-Language" in answer.headers["vary"]
    read = api.get(f"/alerts/{alert}", headers=german)
    assert read.json()["message"] == "Ausrichtfehler an Kupplung C1"
    assert read.headers["content-language"] == "de"
    (event,) = api.get(f"/alerts/{alert}/events", headers=german).json()
    assert event["message"] == "Ausrichtfehler an Kupplung C1"
    # Errors stay English, and a state that was read in one language may be changed in another.
    assert "no alert" in refused(api.get("/alerts/999", headers=german), 404)
    answer = api.post(f"/alerts/{alert}/acknowledge", json=ANNA, headers={"if-match": read.headers["etag"]})
    assert (answer.status_code, answer.json()["message"]) == (200, "Misalignment of coupling C1")


def test_what_the_service_wrote_into_a_history_is_reported_in_the_language_and_what_people_wrote_is_not(
    plant: Database, api: httpx.Client
) -> None:
    alert = raised(plant)
    assert api.post(f"/alerts/{alert}/comments", json={"by": "anna", "comment": "its cause is gone"}).status_code == 200
    work = {"at": datetime.now(UTC).isoformat(), "kind": "maintenance", "text": "bearing B1 and seal", "by": "ben"}
    assert api.post("/machines/pump-7/timeline", json=work).status_code == 201
    for code, said in (
        ("de", "ein neuer Referenzzustand beginnt: bearing B1 and seal"),
        ("en", "a new baseline begins: bearing B1 and seal"),
    ):
        events = api.get(f"/alerts/{alert}/events", headers={"accept-language": code}).json()
        assert [one["comment"] for one in events] == ["", "its cause is gone", said]


def test_a_latched_alert_is_reset(plant: Database, api: httpx.Client) -> None:
    alert = raised(plant, latching=True)
    cleared(plant, alert)
    assert "acknowledge it" in refused(api.post(f"/alerts/{alert}/reset", json=ANNA), 409)
    assert api.post(f"/alerts/{alert}/acknowledge", json=ANNA).json()["state"] == "latched_acknowledged"
    assert api.post(f"/alerts/{alert}/reset", json=ANNA).json()["state"] == "normal"


def test_an_alert_is_shelved_for_a_time_only(plant: Database, api: httpx.Client) -> None:
    alert = raised(plant)
    for until in (soon(days=31), soon(seconds=-5), "2261-12-31T23:59:59Z"):
        answer = api.post(f"/alerts/{alert}/shelve", json=ANNA | {"until": until})
        refused(answer, 422)
        (error,) = answer.json()["errors"]
        assert (error["field"], "30 days" in error["message"]) == ("until", True)
    refused(api.post(f"/alerts/{alert}/shelve", json=ANNA), 422)
    refused(api.post(f"/alerts/{alert}/shelve", json=ANNA | {"until": "2026-11-21T12:00:00"}), 422)
    assert api.post(f"/alerts/{alert}/shelve", json=ANNA | {"until": soon(hours=1)}).json()["state"] == "shelved"
    refused(api.post(f"/alerts/{alert}/shelve", json=ANNA | {"until": soon(hours=1)}), 409)
    (one,) = api.get("/machines/pump-7/suppressions").json()
    assert (one["kind"], one["rule"], one["element"], one["by"]) == ("shelved", "misalignment", "coupling.C1", "anna")
    assert api.post(f"/alerts/{alert}/unshelve", json=ANNA).json()["state"] == "unacknowledged"
    refused(api.post(f"/alerts/{alert}/unshelve", json=ANNA), 409)


def test_a_machine_goes_out_of_service_and_comes_back(plant: Database, api: httpx.Client) -> None:
    alert = raised(plant)
    answer = api.post("/machines/pump-7/suppressions", json=ANNA | {"kind": "out_of_service"})
    assert answer.status_code == 201
    assert api.get(f"/alerts/{alert}").json()["state"] == "out_of_service"
    number = answer.json()["id"]
    assert api.post(f"/suppressions/{number}/end", json=ANNA).json()["ended_by"] == "anna"
    assert api.get(f"/alerts/{alert}").json()["state"] == "unacknowledged"
    refused(api.post(f"/suppressions/{number}/end", json=ANNA), 409)
    refused(api.post("/suppressions/999/end", json=ANNA), 404)
    refused(api.post("/machines/nobody/suppressions", json=ANNA | {"kind": "out_of_service"}), 404)
    past = ANNA | {"kind": "out_of_service", "until": soon(seconds=-1)}
    assert "moment to come" in refused(api.post("/machines/pump-7/suppressions", json=past), 409)


@pytest.mark.parametrize(
    ("wrong", "field", "close"),
    [
        ({"rule": "misaligment"}, "rule", "did you mean 'misalignment'"),
        ({"rule": "zzz"}, "rule", "there are misalignment, bearing"),
        ({"element": "coupling.c1"}, "element", "did you mean 'coupling.C1'"),
        ({"element": "bearing.B17x"}, "element", "did you mean 'bearing.B1'"),
        ({"rule": "misalignment", "element": "bearing.B1"}, "element", "they are of a coupling"),
    ],
)
def test_a_suppression_of_what_can_have_no_alert_is_refused(
    api: httpx.Client, wrong: dict[str, str], field: str, close: str
) -> None:
    answer = api.post("/machines/pump-7/suppressions", json=ANNA | {"kind": "out_of_service"} | wrong)
    refused(answer, 422)
    (error,) = answer.json()["errors"]
    assert error["field"] == field
    assert close in error["message"]
    assert api.get("/machines/pump-7/suppressions").json() == []


def test_an_alert_that_stands_may_be_suppressed_though_the_document_no_longer_has_its_element(
    plant: Database, api: httpx.Client
) -> None:
    wanted = ANNA | {"kind": "out_of_service", "rule": "coupling", "element": "coupling.GONE"}
    refused(api.post("/machines/pump-7/suppressions", json=wanted | {"rule": None}), 422)
    alert = raised(plant, "coupling.GONE")
    assert api.get(f"/alerts/{alert}").json()["rule"] == "misalignment"
    refused(api.post("/machines/pump-7/suppressions", json=wanted | {"rule": "oil"}), 422)
    assert api.post("/machines/pump-7/suppressions", json=wanted | {"rule": "misalignment"}).status_code == 201
    assert api.get(f"/alerts/{alert}").json()["state"] == "out_of_service"


@pytest.mark.parametrize(
    "right", [{"element": "machine", "rule": "oil"}, {"rule": "rate_of_change"}, {"element": "bearing.B2"}]
)
def test_a_suppression_of_what_can_have_an_alert_is_taken(api: httpx.Client, right: dict[str, str]) -> None:
    answer = api.post("/machines/pump-7/suppressions", json=ANNA | {"kind": "suppressed_by_design"} | right)
    assert answer.status_code == 201, answer.text


def test_comments_and_the_timeline(plant: Database, api: httpx.Client) -> None:
    alert = raised(plant)
    assert api.post(f"/alerts/{alert}/comments", json=ANNA).json()["events"] == 2
    refused(api.post(f"/alerts/{alert}/comments", json={"by": "anna"}), 422)
    entry = {"at": soon(hours=-1), "kind": "maintenance", "text": "coupling re-shimmed", "by": "anna"}
    assert api.post("/machines/pump-7/timeline", json=entry).status_code == 201
    (one,) = api.get("/machines/pump-7/timeline").json()
    assert (one["kind"], one["text"]) == ("maintenance", "coupling re-shimmed")
    assert api.get("/machines/pump-7/timeline", params={"from": soon(hours=1)}).json() == []


@pytest.mark.parametrize("path", ["timeline", "baselines"])
def test_a_baseline_that_would_begin_in_the_future_is_refused_and_clears_nothing(
    path: str, plant: Database, api: httpx.Client
) -> None:
    alert = raised(plant)
    planned = {
        "timeline": {"at": soon(days=30), "text": "overhaul", "kind": "maintenance", "by": "anna"},
        "baselines": {"since": soon(days=30), "reason": "overhaul", "by": "anna"},
    }
    answer = api.post(f"/machines/pump-7/{path}", json=planned[path])
    assert "not in the future" in refused(answer, 422)
    assert api.get(f"/alerts/{alert}").json()["state"] == "unacknowledged"
    plan = {"at": soon(days=30), "kind": "note", "text": "overhaul planned", "by": "anna"}
    assert api.post("/machines/pump-7/timeline", json=plan).status_code == 201


@pytest.mark.parametrize("moment", ["0001-01-01T00:00:00Z", "1969-12-31T23:59:59Z", "9999-01-01T00:00:00Z"])
def test_a_moment_that_the_store_cannot_count_is_refused(moment: str, api: httpx.Client) -> None:
    answer = api.post("/machines/pump-7/timeline", json={"at": moment, "text": "when was that?", "by": "anna"})
    refused(answer, 422)
    assert answer.json()["errors"] == [{"field": "at", "message": "a moment lies between 1970 and 2262"}]


def test_two_people_acknowledge_at_once_and_one_learns_of_the_other(plant: Database, api: httpx.Client) -> None:
    alert = raised(plant)
    codes: list[int] = []
    people = [
        threading.Thread(
            target=lambda n=name: codes.append(api.post(f"/alerts/{alert}/acknowledge", json={"by": n}).status_code)
        )
        for name in ("anna", "ben")
    ]
    for one in people:
        one.start()
    for one in people:
        one.join()
    assert sorted(codes) == [200, 409]
    assert len(api.get(f"/alerts/{alert}/events").json()) == 2


def test_subscriptions_and_their_secrets(plant: Database, api: httpx.Client) -> None:
    wanted = {"kind": "webhook", "name": "historian", "target": "https://historian.example/hook"}
    answer = api.post("/subscriptions", json=wanted)
    assert answer.status_code == 201
    assert answer.json()["secret"].startswith("whsec_")
    number = answer.json()["id"]
    assert "secret" not in api.get(f"/subscriptions/{number}").json()
    assert answer.json()["secret"] not in api.get("/subscriptions").text
    refused(api.post("/subscriptions", json=wanted), 409)
    refused(api.post("/subscriptions", json=wanted | {"name": "b", "target": "ftp://historian.example/"}), 422)
    refused(api.post("/subscriptions", json={"kind": "zenoh", "name": "c", "target": "x"}), 422)
    for target in ("anna", "anna@plant.example, ", "anna@plant.example\nBcc: eve@example.org", "smtp://h/a@b.c/d@e.f"):
        refused(api.post("/subscriptions", json={"kind": "email", "name": "d", "target": target}), 422)
    people = {"kind": "email", "name": "d", "target": "anna@plant.example, ben@plant.example"}
    assert api.post("/subscriptions", json=people).status_code == 201
    raised(plant)
    (one,) = api.get(f"/subscriptions/{number}/deliveries").json()
    assert (one["state"], one["attempts"]) == ("pending", 0)
    assert api.post(f"/subscriptions/{number}/disable").json()["state"] == "disabled"
    assert "enable it first" in refused(api.post(f"/subscriptions/{number}/deliveries/{one['id']}/again"), 409)
    assert api.get(f"/subscriptions/{number}/deliveries").json()[0]["state"] == "given_up"
    assert api.post(f"/subscriptions/{number}/enable").json()["state"] == "active"
    assert api.post(f"/subscriptions/{number}/deliveries/{one['id']}/again").json()["state"] == "pending"
    refused(api.post(f"/subscriptions/{number}/deliveries/999/again"), 404)
    refused(api.post(f"/subscriptions/{number}/test"), 409)
    refused(api.get("/subscriptions/999"), 404)


@pytest.mark.parametrize("channel", ["webhook", "alertmanager"])
@pytest.mark.parametrize(
    "target", ["http://127.0.0.1:9000/hook", "http://[::1]/", "https://10.1.2.3/hook", "http://localhost/"]
)
def test_a_target_to_which_nothing_would_be_delivered_is_refused_at_once(api: httpx.Client, channel: str, target: str) -> None:
    answer = api.post("/subscriptions", json={"kind": channel, "name": "historian", "target": target})
    assert "RUNDOWN_DELIVERY_NETWORKS" in refused(answer, 422)
    assert api.get("/subscriptions").json() == []


def test_a_target_in_a_network_that_the_operator_names_is_taken(plant: Database) -> None:
    with served(plant, delivery_networks=(ipaddress.ip_network("127.0.0.0/8"),)) as url:
        said = {"kind": "alertmanager", "name": "am", "target": "http://127.0.0.1:9093"}
        assert httpx.post(f"{url}/subscriptions", json=said, trust_env=False).status_code == 201


# --- the stream -----------------------------------------------------------------------------------------------------


class StreamListener:
    """A client of the stream in a thread of its own."""

    def __init__(self, api: httpx.Client, **how: Any) -> None:
        self.events: list[tuple[int, dict[str, Any]]] = []
        self.ready = threading.Event()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, args=(str(api.base_url), how))
        self._thread.start()
        assert self.ready.wait(10.0)

    def _run(self, url: str, how: dict[str, Any]) -> None:
        with httpx.stream(
            "GET", f"{url}alert-events/stream", timeout=httpx.Timeout(10.0, read=1.0), trust_env=False, **how
        ) as answer:
            assert answer.headers["content-type"].startswith("text/event-stream")
            number = 0
            lines = answer.iter_lines()
            while not self._stop.is_set():
                try:
                    line = next(lines)
                except (httpx.ReadTimeout, StopIteration):
                    return
                self.ready.set()
                if line.startswith("id: "):
                    number = int(line[4:])
                elif line.startswith("data: "):
                    self.events.append((number, json.loads(line[6:])))

    def ids(self) -> list[int]:
        return [number for number, _ in self.events]

    def close(self) -> None:
        self._stop.set()
        self._thread.join()


def test_the_stream_tells_what_happens_and_repeats_what_was_missed(plant: Database, api: httpx.Client) -> None:
    raised(plant, "coupling.C0")
    raised(plant, "coupling.C1")
    late = StreamListener(api, headers={"Last-Event-ID": "1"})
    wait_until(lambda: late.ids() == [2])
    late.close()
    everything = StreamListener(api, params={"after": 0})
    wait_until(lambda: everything.ids() == [1, 2])
    everything.close()
    assert [one["element"] for _, one in everything.events] == ["coupling.C0", "coupling.C1"]


def test_the_stream_is_live(plant: Database, api: httpx.Client) -> None:
    raised(plant, "coupling.C0")
    live = StreamListener(api)
    raised(plant, "coupling.C1")
    wait_until(lambda: live.ids() == [2], seconds=5.0)
    live.close()


def test_the_stream_begins_with_the_number_behind_which_it_begins(plant: Database) -> None:
    raised(plant, "coupling.C0")
    assert b"\nid: 1\n" in greeting(plant, None)
    assert b"\nid: 0\n" in greeting(plant, 0)


def test_a_number_that_no_event_has_reached_is_of_another_store_and_the_stream_begins_again(plant: Database) -> None:
    raised(plant, "coupling.C0")
    assert b"there is no event 500:" in greeting(plant, 500)
    live = greeting(plant, 500, then=lambda: raised(plant, "coupling.C1"))
    assert b"\nid: 1\n" in live
    assert b"id: 2\nevent: alert\n" in live


def greeting(plant: Database, after: int | None, *, then: Callable[[], object] | None = None) -> bytes:
    """Return what a stream says at first, and behind that of what happens then."""

    async def scenario() -> bytes:
        one = stream(Broadcaster(plant), after)
        said = b""
        while b"\n\n" not in said:
            said += await anext(one)
        if then is not None:
            await asyncio.to_thread(then)
            said += await asyncio.wait_for(anext(one), 10.0)
        await one.aclose()
        return said

    return asyncio.run(scenario())


class FailingBroadcaster(Broadcaster):
    """Meets what nobody expected, until it is told that this is over."""

    puzzled = False

    def _read(self, after: int) -> list[StreamEvent]:
        if self.puzzled:
            raise LookupError("no such thing")
        return super()._read(after)


def test_what_nobody_expected_ends_no_stream_and_is_reported_until_it_is_over(
    plant: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(event_stream, "RETRY_S", 0.02)
    api = Api(plant)
    broadcaster = api.app.state.broadcaster = FailingBroadcaster(plant)

    async def until(trouble: bool) -> None:
        deadline = time.monotonic() + 10.0
        while (broadcaster.trouble is not None) != trouble:
            assert time.monotonic() < deadline
            await asyncio.sleep(0.01)

    async def scenario() -> bytes:
        one = stream(broadcaster, None)
        await anext(one)
        broadcaster.puzzled = True
        await until(trouble=True)
        ready = await asyncio.to_thread(api.get, "/ready")
        assert ready.status_code == 503
        assert ready.json()["parts"]["alert_events"] == "alert events cannot be read: unexpected error; the log has it"
        await asyncio.to_thread(raised, plant, "coupling.C0")
        another = stream(broadcaster, None)
        await anext(another)
        broadcaster.puzzled = False
        said = await asyncio.wait_for(anext(one), 10.0)
        await until(trouble=False)
        await one.aclose()
        await another.aclose()
        return said

    assert asyncio.run(scenario()).startswith(b"id: 1\nevent: alert\n")


def test_who_joins_while_nobody_reads_takes_no_event_from_who_was_there(plant: Database) -> None:
    async def scenario() -> bytes:
        broadcaster = Broadcaster(plant)
        one, another = stream(broadcaster, None), stream(broadcaster, None)
        await anext(one)
        assert broadcaster._task is not None
        broadcaster._task.cancel()
        await asyncio.gather(broadcaster._task, return_exceptions=True)
        await asyncio.to_thread(raised, plant, "coupling.C0")
        await anext(another)
        said = await asyncio.wait_for(anext(one), 10.0)
        await one.aclose()
        await another.aclose()
        return said

    assert asyncio.run(scenario()).startswith(b"id: 1\nevent: alert\n")


def test_an_event_that_cannot_be_reported_stops_none_behind_it(plant: Database) -> None:
    raised(plant, "coupling.C0")
    with plant.transaction() as session:
        session.execute(text("UPDATE alert_events SET severity = 9"))  # there is no such severity

    async def scenario() -> list[int]:
        broadcaster = Broadcaster(plant)
        live, from_the_first = stream(broadcaster, None), stream(broadcaster, 0)
        for one in (live, from_the_first):
            await anext(one)
        await asyncio.to_thread(raised, plant, "coupling.C1")
        found = [_number(await asyncio.wait_for(anext(one), 10.0)) for one in (live, from_the_first)]
        await live.aclose()
        await from_the_first.aclose()
        return found

    assert asyncio.run(scenario()) == [2, 2]


def test_a_wrong_last_event_id_is_refused(api: httpx.Client) -> None:
    refused(api.get("/alert-events/stream", headers={"Last-Event-ID": "yesterday"}), 422)


def test_a_client_that_does_not_read_is_let_go_and_misses_nothing_when_it_comes_back(
    plant: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(event_stream, "QUEUE_SIZE", 3)

    async def scenario() -> tuple[list[int], list[int]]:
        broadcaster = Broadcaster(plant)
        slow = stream(broadcaster, None)
        await anext(slow)  # the greeting
        for number in range(10):
            await asyncio.to_thread(raised, plant, f"coupling.C{number}")
        deadline = time.monotonic() + 10.0
        while broadcaster.clients and time.monotonic() < deadline:
            await asyncio.sleep(0.02)
        assert broadcaster.clients == 0
        before = [_number(part) async for part in slow]
        again = stream(broadcaster, before[-1])
        await anext(again)
        after = [_number(await asyncio.wait_for(anext(again), 10.0)) for _ in range(10 - len(before))]
        await again.aclose()
        return before, after

    before, after = asyncio.run(scenario())
    assert before == [1, 2, 3]
    assert before + after == list(range(1, 11))


def _number(part: bytes) -> int:
    return int(part.split(b"\n")[0].removeprefix(b"id: "))
