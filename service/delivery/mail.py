"""Sends alert events as e-mail over SMTP."""

import asyncio
import re
import smtplib
import ssl
from dataclasses import dataclass
from email.message import EmailMessage

from service.advice.advice_lines import advice_lines
from service.configuration.settings import Settings
from service.delivery.channel import DeliveryOutcome, EventMessage
from service.delivery.channel_kind import ChannelKind, Connections
from service.delivery.cloud_event import event_id
from service.delivery.daemon_threads import DaemonThreads
from service.monitoring.rules.finding_catalogue import finding_name
from service.wording.language import ENGLISH, Language
from storage.tables.alerting import SubscriptionRow

TIMEOUT_S = 15.0
"""Time limit of each step of the SMTP dialogue [s]."""
ADDRESS = re.compile(r"[^\s@,;<>\"]+@[^\s@,;<>\"]+")
MAILING = DaemonThreads(8, name="mail")
"""Separate threads for mail: a hanging server blocks all of them."""


class NoMailServer(ValueError):
    """No mail server is set."""


@dataclass(frozen=True)
class Mail:
    """Channel to one address, or to several with commas between."""

    settings: Settings
    target: str
    language: Language = ENGLISH

    async def send(self, message: EventMessage) -> DeliveryOutcome:
        """Send a mail."""
        try:
            mail = compose_mail(self.settings, self.target, message, self.language)
            await asyncio.get_running_loop().run_in_executor(MAILING, send_mail, self.settings, mail)
        except (OSError, smtplib.SMTPException, NoMailServer) as error:
            return DeliveryOutcome("failed", f"{type(error).__name__}: {error}")
        return DeliveryOutcome("delivered", f"taken by {self.settings.smtp_host}:{self.settings.smtp_port}")


def send_mail(settings: Settings, mail: EmailMessage) -> None:
    """Send a mail through the server. Raises NoMailServer, OSError, SMTPException."""
    if not settings.smtp_host:
        raise NoMailServer("no mail server is set: RUNDOWN_SMTP_HOST")
    where = (settings.smtp_host, settings.smtp_port)
    context = ssl.create_default_context()
    tls = settings.smtp_security == "tls"
    with (
        smtplib.SMTP_SSL(*where, timeout=TIMEOUT_S, context=context) if tls else smtplib.SMTP(*where, timeout=TIMEOUT_S)
    ) as server:
        if settings.smtp_security == "starttls":
            server.starttls(context=context)
        if settings.smtp_user:
            server.login(settings.smtp_user, settings.smtp_password.get_secret_value())
        server.send_message(mail)


def compose_mail(settings: Settings, target: str, message: EventMessage, language: Language = ENGLISH) -> EmailMessage:
    """Compose the mail for an event. All mails of an alert share a thread; a repeated one has the same Message-ID."""
    event = message.event
    domain = settings.smtp_sender.rpartition("@")[2]
    mail = EmailMessage()
    mail["From"] = settings.smtp_sender
    mail["To"] = target
    rule, element = finding_name(event.rule, language), language.element(event.element)
    severity, state, kind = (language.named(one) for one in (event.severity, event.state, event.kind))
    mail["Subject"] = language.translate(
        "mail.subject", severity=severity, machine=event.machine, element=element, rule=rule, state=state
    )
    mail["Message-ID"] = f"<{event_id(message)}@{domain}>"
    mail["In-Reply-To"] = mail["References"] = f"<alert-{event.alert}@{domain}>"
    at = f"{event.at:%Y-%m-%d %H:%M:%S}"
    before = language.named(event.state_before)
    facts = [
        ("machine", f"{message.plant}/{event.machine}"),
        ("element", element),
        ("state", language.translate("mail.changed", before=before, now=state, kind=kind, by=event.by, at=at)),
        ("severity", severity),
        ("open_since", f"{event.opened_at:%Y-%m-%d %H:%M:%S} UTC"),
        *([("comment", event.comment)] if event.comment else []),
    ]
    lines = [event.message, "", *(f"{language.translate(f'mail.{name}'):<11}{said}" for name, said in facts)]
    if event.advice is not None:
        lines += ["", *advice_lines(event.advice, language)]
    if settings.public_url:
        places = f"#/alerts/{event.alert}", f"#/machines/{event.machine}"
        lines += ["", *(f"{settings.public_url}/{one}" for one in places)]
    mail.set_content("\n".join(lines) + "\n")
    return mail


def _open(row: SubscriptionRow, connections: Connections) -> Mail:
    return Mail(connections.settings, row.target, connections.texts.language)


def _check_target(target: str) -> None:
    """Raise ValueError for a text that is not a list of addresses."""
    if not all(ADDRESS.fullmatch(one.strip(" ")) for one in target.split(",")):
        raise ValueError("an e-mail address such as anna@plant.example, or several with commas between")


EMAIL = ChannelKind(
    "email",
    title={"en": "e-mail", "de": "E-Mail"},
    description="one address, or several with commas between",
    address={"en": "e-mail addresses with commas between", "de": "E-Mail-Adressen mit Kommas dazwischen"},
    open=_open,
    check_target=_check_target,
    reporting=True,
)
