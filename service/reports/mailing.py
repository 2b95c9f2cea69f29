"""Sends the reports of a subscription's machines by mail: of each whole week or month, once, soon after its end.

A period is recorded as sent when all of its mails are. What was sent before the mail server failed is not repeated; a restart
in between repeats it, with the same Message-ID.
"""

import logging
import smtplib
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from email.message import EmailMessage
from typing import cast

from service.advice.site_texts import SiteTexts
from service.configuration.settings import Settings
from service.delivery.mail import NoMailServer, send_mail
from service.replication.work_share import DELIVERY, Share, WholeShare
from service.reports.contents import ReportContents
from service.reports.first_page import no_alert_text
from service.reports.period import ReportInterval, ReportPeriod, last_whole
from service.reports.printing import PrinterMissing
from service.reports.reading import read_contents
from service.reports.report_process import NotPrinted, ReportProcess
from service.resilience.supervised_thread import SupervisedThread
from service.wording.shown_units import units_of
from storage.alerts import deliveries
from storage.clock import now, to_datetime
from storage.database.engine import Database
from storage.machines import machines
from storage.tables.alerting import SubscriptionRow

logger = logging.getLogger(__name__)

LOOK_S = 60.0
"""Time between two looks for a period that has ended [s]."""
RETRY_S = 300.0
"""Time after which mails that could not be sent are tried again [s]."""


class ReportsUnsent(RuntimeError):
    """Reports could not be sent; the message says which and why."""


@dataclass(frozen=True)
class DueReport:
    """A report that is to be sent. number: number of its subscription."""

    number: int
    interval: ReportInterval
    target: str
    machine: str
    period: ReportPeriod


class ReportMailing(SupervisedThread):
    """The thread that sends reports; of several processes that of the leader does."""

    def __init__(
        self,
        database: Database,
        settings: Settings,
        texts: SiteTexts,
        share: Share | None = None,
        process: ReportProcess | None = None,
    ) -> None:
        super().__init__("report mail", failure="reports cannot be sent by mail", retry_s=RETRY_S)
        self._database = database
        self._settings = settings
        self._texts = texts
        self._share = share or WholeShare()
        self._process = process or ReportProcess()
        self._sent: set[DueReport] = set()

    @property
    def warnings(self) -> list[str]:
        """Return why reports could not be sent, if the last turn failed."""
        return [] if self.trouble is None else [self.trouble]

    def run_once(self) -> float:
        """Send what is due. Raises ReportsUnsent."""
        if self._share.is_leader(DELIVERY):
            self.send_due(to_datetime(now()))
        return LOOK_S

    def failed(self, error: Exception) -> float:
        """Keep what could not be sent as `trouble`; log other errors."""
        if not isinstance(error, ReportsUnsent):
            return super().failed(error)
        self.trouble = str(error)
        logger.error(self.trouble)
        return RETRY_S

    def stop(self) -> None:
        """Give up the report that is being printed, then stop."""
        self._stop.set()
        self._process.close()
        super().stop()

    def send_due(self, moment: datetime) -> None:
        """Send the reports of all periods that have ended; each subscription's by itself. Raises ReportsUnsent."""
        with self._database.reading() as session:
            rows = [row for row in deliveries.list_reported(session) if _due_period(row, moment) is not None]
        unsent = []
        for row in rows:
            try:
                self._send_all(row, moment)
            except (OSError, smtplib.SMTPException, NoMailServer, PrinterMissing) as error:
                unsent.append(f"reports of subscription '{row.name}' cannot be sent: {error}")
            if self._stop.is_set():
                return
        if unsent:
            raise ReportsUnsent("; ".join(unsent))

    def _send_all(self, row: SubscriptionRow, moment: datetime) -> None:
        period = _due_period(row, moment)
        if period is None:
            return
        for report in self._reports(row, period):
            if self._stop.is_set():
                return
            if report not in self._sent:
                send_mail(self._settings, self._report_mail(report))
                self._sent.add(report)
        with self._database.transaction() as session:
            kept = deliveries.get(session, row.id)
            if kept.reports is not None:  # it may have been changed meanwhile
                kept.reported_until = max(kept.reported_until or 0, period.last)
        self._sent = {one for one in self._sent if one.number != row.id}
        logger.info("reports until %s are sent to subscription '%s'", to_datetime(period.last), row.name)

    def _reports(self, row: SubscriptionRow, period: ReportPeriod) -> Sequence[DueReport]:
        interval = cast(ReportInterval, row.reports)
        with self._database.reading() as session:
            found = [one.id for one in machines.list_all(session) if deliveries.covers_plant(row, one.plant)]
        return [DueReport(row.id, interval, row.target, one, period) for one in found]

    def _report_mail(self, report: DueReport) -> EmailMessage:
        with self._database.reading() as session:
            contents = read_contents(
                session,
                report.machine,
                report.period,
                texts=self._texts,
                baseline_runs=self._settings.baseline_runs,
                units=units_of(self._settings.report_units),
            )
        try:
            return compose_report_mail(self._settings, report, contents, self._process.printed(contents))
        except NotPrinted as error:
            if self._stop.is_set():
                raise ReportsUnsent("the service stops; reports that are not sent yet are sent after its start") from error
            return compose_report_mail(self._settings, report, contents, None, missing=str(error))


def compose_report_mail(
    settings: Settings, report: DueReport, contents: ReportContents, pdf: bytes | None, *, missing: str = ""
) -> EmailMessage:
    """Compose the mail with a report. missing: why there is none."""
    alerts = contents.open_alerts
    translate = contents.language.translate
    key = "report_mail.none" if not alerts else "report_mail.one" if len(alerts) == 1 else "report_mail.many"
    count = translate(key) if len(alerts) < 2 else translate(key, count=len(alerts))
    until = f"{contents.last:%Y-%m-%d}"
    mail = EmailMessage()
    mail["From"] = settings.smtp_sender
    mail["To"] = report.target
    mail["Subject"] = translate(
        f"report_mail.subject.{report.interval}", machine=f"{contents.plant}/{report.machine}", until=until, count=count
    )
    domain = settings.smtp_sender.rpartition("@")[2]
    mail["Message-ID"] = f"<report-{report.number}-{report.machine}-{report.period.last}@{domain}>"
    lines = [f"{contents.language.named(one.last.severity)}: {one.last.message}" for one in alerts] or [
        no_alert_text(contents)
    ]
    if pdf is None:
        lines.append(translate("report_mail.missing", reason=missing))
    if settings.public_url:
        lines += ["", f"{settings.public_url}/#/machines/{report.machine}"]
    mail.set_content("\n".join(lines) + "\n")
    if pdf is not None:
        mail.add_attachment(pdf, maintype="application", subtype="pdf", filename=f"{report.machine}-{until}.pdf")
    return mail


def _due_period(row: SubscriptionRow, moment: datetime) -> ReportPeriod | None:
    """Return the last whole period of a subscription; None where it has its reports."""
    period = last_whole(cast(ReportInterval, row.reports), moment)
    return period if (row.reported_until or 0) < period.last else None
