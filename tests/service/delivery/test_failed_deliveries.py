"""A delivery that fails is recorded with the answer, tried again, given up; its receiver may be disabled, or refused."""

import asyncio

import pytest

from service.delivery import retry_policy
from storage.alerts import deliveries
from storage.database.engine import Database
from storage.tables.findings import IdentificationRow
from tests.plant import machine, wait_until
from tests.service.delivery.dispatching import Router, delivering, rows, states
from tests.service.delivery.receivers import Receiver, raise_one, subscribe


def test_a_receiver_that_answers_rubbish_stops_no_other(
    plant: Database, found: IdentificationRow, network: Router, http: Receiver
) -> None:
    good, bad = subscribe(plant, http.url("/ok"), name="good"), subscribe(plant, http.url("/rubbish"), name="bad")
    with delivering(plant, network):
        for element in ("coupling.C1", "bearing.B1"):
            raise_one(plant, found, machine(), element=element)
            wait_until(lambda: {*states(plant, good), *states(plant, bad)} == {"delivered"})
    assert {row.answer for row in rows(plant, bad)} == {"200 \\x00\\x1b\ufffd no text"}


def test_a_receiver_that_is_gone_is_disabled(
    plant: Database, found: IdentificationRow, network: Router, http: Receiver
) -> None:
    subscription = subscribe(plant, http.url("/gone"), name="gone")
    with delivering(plant, network):
        raise_one(plant, found, machine())
        wait_until(lambda: states(plant, subscription) == ["given_up"])
        raise_one(plant, found, machine(), element="coupling.C2")
    assert len(rows(plant, subscription)) == 1
    with plant.reading() as session:
        row = deliveries.get(session, subscription)
        assert (row.state, row.reason) == ("disabled", "the receiver answered 410")


@pytest.mark.parametrize(
    ("path", "said"),
    [("/redirect", "307: redirects are not followed, give the final URL"), ("/error", "500"), ("/endless", "500 xxx")],
)
def test_a_failure_is_kept_with_what_was_answered_and_tried_again_later(
    plant: Database, found: IdentificationRow, network: Router, http: Receiver, path: str, said: str
) -> None:
    subscription = subscribe(plant, http.url(path), name="failing")
    with delivering(plant, network):
        raise_one(plant, found, machine())
        wait_until(lambda: rows(plant, subscription)[0].attempts == 1)
    (row,) = rows(plant, subscription)
    assert row.state == "pending"
    assert row.answer is not None
    assert row.answer.startswith(said)
    assert row.last_try_at is not None
    assert 4.9e9 < row.next_try_at - row.last_try_at < 5.1e9
    assert http.at("/ok") == []


def test_a_delivery_is_given_up_when_the_schedule_is_over_and_can_be_asked_for_again(
    plant: Database, found: IdentificationRow, network: Router, http: Receiver, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(retry_policy, "RETRIES_S", (0.01, 0.01))
    subscription = subscribe(plant, http.url("/flaky"), name="flaky")
    with delivering(plant, network):
        raise_one(plant, found, machine())
        wait_until(lambda: states(plant, subscription) == ["given_up"])
        assert rows(plant, subscription)[0].attempts == 3
        http.well.set()
        with plant.transaction() as session:
            deliveries.redeliver(deliveries.delivery(session, rows(plant, subscription)[0].id))
        wait_until(lambda: states(plant, subscription) == ["delivered"])
    assert len({one.headers["webhook-id"] for one in http.received}) == 1


def test_a_private_target_is_refused_at_delivery(
    plant: Database, found: IdentificationRow, network: Router, http: Receiver
) -> None:
    subscription = subscribe(plant, http.url("/ok"), name="inside")
    with delivering(plant, network, delivery_networks=[]):
        raise_one(plant, found, machine())
        wait_until(lambda: rows(plant, subscription)[0].attempts == 1)
    assert "which is no public address" in (rows(plant, subscription)[0].answer or "")
    assert http.received == []


def test_a_subscription_of_an_unknown_kind_is_an_error_and_holds_up_no_other(
    plant: Database, found: IdentificationRow, network: Router, http: Receiver
) -> None:
    """As another release left it: it is not sent by the way of some other kind."""
    unknown = subscribe(plant, http.url("/ok/unknown"), name="telex", kind="telex")
    subscribe(plant, http.url("/ok/webhook"), name="historian")
    with delivering(plant, network) as one:
        raise_one(plant, found, machine())
        wait_until(lambda: bool(http.at("/ok/webhook")) and rows(plant, unknown)[0].attempts == 1)
        assert asyncio.run(one.send_test(unknown)).result == "failed"
    (row,) = rows(plant, unknown)
    assert row.state == "pending"
    assert (
        row.answer == "'telex' is no kind of subscription that this release knows: webhook, alertmanager, email, zenoh, mqtt"
    )
    assert http.at("/ok/unknown") == []
