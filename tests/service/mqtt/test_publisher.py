"""Alerts and trends on a real broker: each transition arrives, and the last states are there right after a kill."""

import asyncio
import json
from collections.abc import Iterator
from pathlib import Path

import pytest
import zenoh

from service.alerts import transitions as alerting
from service.alerts.transitions import AlertFinding, Person
from service.delivery.dispatcher import Dispatcher
from service.mqtt.publisher import MqttAlerts
from service.mqtt.stored_messages import RetainedMessage
from service.replication.work_share import WholeShare
from storage.alerts import alerts, deliveries
from storage.database.engine import Database
from tests.mosquitto import BrokerListener, Mosquitto, broker
from tests.plant import KEY, START, identification, store_identification, wait_until
from tests.service.mqtt.conftest import settings_of

ALERT = f"rundown/v1/{KEY.plant}/{KEY.machine}/alerts/misalignment/coupling.C1"
DAMAGED = f"rundown/v1/{KEY.plant}/{KEY.machine}/alerts/looseness/bearing.B1"
TRENDS = f"rundown/v1/{KEY.plant}/{KEY.machine}/trends"


@pytest.fixture
def own_broker(tmp_path: Path) -> Iterator[Mosquitto]:
    """A broker that a test may kill."""
    with broker(tmp_path / "mosquitto", tls=False) as one:
        yield one


@pytest.fixture
def publishing(own_broker: Mosquitto, router: zenoh.Session, plant: Database) -> Iterator[MqttAlerts]:
    """A service that delivers to the broker."""
    settings = settings_of(own_broker)
    with plant.transaction() as session:
        deliveries.subscribe(session, kind="mqtt", name="broker", target="", secret=None)
        store_identification(session, identification(), run_id=1, measured_at=START)
    publisher = MqttAlerts(settings, plant, WholeShare())
    dispatcher = Dispatcher(plant, router, settings, broker=publisher)
    publisher.start()
    dispatcher.start()
    try:
        wait_until(lambda: publisher.trouble is None)
        yield publisher
    finally:
        dispatcher.stop()
        publisher.stop()


def raised(plant: Database) -> int:
    """Raise an alert; its id."""
    with plant.transaction() as session:
        finding = AlertFinding({}, 1, START)
        row = alerting.raise_alert(session, KEY.machine, rule="misalignment", element="coupling.C1", finding=finding)
        assert row is not None
        return row.id


def state(payload: bytes | None) -> str | None:
    """State of the alert in a message."""
    return None if not payload else str(json.loads(payload)["state"])


@pytest.mark.usefixtures("publishing")
def test_each_transition_arrives_and_the_last_is_kept(own_broker: Mosquitto, plant: Database) -> None:
    with own_broker.connected("hmi", "", "rundown/v1/#") as hmi:
        number = raised(plant)
        wait_until(lambda: state(hmi.last(ALERT)) == "unacknowledged")
        with plant.transaction() as session:
            alerting.acknowledge(session, alerts.get(session, number), Person("anna"))
        wait_until(lambda: state(hmi.last(ALERT)) == "acknowledged")
        assert [json.loads(one.payload)["number"] for one in hmi.heard if one.topic == ALERT] == [1, 2]
    with own_broker.connected("hmi", "", "rundown/v1/#") as late:
        wait_until(lambda: late.last(ALERT) is not None)
        assert state(late.last(ALERT)) == "acknowledged"
        wait_until(lambda: late.last("rundown/v1/status/rundown") == b"online")


def test_last_states_are_reported_again_after_a_kill(own_broker: Mosquitto, plant: Database, publishing: MqttAlerts) -> None:
    """The broker forgets what it kept, and an alert changes while it is away."""
    number = raised(plant)
    wait_until(lambda: publishing.gauges["rundown_mqtt_published"] >= 1)
    own_broker.kill()
    (own_broker.folder / "mosquitto.db").unlink(missing_ok=True)
    wait_until(lambda: publishing.trouble is not None)
    with plant.transaction() as session:
        alerting.acknowledge(session, alerts.get(session, number), Person("anna"))
    own_broker.start()
    with own_broker.connected("hmi", "", "rundown/v1/#") as hmi:
        wait_until(lambda: state(hmi.last(ALERT)) == "acknowledged" and hmi.last(TRENDS) is not None)
    with plant.reading() as session:
        rows = deliveries.list_subscriptions(session)
    assert [row.state for row in rows] == ["active"]


@pytest.mark.usefixtures("publishing")
def test_trends_are_published_when_an_identification_is_filed(own_broker: Mosquitto, plant: Database) -> None:
    with own_broker.connected("hmi", "", TRENDS) as hmi:
        wait_until(lambda: hmi.last(TRENDS) is not None)
        with plant.transaction() as session:
            stored = store_identification(session, identification(), run_id=2, measured_at=START + 10**9).id
        wait_until(lambda: json.loads(hmi.last(TRENDS) or b"{}").get("identification") == stored)
        told = json.loads(hmi.last(TRENDS) or b"{}")
    assert told["accepted"]
    found = told["parameters"]["bearing.B1.kxx"]
    assert found["unit"] == "N/m"
    assert found["lower"] < found["value"] < found["upper"]


@pytest.mark.usefixtures("publishing")
def test_an_event_whose_text_cannot_be_made_replaces_the_state_before(own_broker: Mosquitto, plant: Database) -> None:
    with own_broker.connected("hmi", "", "rundown/v1/#") as hmi:
        number = raised(plant)
        wait_until(lambda: state(hmi.last(ALERT)) == "unacknowledged")
        with plant.transaction() as session:
            alerting.acknowledge(session, alerts.get(session, number), Person("anna"))
            alerts.last_event(session, number).evidence = {"measured_at": "yesterday"}
        wait_until(lambda: state(hmi.last(ALERT)) == "acknowledged")
        assert json.loads(hmi.last(ALERT) or b"{}")["message"] == "Misalignment of coupling C1: its text cannot be made"


def stored(plant: Database, number: int) -> int:
    """File the identification of a run; its id."""
    with plant.transaction() as session:
        return store_identification(session, identification(), run_id=number, measured_at=START + number * 10**9).id


def told_trends(hmi: BrokerListener) -> list[int]:
    """Ids of the identifications that a client has received, in order."""
    return [json.loads(one.payload)["identification"] for one in list(hmi.heard) if one.topic == TRENDS]


def test_whoever_subscribes_later_is_told_of_what_stands_already(own_broker: Mosquitto, plant: Database) -> None:
    """At once, not at the next connection; where no text takes what is stored of an alert its state is told all the same."""
    older = [stored(plant, number) for number in (1, 2, 3)]
    raised(plant)
    with plant.transaction() as session:
        finding = AlertFinding({}, 1, START)
        other = alerting.raise_alert(session, KEY.machine, rule="looseness", element="bearing.B1", finding=finding)
        alerts.last_event(session, other.id).evidence = {"measured_at": "yesterday"}
    publisher = MqttAlerts(settings_of(own_broker), plant, WholeShare())
    publisher.start()
    try:
        wait_until(lambda: publisher.trouble is None)
        with own_broker.connected("hmi", "", "rundown/v1/#") as hmi:
            wait_until(lambda: hmi.last("rundown/v1/status/rundown") == b"online")
            assert hmi.last(ALERT) is None, "nobody has asked for it"
            with plant.transaction() as session:
                deliveries.subscribe(session, kind="mqtt", name="broker", target="", secret=None)
            wait_until(lambda: state(hmi.last(ALERT)) == "unacknowledged" and hmi.last(TRENDS) is not None, seconds=15.0)
            wait_until(lambda: state(hmi.last(DAMAGED)) == "unacknowledged")
            assert "its text cannot be made" in json.loads(hmi.last(DAMAGED) or b"{}")["message"]
            newer = stored(plant, 4)
            wait_until(lambda: newer in told_trends(hmi))
            assert told_trends(hmi) == [older[-1], newer], "nothing older comes after the newest"
        assert publisher.trouble is None
    finally:
        publisher.stop()


def test_a_subscription_that_ends_repeats_nothing_and_one_that_is_new_does(own_broker: Mosquitto, plant: Database) -> None:
    """A connection, too, is told of the newest identification alone."""
    older = [stored(plant, number) for number in (1, 2, 3)]
    with plant.transaction() as session:
        subscriptions = [deliveries.subscribe(session, kind="mqtt", name=name, target="", secret=None).id for name in "ab"]
    publisher = MqttAlerts(settings_of(own_broker), plant, WholeShare())
    with own_broker.connected("hmi", "", "rundown/v1/#") as hmi:
        publisher.start()
        try:
            wait_until(lambda: publisher.trouble is None)
            with plant.transaction() as session:
                deliveries.disable(session, deliveries.get(session, subscriptions[1]), "by hand")
            wait_until(lambda: {number for number, _ in publisher._messages.published_for} == {subscriptions[0]})
            expected = [older[-1], stored(plant, 4)]
            wait_until(lambda: expected[-1] in told_trends(hmi))
            assert told_trends(hmi) == expected
            with plant.transaction() as session:
                deliveries.enable(session, deliveries.get(session, subscriptions[1]))
            wait_until(lambda: len(told_trends(hmi)) == 3)
            assert told_trends(hmi) == [*expected, expected[-1]]
        finally:
            publisher.stop()


def test_an_older_event_does_not_replace_the_last_state(own_broker: Mosquitto, publishing: MqttAlerts) -> None:
    topic = "rundown/v1/a/b/alerts/c/d"
    assert publishing._loop is not None
    assert publishing._ready is not None
    for number in (5, 4):
        message = RetainedMessage(topic, b"%d" % number, number=number)
        asyncio.run_coroutine_threadsafe(publishing._publish(publishing._ready, message), publishing._loop).result(5.0)
    with own_broker.connected("hmi", "", topic) as hmi:
        wait_until(lambda: hmi.last(topic) is not None)
        assert hmi.last(topic) == b"5"
