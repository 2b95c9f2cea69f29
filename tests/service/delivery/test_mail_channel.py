"""Alerts by mail, through a real SMTP server on loopback."""

from typing import Any

import pytest
from aiosmtpd.controller import Controller
from aiosmtpd.smtp import SMTP, Envelope, Session

from storage.database.engine import Database
from storage.tables.findings import IdentificationRow
from tests.plant import machine, wait_until
from tests.ports import free_endpoint
from tests.service.delivery.dispatching import Router, delivering, rows, states
from tests.service.delivery.receivers import raise_one, subscribe


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
