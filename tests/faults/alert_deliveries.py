"""Alerts that change while the service is killed again and again: every event is told, in order, known when it comes twice.

Nothing is simulated but the plant: `rundown serve` is a process that is killed with SIGKILL, the webhook's receiver, the
stream's client and the network's subscriber are real ones.
"""

import contextlib
import json
import random
import threading
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from pathlib import Path

import httpx
import zenoh

from service.alerts import transitions
from service.alerts.transitions import AlertFinding
from service.messaging.session import open_session
from storage.alerts import alerts, deliveries, suppressions
from storage.database.engine import Database
from storage.machines import machines
from storage.tables.alerting import AlertEventRow, AlertRow, DeliveryRow
from tests.end_to_end.processes import Service, until
from tests.plant import KEY, START, identification, machine, sqlite_url, store_identification
from tests.service.delivery.receivers import LOOPBACK, ReceivedRequest, receiver

RULE = "misalignment"
ELEMENTS = tuple(f"coupling.C{number}" for number in range(1, 5))
LONGEST_LIFE_S = 1.5
"""The service is killed at a random moment of this time after it was ready …"""
EARLY = 0.25
"""… and in this part of the cases while it is still starting."""
READY_S = 90.0
"""A service that starts while others keep the machine busy takes its time."""
PAUSE_S = 0.03
"""Between two changes."""
HEARD = 10
"""As many events at least come over the network while the service lives its last life."""


@dataclass(frozen=True)
class DeliveryCounts:
    """Counts of a trial.

    events: that happened. repeated: webhooks that came more than once. heard: events that came over the network.
    """

    events: int
    repeated: int
    heard: int


@dataclass
class Changing:
    """A thread that changes alerts: as people do, over HTTP, and as identifications do, in the database itself.

    confirmed: comments that the service has confirmed.
    """

    service: Service
    database: Database
    rng: random.Random
    identification: int
    confirmed: list[str] = field(default_factory=list)
    count: int = 0

    def run(self, stop: threading.Event) -> None:
        """Run until it is stopped."""
        with httpx.Client(base_url=self.service.client.base_url, trust_env=False, timeout=5.0) as client:
            while not stop.wait(PAUSE_S):
                self.count += 1
                if self.rng.random() < 0.3:
                    self._found(self.rng.choice(ELEMENTS))
                else:
                    with contextlib.suppress(httpx.TransportError):  # it was killed before it answered
                        self._asked(client)

    def _found(self, element: str) -> None:
        finding = AlertFinding({}, self.identification, START, latching=self.rng.random() < 0.2)
        with self.database.transaction() as session:
            row = alerts.open_alert(session, KEY.machine, rule=RULE, element=element)
            if row is None or self.rng.random() < 0.5:
                transitions.raise_alert(session, KEY.machine, rule=RULE, element=element, finding=finding)
            else:
                transitions.clear_alert(session, row)

    def _asked(self, client: httpx.Client) -> None:
        with self.database.reading() as session:
            rows = alerts.find(session, machine_id=None, only_open=False, limit=len(ELEMENTS))
            number = self.rng.choice(rows).id
        action = self.rng.choice(("comments", "acknowledge", "reset", "shelve", "unshelve"))
        said = {"by": "anna", "comment": f"change {self.count}"}
        if action == "shelve":
            said["until"] = (datetime.now(UTC) + timedelta(seconds=self.rng.uniform(0.5, 5.0))).isoformat()
        answer = client.post(f"/alerts/{number}/{action}", json=said, headers={"if-match": "*"})
        assert answer.status_code in (200, 409), answer.text
        if action == "comments":
            self.confirmed.append(said["comment"])


@dataclass
class Following:
    """A thread that reads the stream of events and comes back, after every kill, behind the last event it has seen."""

    url: str
    seen: list[int] = field(default_factory=list)

    def run(self, stop: threading.Event) -> None:
        """Run until it is stopped."""
        with httpx.Client(trust_env=False, timeout=0.5) as client:
            while not stop.wait(0.1):
                last = {"Last-Event-ID": str(self.seen[-1] if self.seen else 0)}
                with (
                    contextlib.suppress(httpx.TransportError),
                    client.stream("GET", f"{self.url}alert-events/stream", headers=last) as answer,
                ):
                    self._read(answer.iter_lines(), stop)

    def _read(self, lines: Iterator[str], stop: threading.Event) -> None:
        number, told = 0, False
        for line in lines:
            if line.startswith("id: "):
                number = int(line[4:])
            elif line.startswith("data: "):
                told = True
            elif not line and told:  # an event ends with an empty line; an id alone is where the stream begins
                self.seen.append(number)
                told = False
            if stop.is_set():
                return


def deliveries_through_kills(folder: Path, *, seed: int, kills: int) -> DeliveryCounts:
    """Alerts change all the time; the service is killed at random moments and started again; then all must have been told."""
    rng = random.Random(seed)
    service = Service(folder, RUNDOWN_DELIVERY_NETWORKS=json.dumps(LOOPBACK))
    database = Database(sqlite_url(folder / "rundown.db"))
    with receiver() as http, open_session(listen=[], connect=[service.endpoint]) as network:
        first, webhook = _prepared(database, http.url("/late"))
        heard: list[dict[str, int]] = []
        listener = network.declare_subscriber(
            "rundown/v1/*/*/alerts/*", lambda sample: heard.append(json.loads(bytes(sample.payload)))
        )
        changing = Changing(service, database, random.Random(seed + 1), first)
        following = Following(str(service.client.base_url))
        stop, over = threading.Event(), threading.Event()
        threads = [threading.Thread(target=changing.run, args=(stop,)), threading.Thread(target=following.run, args=(over,))]
        for thread in threads:
            thread.start()
        try:
            for _ in range(kills):
                _killed(service, rng)
            with service.running():
                # The network's subscriber comes back when it comes back: what was told meanwhile it does not hear.
                before = len(heard)
                until(lambda: len(heard) > before + HEARD, within_s=30, what="what is told over the network")
                stop.set()
                threads[0].join()
                # The end of a shelf is an event too, and would come behind the last that is looked for.
                until(lambda: not _shelved(database), within_s=30, what="the end of every shelf")
                until(lambda: not _pending(database), within_s=60, what="every event delivered")
                newest = _events(database)[-1].id
                until(
                    lambda: bool(following.seen) and following.seen[-1] >= newest, within_s=20, what="the stream's last event"
                )
                _check_states(database, network)
        finally:
            stop.set()
            over.set()
            for thread in threads:
                thread.join()
            listener.undeclare()
            service.client.close()
        events = _events(database)
        _check_events(events, changing.confirmed)
        assert following.seen == [event.id for event in events]
        repeated = _check_webhooks(http.received, events)
        _check_heard(heard, events)
        _check_deliveries(database, webhook, len(events))
    database.close()
    assert "Traceback" not in service.log.read_text()
    return DeliveryCounts(len(events), repeated, len({(one["alert"], one["number"]) for one in heard}))


def _prepared(database: Database, target: str) -> tuple[int, int]:
    """An identification, an alert for each element, and who is told: numbers of the identification and of the webhook."""
    with database.transaction() as session:
        machines.create(session, machine())
        webhook = deliveries.subscribe(session, kind="webhook", name="historian", target=target, secret="whsec_c2VjcmV0").id
        deliveries.subscribe(session, kind="zenoh", name="network", target="", secret=None)
        first = store_identification(session, identification(), run_id=1, measured_at=START).id
        for element in ELEMENTS:
            finding = AlertFinding({}, first, START)
            transitions.raise_alert(session, KEY.machine, rule=RULE, element=element, finding=finding)
    return first, webhook


def _killed(service: Service, rng: random.Random) -> None:
    """One life of the service."""
    with service.started() as process:
        if rng.random() >= EARLY:
            until(lambda: service._ready(process), within_s=READY_S, what="the service is ready")
        time.sleep(rng.uniform(0.0, LONGEST_LIFE_S))
        process.kill()
        process.wait()


def _events(database: Database) -> list[AlertEventRow]:
    with database.reading() as session:
        return session.query(AlertEventRow).order_by(AlertEventRow.id).all()


def _shelved(database: Database) -> int:
    with database.reading() as session:
        return len(suppressions.in_force(session, KEY.machine))


def _pending(database: Database) -> int:
    with database.reading() as session:
        return deliveries.counts(session).get(deliveries.PENDING, 0)


def _check_events(events: list[AlertEventRow], confirmed: list[str]) -> None:
    """Numbered without a hole in each alert, each beginning where the one before ended; what was confirmed is there, once."""
    for numbered in _by_alert(events).values():
        assert [event.number for event in numbered] == list(range(1, len(numbered) + 1))
        assert all(after.state_before == before.state for before, after in zip(numbered, numbered[1:], strict=False))
    said = Counter(event.comment for event in events if event.kind == "commented")
    assert {comment for comment in confirmed if said[comment] != 1} == set()


def _by_alert(events: list[AlertEventRow]) -> dict[int, list[AlertEventRow]]:
    found: dict[int, list[AlertEventRow]] = defaultdict(list)
    for event in events:
        found[event.alert_id].append(event)
    return found


def _check_webhooks(received: list[ReceivedRequest], events: list[AlertEventRow]) -> int:
    """Each event came, those of one alert in order, a repeated one under the same id with the same body. How many repeated."""
    bodies: dict[str, set[bytes]] = defaultdict(set)
    numbers: dict[int, list[int]] = defaultdict(list)
    for one in received:
        bodies[one.headers["webhook-id"]].add(one.body)
        numbers[one.json["data"]["alert"]].append(one.json["data"]["number"])
    assert set(bodies) == {f"alert-{event.alert_id}-{event.number}" for event in events}
    assert {name for name, several in bodies.items() if len(several) > 1} == set()
    for alert, several in numbers.items():
        assert several == sorted(several), f"alert {alert}"
    return len(received) - len(bodies)


def _check_heard(heard: list[dict[str, int]], events: list[AlertEventRow]) -> None:
    """Require that events which came did happen, and came in order. Nobody acknowledges what is published."""
    happened = {(event.alert_id, event.number) for event in events}
    numbers: dict[int, list[int]] = defaultdict(list)
    for one in heard:
        assert (one["alert"], one["number"]) in happened
        numbers[one["alert"]].append(one["number"])
    assert all(several == sorted(several) for several in numbers.values())


def _check_states(database: Database, network: zenoh.Session) -> None:
    """A query on the network gives the last event of every open alert."""

    def told() -> dict[int, int]:
        replies = network.get("rundown/v1/*/*/alerts/*", consolidation=zenoh.ConsolidationMode.NONE, timeout=5.0)
        found = [json.loads(bytes(reply.ok.payload)) for reply in replies if reply.ok]
        return {one["alert"]: one["number"] for one in found}

    with database.reading() as session:
        expected = {row.id: row.event_count for row in session.query(AlertRow) if row.closed_at is None}
    until(lambda: told() == expected, within_s=15, what="the network's last states")


def _check_deliveries(database: Database, webhook: int, events: int) -> None:
    with database.reading() as session:
        assert deliveries.counts(session) == {deliveries.DELIVERED: 2 * events}
        assert session.query(DeliveryRow).filter_by(subscription_id=webhook).count() == events
