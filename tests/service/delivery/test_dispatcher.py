"""The outbox is emptied: signed, in order for each alert, each receiver by itself, again after a failure or a kill."""

import asyncio
import json
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
import zenoh
from aiosmtpd.controller import Controller
from aiosmtpd.smtp import SMTP, Envelope, Session
from sqlalchemy import text
from standardwebhooks.webhooks import Webhook

from service.alerts import transitions
from service.alerts.transitions import Person
from service.delivery import addresses, channels, mail, retry_policy, sending
from service.delivery import dispatcher as dispatcher_module
from service.delivery.dispatcher import Dispatcher
from service.delivery.outbox import AT_ONCE
from service.delivery.zenoh_channel import LastStates
from service.messaging.session import open_session
from service.replication.work_share import WholeShare
from service.secrets.sealing import Sealing
from storage.alerts import alerts, deliveries
from storage.database.engine import Database
from storage.tables.alerting import DeliveryRow
from storage.tables.findings import IdentificationRow
from tests.plant import machine, wait_until
from tests.ports import free_endpoint
from tests.service.delivery.receivers import Receiver, raise_one, settings, subscribe

ANNA = Person("anna")
Router = tuple[zenoh.Session, str]


@contextmanager
def delivering(database: Database, network: Router, **changes: Any) -> Iterator[Dispatcher]:
    one = Dispatcher(database, network[0], settings(**changes))
    one.start()
    try:
        yield one
    finally:
        one.stop()


def rows(database: Database, subscription: int) -> list[DeliveryRow]:
    with database.reading() as session:
        return list(deliveries.of_subscription(session, subscription, limit=1000))[::-1]


def states(database: Database, subscription: int) -> list[str]:
    return [row.state for row in rows(database, subscription)]


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


def with_patience(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no attempt end by its time: whoever is served meanwhile has waited for none that hangs."""
    for module, limit in ((channels, "TIMEOUT_S"), (mail, "TIMEOUT_S"), (sending, "DEADLINE_S")):
        monkeypatch.setattr(module, limit, 600.0)


def test_receivers_that_hang_or_fail_delay_no_other(
    plant: Database, found: IdentificationRow, network: Router, http: Receiver, monkeypatch: pytest.MonkeyPatch
) -> None:
    with_patience(monkeypatch)
    hanging = [subscribe(plant, http.url(f"/hang/{number}"), name=f"hangs {number}") for number in range(10)]
    failing = [subscribe(plant, http.url(f"/error/{number}"), name=f"fails {number}") for number in range(10)]
    healthy = subscribe(plant, http.url("/ok"), name="healthy")
    with delivering(plant, network):
        for number in range(20):
            raise_one(plant, found, machine(), element=f"coupling.C{number}")
        wait_until(lambda: states(plant, healthy) == ["delivered"] * 20)
        wait_until(lambda: all(row.attempts for each in failing for row in rows(plant, each)))
        wait_until(lambda: all(len(http.at(f"/hang/{number}")) == AT_ONCE for number in range(10)))
        # A receiver that hangs holds up a few deliveries, not all of them, and none of them has ended.
        assert not any(row.attempts for each in hanging for row in rows(plant, each))


def test_a_mail_server_that_says_nothing_delays_no_other(
    plant: Database, found: IdentificationRow, network: Router, http: Receiver, monkeypatch: pytest.MonkeyPatch
) -> None:
    with_patience(monkeypatch)
    with silent_mail_server() as how:
        people = [subscribe(plant, "anna@plant.example", name=f"people {number}", kind="email") for number in range(3)]
        for number in range(4):
            raise_one(plant, found, machine(), element=f"coupling.C{number}")
        healthy = subscribe(plant, http.url("/ok"), name="healthy")
        with delivering(plant, network, **how) as one:
            wait_until(lambda: len(one._under_way) == 12)
            raise_one(plant, found, machine(), element="bearing.B1")
            wait_until(lambda: states(plant, healthy) == ["delivered"])
            # The delivery that was made is put away a moment after it is stored; those that hang stay.
            wait_until(lambda: len(one._under_way) == 12)
            assert not any(row.attempts for each in people for row in rows(plant, each))


def test_a_mail_that_its_server_does_not_take_in_time_has_failed(
    plant: Database, found: IdentificationRow, network: Router, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sending, "DEADLINE_S", 0.3)
    people = subscribe(plant, "anna@plant.example", name="people", kind="email")
    raise_one(plant, found, machine())
    with silent_mail_server() as how, delivering(plant, network, **how):
        wait_until(lambda: rows(plant, people)[0].attempts == 1)
    assert rows(plant, people)[0].answer == "it was not done within 0.3 s"


@contextmanager
def silent_mail_server() -> Iterator[dict[str, Any]]:
    """Settings for a mail server that takes connections and says nothing."""
    with socket.create_server(("127.0.0.1", 0), backlog=64) as silent:
        yield {"smtp_host": "127.0.0.1", "smtp_port": silent.getsockname()[1], "smtp_security": "none"}


def test_name_servers_that_do_not_answer_delay_nobody_who_is_given_by_address(
    plant: Database, found: IdentificationRow, network: Router, http: Receiver, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sending, "DEADLINE_S", 0.3)
    named = subscribe(plant, f"http://localhost:{http.port}/ok", name="named")
    addressed = subscribe(plant, http.url("/ok"), name="addressed")
    answered = threading.Event()
    taken = [addresses.LOOK_UPS.submit(answered.wait, 600.0) for _ in range(addresses.LOOK_UPS.count)]
    try:
        with delivering(plant, network):
            raise_one(plant, found, machine())
            wait_until(lambda: states(plant, addressed) == ["delivered"])
            wait_until(lambda: rows(plant, named)[0].attempts == 1)
    finally:
        answered.set()
    assert all(one.result(5.0) for one in taken)
    assert rows(plant, named)[0].answer == "it was not done within 0.3 s"


def test_alertmanagers_that_hang_delay_no_reminder_of_another(
    plant: Database, found: IdentificationRow, network: Router, http: Receiver, monkeypatch: pytest.MonkeyPatch
) -> None:
    with_patience(monkeypatch)
    subscribe(plant, http.url("/hang"), name="hangs", kind="alertmanager")
    subscribe(plant, http.url("/ok"), name="healthy", kind="alertmanager")
    raise_one(plant, found, machine())
    with delivering(plant, network):
        # Once by the delivery, once as it lasts.
        wait_until(lambda: len(http.at("/ok/api/v2/alerts")) == 2)


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


# --- zenoh ----------------------------------------------------------------------------------------------------------


def test_the_network_hears_events_and_answers_with_the_last_state(
    plant: Database, found: IdentificationRow, network: Router
) -> None:
    session, endpoint = network
    subscription = subscribe(plant, "", name="network", kind="zenoh")
    states_of = LastStates(session, plant)
    with open_session(listen=[], connect=[endpoint]) as client:
        heard: list[zenoh.Sample] = []
        listener = client.declare_subscriber("rundown/v1/*/*/alerts/*", heard.append)
        time.sleep(0.3)  # the declaration is on its way to the router
        with delivering(plant, network):
            alert = raise_one(plant, found, machine())
            wait_until(lambda: states(plant, subscription) == ["delivered"])
            wait_until(lambda: len(heard) == 1)
        plant_name = machine().plant
        assert str(heard[0].key_expr) == f"rundown/v1/{plant_name}/pump-7/alerts/{alert}"
        assert json.loads(bytes(heard[0].payload))["kind"] == "raised"
        with plant.transaction() as reading:
            transitions.acknowledge(reading, alerts.get(reading, alert), ANNA)
        replies = [json.loads(bytes(one.ok.payload)) for one in client.get("rundown/v1/**/alerts/*", timeout=5.0) if one.ok]
        assert [(one["alert"], one["state"]) for one in replies] == [(alert, "acknowledged")]
        other = [one for one in client.get("rundown/v1/other/*/alerts/*", timeout=5.0) if one.ok]
        assert other == []
        listener.undeclare()
    states_of.close()


def test_an_alert_that_cannot_be_reported_keeps_no_other_from_being_answered(
    plant: Database, found: IdentificationRow, network: Router
) -> None:
    session = network[0]
    numbers = [raise_one(plant, found, machine(), element=f"coupling.C{number}") for number in range(3)]
    with plant.transaction() as writing:
        # There is no such severity.
        writing.execute(text(f"UPDATE alert_events SET severity = 9 WHERE alert_id = {numbers[1]}"))
    states_of = LastStates(session, plant)
    replies = [json.loads(bytes(one.ok.payload)) for one in session.get("rundown/v1/**/alerts/*", timeout=5.0) if one.ok]
    states_of.close()
    assert {one["alert"] for one in replies} == {numbers[0], numbers[2]}


# --- e-mail ---------------------------------------------------------------------------------------------------------


class Mailbox:
    """Messages that a real SMTP server was given."""

    def __init__(self) -> None:
        self.mails: list[Envelope] = []

    async def handle_DATA(self, _server: SMTP, _session: Session, envelope: Envelope) -> str:
        self.mails.append(envelope)
        return "250 taken"


def test_a_mail_says_what_happened(plant: Database, found: IdentificationRow, network: Router) -> None:
    box = Mailbox()
    port = int(free_endpoint().rpartition(":")[2])
    server = Controller(box, hostname="127.0.0.1", port=port)
    server.start()
    try:
        subscription = subscribe(plant, "anna@plant.example, ben@plant.example", name="people", kind="email")
        how = {"smtp_host": "127.0.0.1", "smtp_port": port, "smtp_security": "none", "public_url": "http://rundown:8080"}
        with delivering(plant, network, **how):
            alert = raise_one(plant, found, machine())
            wait_until(lambda: states(plant, subscription) == ["delivered"])
    finally:
        server.stop()
    (mail,) = box.mails
    assert mail.rcpt_tos == ["anna@plant.example", "ben@plant.example"]
    assert isinstance(mail.content, bytes)
    said = mail.content.decode()
    assert "Subject: [alert] pump-7 coupling C1: misalignment unacknowledged" in said
    assert f"Message-ID: <alert-{alert}-1@localhost>" in said
    assert f"http://rundown:8080/#/alerts/{alert}" in said
    assert "Misalignment of coupling C1" in said


@pytest.mark.parametrize(
    ("how", "said"),
    [({}, "RUNDOWN_SMTP_HOST"), ({"smtp_host": "127.0.0.1", "smtp_port": 1, "smtp_security": "none"}, "ConnectionRefused")],
)
def test_an_absent_mail_server_is_a_failure_to_be_tried_again(
    plant: Database, found: IdentificationRow, network: Router, how: dict[str, Any], said: str
) -> None:
    subscription = subscribe(plant, "anna@plant.example", name="people", kind="email")
    with delivering(plant, network, **how):
        raise_one(plant, found, machine())
        wait_until(lambda: rows(plant, subscription)[0].attempts == 1)
    (row,) = rows(plant, subscription)
    assert row.state == "pending"
    assert said in (row.answer or "")


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
