"""The outbox is emptied: signed, in order for each alert, again after a stop, and whatever goes wrong is reported."""

import asyncio

import pytest
from standardwebhooks.webhooks import Webhook

from service.alerts import transitions
from service.alerts.transitions import Person
from service.delivery import dispatcher as dispatcher_module
from service.delivery import retry_policy
from service.delivery.dispatcher import Dispatcher
from service.replication.work_share import WholeShare
from storage.alerts import alerts
from storage.database.engine import Database
from storage.tables.findings import IdentificationRow
from tests.plant import machine, wait_until
from tests.service.delivery.dispatching import ANNA, Router, delivering, rows, states
from tests.service.delivery.receivers import Receiver, raise_one, settings, subscribe


def test_a_webhook_gets_signed_cloud_events(
    plant: Database, found: IdentificationRow, network: Router, http: Receiver
) -> None:
    secret = "whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw"
    subscription = subscribe(plant, http.url("/ok"), name="historian", secret=secret)
    with delivering(plant, network):
        alert = raise_one(plant, found, machine())
        wait_until(lambda: states(plant, subscription) == ["delivered"])
    (one,) = http.received
    assert one.headers["content-type"] == "application/cloudevents+json"
    event = Webhook(secret).verify(one.body, one.headers)
    assert event == one.json
    assert event["specversion"] == "1.0"
    assert event["type"] == "rundown.alert.raised"
    assert event["source"] == f"/rundown/{machine().plant}/pump-7"
    assert event["id"] == one.headers["webhook-id"] == f"alert-{alert}-1"
    assert event["data"]["state"] == "unacknowledged"
    assert event["data"]["message"] == "Misalignment of coupling C1"
    assert rows(plant, subscription)[0].answer == "204"


def test_events_of_an_alert_arrive_in_order_while_another_alert_waits(
    plant: Database, found: IdentificationRow, network: Router, http: Receiver, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(retry_policy, "RETRIES_S", (0.1,) * 40)
    subscription = subscribe(plant, http.url("/flaky"), name="historian")
    first = raise_one(plant, found, machine())
    second = raise_one(plant, found, machine(), element="coupling.C2")
    with plant.transaction() as session:
        transitions.acknowledge(session, alerts.get(session, first), ANNA)
        for number in range(5):
            transitions.comment(session, alerts.get(session, first), Person("anna", f"{number}"))
    with delivering(plant, network):
        wait_until(lambda: len(http.received) >= 4)
        # Until the first event of each alert is taken, no later one is sent.
        assert {(one.json["data"]["alert"], one.json["data"]["number"]) for one in http.received} == {(first, 1), (second, 1)}
        http.well.set()
        wait_until(lambda: set(states(plant, subscription)) == {"delivered"})
    taken = [one.json["data"]["number"] for one in http.received if one.json["data"]["alert"] == first]
    assert taken == sorted(taken)
    assert taken[-1] == 7
    assert all(row.attempts > 1 for row in rows(plant, subscription) if row.event_id in (1, 2))


def test_what_was_under_way_at_a_stop_is_delivered_after_the_next_start(
    plant: Database, found: IdentificationRow, network: Router, http: Receiver
) -> None:
    subscription = subscribe(plant, http.url("/hang"), name="slow")
    with delivering(plant, network):
        raise_one(plant, found, machine())
        wait_until(lambda: len(http.received) == 1)
    assert states(plant, subscription) == ["pending"]
    with delivering(plant, network):
        wait_until(lambda: len(http.received) == 2)
    assert len({one.headers["webhook-id"] for one in http.received}) == 1


def test_a_test_message_says_that_it_is_one(plant: Database, network: Router, http: Receiver) -> None:
    subscription = subscribe(plant, http.url("/ok"), name="historian")
    one = Dispatcher(plant, network[0], settings())
    outcome = asyncio.run(one.send_test(subscription))
    assert (outcome.result, outcome.answer) == ("delivered", "204")
    assert http.received[0].json["type"] == "rundown.alert.test"
    assert rows(plant, subscription) == []


def test_what_nobody_expected_is_reported_until_it_is_over(
    plant: Database, network: Router, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(dispatcher_module, "RETRY_S", 0.05)

    class FailingShare(WholeShare):
        clear = False

        def is_leader(self, work: str) -> bool:
            if not self.clear:
                raise LookupError(work)
            return True

    share = FailingShare()
    one = Dispatcher(plant, network[0], settings(), share)
    one.start()
    try:
        wait_until(lambda: one.trouble == "alert deliveries cannot be read or recorded: unexpected error; the log has it")
        share.clear = True
        wait_until(lambda: one.trouble is None)
    finally:
        one.stop()
