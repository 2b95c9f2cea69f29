"""Receivers, mail servers and name servers that do not answer delay nobody else."""

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from service.delivery import addresses, channels, mail, sending
from service.delivery.outbox import AT_ONCE
from storage.database.engine import Database
from storage.tables.findings import IdentificationRow
from tests.plant import machine, wait_until
from tests.service.delivery.dispatching import Router, delivering, rows, states
from tests.service.delivery.receivers import Receiver, raise_one, subscribe


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
