"""Events, deliveries, endings and secrets whose records are damaged or gone hold up no other delivery."""

import asyncio

import pytest
from sqlalchemy import text

from service.alerts import transitions
from service.delivery import dispatcher as dispatcher_module
from service.secrets.sealing import Sealing
from storage.alerts import alerts, deliveries
from storage.database.engine import Database
from storage.tables.findings import IdentificationRow
from tests.plant import machine, wait_until
from tests.service.delivery.dispatching import ANNA, Router, delivering, rows, states
from tests.service.delivery.receivers import Receiver, raise_one, subscribe


def test_an_event_that_cannot_be_reported_is_given_up_and_holds_up_no_other(
    plant: Database, found: IdentificationRow, network: Router, http: Receiver
) -> None:
    subscription = subscribe(plant, http.url("/ok"), name="historian")
    damaged = raise_one(plant, found, machine())
    with plant.transaction() as session:
        session.execute(text("UPDATE alert_events SET severity = 9"))  # there is no such severity
        transitions.acknowledge(session, alerts.get(session, damaged), ANNA)
    raise_one(plant, found, machine(), element="coupling.C2")
    with delivering(plant, network) as one:
        wait_until(lambda: states(plant, subscription) == ["given_up", "delivered", "delivered"])
        wait_until(lambda: one.trouble is None)
    answer = rows(plant, subscription)[0].answer
    assert answer == "event 1 cannot be made into a message: ValueError: 9 is not a valid Severity"


def test_a_delivery_whose_record_is_gone_holds_up_no_other(
    plant: Database, found: IdentificationRow, network: Router, http: Receiver
) -> None:
    hanging = subscribe(plant, http.url("/hang"), name="hangs")
    with delivering(plant, network) as one:
        raise_one(plant, found, machine())
        wait_until(lambda: len(http.received) == 1)
        with plant.transaction() as session:
            session.execute(text("DELETE FROM deliveries"))
            deliveries.disable(session, deliveries.get(session, hanging), "by request")
        http.over.set()
        healthy = subscribe(plant, http.url("/ok"), name="healthy")
        wait_until(lambda: not one._under_way)
        raise_one(plant, found, machine(), element="coupling.C2")
        wait_until(lambda: states(plant, healthy) == ["delivered"])
        assert one.trouble is None


def test_an_ending_that_cannot_be_recorded_is_reported_and_holds_up_no_other(
    plant: Database, found: IdentificationRow, network: Router, http: Receiver, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is not sent again meanwhile: its receiver had it."""
    monkeypatch.setattr(dispatcher_module, "RETRY_S", 0.05)
    first, second = (subscribe(plant, http.url(f"/held/{name}"), name=name) for name in ("first", "second"))
    with delivering(plant, network) as one:
        raise_one(plant, found, machine())
        wait_until(lambda: len(http.received) == 2)
        with plant.transaction() as session:
            # One more try is a number that no database takes.
            session.execute(text(f"UPDATE deliveries SET attempts = {2**63 - 1} WHERE subscription_id = {first}"))
        http.well.set()
        wait_until(lambda: states(plant, second) == ["delivered"])
        wait_until(lambda: one.trouble is not None)
        assert one.trouble == "how 1 alert deliveries ended cannot be recorded; the log says why"
        raise_one(plant, found, machine(), element="coupling.C2")
        wait_until(lambda: states(plant, second) == ["delivered"] * 2)
        assert len(http.at("/held/first")) == 2
        with plant.transaction() as session:
            session.execute(text("UPDATE deliveries SET attempts = 0 WHERE state = 'pending'"))
        wait_until(lambda: states(plant, first) == ["delivered"] * 2)
        wait_until(lambda: one.trouble is None)


def test_a_webhook_whose_secret_cannot_be_had_is_stated_and_holds_up_no_other(
    plant: Database, found: IdentificationRow, network: Router, http: Receiver
) -> None:
    lost = subscribe(plant, http.url("/ok/lost"), name="lost", secret=Sealing([bytes(32)]).seal(b"x", place="subscription 1"))
    subscribe(plant, http.url("/ok/old"), name="old")
    with delivering(plant, network) as one:
        raise_one(plant, found, machine())
        wait_until(lambda: bool(http.at("/ok/old")) and rows(plant, lost)[0].attempts == 1)
        (row,) = rows(plant, lost)
        assert row.state == "pending"
        assert "sealed" in (row.answer or "")
        wait_until(lambda: one.watch.gauges == {"rundown_webhooks_unsigned": 1})
        unsigned, plain = one.watch.warnings
        assert unsigned.startswith("webhook 'lost' is told nothing: its secret is sealed")
        assert plain.startswith("the secret of webhook 'old' is stored unencrypted")
        assert one.trouble is None
        assert asyncio.run(one.send_test(lost)).result == "failed"
    assert http.at("/ok/lost") == []
