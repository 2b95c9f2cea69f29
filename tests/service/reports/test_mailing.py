"""Reports by mail: once for each whole week, to a real mail server, with what is missing said."""

from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from email import message_from_bytes, policy
from email.message import EmailMessage

import pytest
from aiosmtpd.controller import Controller
from aiosmtpd.smtp import SMTP, Envelope, Session

from service.advice.site_texts import SiteTexts
from service.configuration.settings import Settings
from service.reports.mailing import ReportMailing, ReportsUnsent
from service.reports.report_process import ReportProcess
from storage.alerts import deliveries
from storage.clock import now, to_datetime
from storage.database.engine import Database
from tests.api_in_process import Api, fields
from tests.ports import free_port

LATER = to_datetime(now()) + timedelta(days=7)


class ReportMailbox:
    """Messages that a real SMTP server was given."""

    def __init__(self) -> None:
        self.mails: list[EmailMessage] = []

    async def handle_DATA(self, _server: SMTP, _session: Session, envelope: Envelope) -> str:
        """Keep it."""
        assert isinstance(envelope.content, bytes)
        found = message_from_bytes(envelope.content, policy=policy.default)
        assert isinstance(found, EmailMessage)
        self.mails.append(found)
        return "250 OK"


@pytest.fixture
def server() -> Iterator[tuple[ReportMailbox, int]]:
    """A mail server, and its port."""
    box, port = ReportMailbox(), free_port()
    running = Controller(box, hostname="127.0.0.1", port=port)
    running.start()
    yield box, port
    running.stop()


def mailing(database: Database, port: int, *, time_s: float = 60.0) -> ReportMailing:
    """The thread's work, without the thread."""
    settings = Settings(smtp_host="127.0.0.1", smtp_port=port, smtp_security="none")
    return ReportMailing(database, settings, SiteTexts(), process=ReportProcess(time_s=time_s))


def subscribe(database: Database) -> int:
    """Subscribe a mailbox to weekly reports; its number."""
    with database.transaction() as session:
        row = deliveries.subscribe(
            session, kind="email", name="people", target="anna@plant.example", secret=None, reports="weekly"
        )
        return row.id


def test_each_whole_week_is_sent_once(plant: Database, server: tuple[ReportMailbox, int]) -> None:
    box, port = server
    subscribe(plant)
    work = mailing(plant, port)
    work.send_due(to_datetime(now()))
    assert box.mails == []  # the week in which it subscribed is not over
    work.send_due(LATER)
    work.send_due(LATER)
    work.stop()
    (mail,) = box.mails
    assert mail["subject"].startswith("Weekly report of plant-1/pump-7 until ")
    body = mail.get_body()
    assert body is not None
    assert "cannot be judged" in body.get_content()
    (attached,) = mail.iter_attachments()
    assert attached.get_content_type() == "application/pdf"
    assert attached.get_content().startswith(b"%PDF-")


def test_a_report_that_cannot_be_printed_is_said_to_be_missing(plant: Database, server: tuple[ReportMailbox, int]) -> None:
    box, port = server
    subscribe(plant)
    work = mailing(plant, port, time_s=0.001)
    work.send_due(LATER)
    work.stop()
    (mail,) = box.mails
    body = mail.get_body()
    assert body is not None
    assert "The report itself is missing: this report cannot be made within" in body.get_content()


def test_without_a_mail_server_it_is_tried_again(plant: Database) -> None:
    number = subscribe(plant)
    work = mailing(plant, free_port())
    with pytest.raises(ReportsUnsent, match="subscription 'people' cannot be sent"):
        work.send_due(LATER)
    work.stop()
    with plant.reading() as session:
        until = deliveries.get(session, number).reported_until
    assert until is not None
    assert to_datetime(until) < datetime.now(UTC)


def test_only_mail_brings_reports(plant: Database) -> None:
    api = Api(plant)
    said = {"kind": "zenoh", "name": "plant", "reports": "weekly"}
    refusal = api.ask("POST", "/api/v1/subscriptions", json=said)
    assert "sent by email only" in str(fields(refusal)) + refusal.text
    made = api(
        "POST", "/subscriptions", 201, json={"kind": "email", "name": "b", "target": "b@c.example", "reports": "monthly"}
    )
    assert made["reports"] == "monthly"


def test_who_gets_reports_may_be_changed_and_nothing_is_sent_of_before(
    plant: Database, server: tuple[ReportMailbox, int]
) -> None:
    box, port = server
    api = Api(plant)
    number = api("POST", "/subscriptions", 201, json={"kind": "email", "name": "b", "target": "b@c.example"})["id"]
    path = f"/subscriptions/{number}/reports"
    assert api("PUT", path, 200, json={"reports": "weekly"})["reports"] == "weekly"
    work = mailing(plant, port)
    work.send_due(to_datetime(now()))
    assert box.mails == [], "the week in which it was asked for is not over"
    assert api("PUT", path, 200, json={"reports": None})["reports"] is None
    work.send_due(LATER)
    assert box.mails == []
    work.stop()
    for wrong in ({"reports": "daily"}, {}, {"reports": "weekly", "more": 1}):
        assert api.ask("PUT", f"/api/v1{path}", json=wrong).status_code == 422
    assert api.ask("PUT", "/api/v1/subscriptions/999/reports", json={"reports": None}).status_code == 404


def test_a_kind_that_carries_no_reports_gets_none(plant: Database) -> None:
    api = Api(plant)
    number = api("POST", "/subscriptions", 201, json={"kind": "zenoh", "name": "plant"})["id"]
    refusal = api.ask("PUT", f"/api/v1/subscriptions/{number}/reports", json={"reports": "weekly"})
    assert refusal.status_code == 422
    assert "sent by email only, and 'plant' is zenoh" in refusal.text
