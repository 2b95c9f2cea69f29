"""The typed client against the real application, and against a real server where it streams; the examples that use it."""

import subprocess
import sys
import threading
from collections.abc import Iterator
from datetime import UTC, datetime

import httpx
import pytest

from benchmarks.serving import served
from service.alerts import transitions
from service.alerts.transitions import AlertFinding, Person
from service.client import ChangedMeanwhile, Refused, Rundown
from service.security import api_keys
from service.security.role import Role
from storage.alerts import alerts
from storage.database.engine import Database
from tests.api_in_process import Api
from tests.paths import ROOT
from tests.plant import KEY, SECOND, START, document, identification, machine, store_identification


@pytest.fixture
def rundown(plant: Database) -> Rundown:
    """A client of a service over a machine with three identifications and an alert."""
    with plant.transaction() as session:
        for number, factor in enumerate((1.0, 1.0, 1.2)):
            outcome = identification({"coupling.C1.kxx": factor})
            row = store_identification(session, outcome, run_id=number, measured_at=START + number * SECOND)
        finding = AlertFinding({}, row.id, START)
        transitions.raise_alert(session, KEY.machine, rule="misalignment", element="coupling.C1", finding=finding)
    http = Api(plant).http
    del http.headers["if-match"]
    return Rundown(http=http)


def test_answers_are_models(rundown: Rundown) -> None:
    (one,) = rundown.machines()
    assert (one.id, one.name) == (KEY.machine, "Pump 7")
    assert rundown.machine(KEY.machine).document == machine()
    assert rundown.state(KEY.machine).state == "unknown"
    (glance,) = rundown.fleet()
    assert glance.open_alerts == {"alert": 1, "danger": 0}
    assert list(rundown.runs(KEY.machine)) == []
    found = list(rundown.identifications(KEY.machine, last=datetime.fromtimestamp(START // SECOND + 1, UTC)))
    assert [one.id for one in found] == [2, 1]
    estimates = {one.parameter: one for one in rundown.identification(3).estimates}
    assert estimates["coupling.C1.kxx"].value == pytest.approx(2.4e6)
    (series,) = rundown.trends(KEY.machine, "coupling.C1.kxx").series
    assert series.value == pytest.approx([2e6, 2e6, 2.4e6])
    assert rundown.deviations(KEY.machine).missing is not None
    assert rundown.critical_speeds(1, units="hz").units.speed == "hz"
    assert rundown.bode(1).measured == []


def test_a_key_opens_the_service_and_says_who_does_it(plant: Database) -> None:
    with plant.transaction() as session:
        _, key = api_keys.create(session, name="historian", role=Role.ANALYST, plants=[KEY.plant], days=1)
    with Rundown(http=Api(plant).http) as nobody, pytest.raises(Refused, match="401"):
        list(nobody.machines())
    with Rundown(key=key, http=Api(plant).http) as client:
        assert client.note(KEY.machine, "looked", by="x", at=datetime(2026, 1, 1, tzinfo=UTC)).by == "historian"
    assert Rundown("https://plant.example", key=key)._http.headers["Authorization"] == f"Bearer {key}"


def test_long_lists_are_followed_to_their_end(rundown: Rundown, plant: Database) -> None:
    with plant.transaction() as session:
        for number in range(110):
            store_identification(session, identification(), run_id=1000 + number, measured_at=START + 1000 + number)
    assert len(list(rundown.identifications(KEY.machine))) == 113


def test_machines_are_created_and_revised_as_they_were_read(rundown: Rundown) -> None:
    read = rundown.create_machine(machine(id="fan-2"))
    assert (read.id, read.revision) == ("fan-2", 1)
    assert rundown.revise_machine(read, machine(id="fan-2", name="Fan")).revision == 2
    with pytest.raises(ChangedMeanwhile, match="fan-2"):
        rundown.revise_machine(read, machine(id="fan-2", name="Blower"))
    with pytest.raises(Refused, match="409 Conflict: machine 'fan-2' exists already") as refused:
        rundown.create_machine(machine(id="fan-2"))
    assert refused.value.problem.status == 409


def test_alerts_are_acknowledged_as_they_were_read(rundown: Rundown, plant: Database) -> None:
    (alert,) = rundown.alerts(only_open=True)
    with plant.transaction() as session:
        transitions.comment(session, alerts.get(session, alert.id), Person("ben", "I look at it"))
    with pytest.raises(ChangedMeanwhile):
        rundown.acknowledge(alert, by="anna")
    (alert,) = rundown.alerts(machine=KEY.machine)
    assert rundown.acknowledge(alert, by="anna", comment="on it").state == "acknowledged"
    assert rundown.note(KEY.machine, "looked", by="anna", at=datetime.now(UTC)).text == "looked"


class Unreliable(httpx.BaseTransport):
    """Loses the first answers, after the request has been worked on."""

    def __init__(self, inner: httpx.BaseTransport, *, lost: int) -> None:
        self._inner = inner
        self.lost = lost

    def handle_request(self, request: httpx.Request) -> httpx.Response:
        answer = self._inner.handle_request(request)
        self.lost -= 1
        if self.lost >= 0:
            raise httpx.ReadError("the connection broke off")
        return answer


@pytest.mark.parametrize("lost", [1, 2, 3])
def test_what_got_no_answer_is_asked_again_and_done_once(plant: Database, lost: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("service.client.PAUSE_S", 0.0)
    api = Api(plant)
    transport = Unreliable(api.http._transport, lost=lost)
    rundown = Rundown(http=httpx.Client(transport=transport, base_url="http://rundown"))
    if lost == 3:
        with pytest.raises(httpx.ReadError):
            rundown.note(KEY.machine, "looked", by="anna", at=datetime.now(UTC))
    else:
        rundown.note(KEY.machine, "looked", by="anna", at=datetime.now(UTC))
    assert len(api.value(f"/machines/{KEY.machine}/timeline")) == 1


def test_a_revision_whose_answer_was_lost_is_done_and_one_that_lost_a_race_is_not(
    plant: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.client.PAUSE_S", 0.0)
    api = Api(plant)
    transport = Unreliable(api.http._transport, lost=0)
    rundown = Rundown(http=httpx.Client(transport=transport, base_url="http://rundown"))
    read = rundown.machine(KEY.machine)

    first = ["PUT"]

    def lose(request: httpx.Request) -> None:
        transport.lost = 0
        if request.method in first:
            first.remove(request.method)
            transport.lost = 1

    rundown._http.event_hooks["request"] = [lose]
    assert rundown.revise_machine(read, machine(name="Mine")).document.name == "Mine"
    read = rundown.machine(KEY.machine)

    def be_faster(request: httpx.Request) -> None:
        if request.method == "PUT":
            api("PUT", f"/machines/{KEY.machine}", json=document(name="Theirs"))

    rundown._http.event_hooks["request"] = [be_faster]
    with pytest.raises(ChangedMeanwhile):
        rundown.revise_machine(read, machine(name="Mine again"))
    assert rundown.machine(KEY.machine).document.name == "Theirs"


def test_an_answer_that_is_not_the_services_is_an_http_error() -> None:
    transport = httpx.MockTransport(lambda _: httpx.Response(502, text="Bad Gateway"))
    with (
        Rundown(http=httpx.Client(transport=transport, base_url="http://proxy")) as rundown,
        pytest.raises(httpx.HTTPStatusError, match="502 Bad Gateway"),
    ):
        rundown.machine("pump-7")


@pytest.fixture
def url(rundown: Rundown, plant: Database) -> Iterator[str]:
    """A real server over the same database."""
    assert rundown
    with served(plant) as base:
        yield base.removesuffix("/api/v1")


def test_events_stream_and_are_repeated_from_where_they_broke_off(url: str, plant: Database) -> None:
    with Rundown(url) as client:
        events = client.events(after=0)
        assert next(events).kind == "raised"
        with plant.transaction() as session:
            transitions.acknowledge(session, alerts.get(session, 1), Person("anna"))
        timer = threading.Timer(20.0, client._http.close)
        timer.start()
        assert next(events).by == "anna"
        timer.cancel()
        events.close()  # type: ignore[attr-defined]


def test_a_stream_that_breaks_before_its_first_event_goes_on_where_it_began(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("service.client.PAUSE_S", 0.0)
    asked: list[str | None] = []

    class Broken(httpx.SyncByteStream):
        def __iter__(self) -> Iterator[bytes]:
            yield b": a word\nid: 7\nretry: 1000\n\n"
            yield b"id: 8\nevent: al"
            raise httpx.ReadError("gone")

    def answer(request: httpx.Request) -> httpx.Response:
        asked.append(request.headers.get("last-event-id"))
        if len(asked) == 2:
            return httpx.Response(503, text="the service starts")
        return httpx.Response(200, stream=Broken()) if len(asked) < 4 else httpx.Response(500, text="enough")

    transport = httpx.MockTransport(answer)
    with (
        Rundown(http=httpx.Client(transport=transport, base_url="http://plant")) as client,
        pytest.raises(httpx.HTTPStatusError, match="500"),
    ):
        next(client.events())
    assert asked == [None, "7", "7", "7"]


def test_the_example_prints_the_fleet(url: str) -> None:
    program = ROOT / "examples" / "clients" / "overview.py"
    command = [sys.executable, str(program), url]
    ran = subprocess.run(
        command, check=False, capture_output=True, text=True, timeout=60, cwd=ROOT, env={"PYTHONPATH": str(ROOT)}
    )
    assert ran.returncode == 0, ran.stderr
    assert "pump-7: unknown" in ran.stdout
    assert "alert: Misalignment of coupling C1" in ran.stdout
    assert "coupling.C1.kxx: 2.4e+06 N/m, +20.0 % in 3 runs" in ran.stdout
