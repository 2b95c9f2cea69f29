"""The threads of a service process: the selection by role, and their states."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import zenoh

from service.advice.site_texts import SiteTexts
from service.api.operation.health import ENDED
from service.configuration.settings import Settings
from service.delivery.dispatcher import Dispatcher
from service.delivery.signing_secrets import SigningSecrets
from service.identification.scheduler import JobScheduler
from service.ingest.ingest_thread import Ingest
from service.maintenance.backup_check import BackupCheck
from service.maintenance.housekeeping import Housekeeping
from service.maintenance.store_check import StoreCheck
from service.opcua.serving import OpcUaServing
from service.replication.lease_keeper import LeaseKeeper
from service.reports.mailing import ReportMailing
from service.runs.closing import Closing
from service.runs.collector import Collector
from service.security.audit_watch import AuditWatch
from service.security.certificates import days_left
from service.write_path.http_queue import Submissions, SubmissionSink
from service.write_path.sample_writer import SampleWriter
from storage.database.engine import Database

if TYPE_CHECKING:
    from service.mqtt.publisher import MqttAlerts


class ServiceThread(Protocol):
    """A thread of the service."""

    def start(self) -> None:
        """Start the thread."""

    def stop(self) -> None:
        """Stop the thread and wait for it."""


class ServicePart(ServiceThread, Protocol):
    """A thread whose state `/health` shows."""

    trouble: str | None

    @property
    def alive(self) -> bool:
        """Return whether the thread runs."""


class ServiceThreads:
    """All threads of a service process; those of its role run."""

    def __init__(
        self,
        database: Database,
        session: zenoh.Session,
        settings: Settings,
        secrets: SigningSecrets,
        texts: SiteTexts | None = None,
    ) -> None:
        """Create the threads without starting them. session: zenoh's session. texts: texts of findings."""
        self._database = database
        self._settings = settings
        self.texts = texts or SiteTexts()
        self.submissions = Submissions()
        self.leasing = LeaseKeeper(database, settings.role)
        collector = Collector(late_s=settings.late_s)
        writer = SampleWriter(database, collector, self.leasing)
        self._ingest = Ingest(session, writer, silence_s=settings.silence_s, submissions=self.submissions, share=self.leasing)
        self._closing = Closing(database, collector, self.leasing)
        self._scheduler = JobScheduler(database, settings, self.leasing)
        self._broker_gauges: list[Callable[[], Mapping[str, float]]] = []
        self._alerts_to_broker = self._publisher()
        self.dispatcher = Dispatcher(
            database, session, settings, self.leasing, secrets, broker=self._alerts_to_broker, texts=self.texts
        )
        self._housekeeping = Housekeeping(database, settings, self.leasing)
        self._backup_watch = BackupCheck(settings.backups)
        self._store_watch = StoreCheck(database)
        self._audit_watch = AuditWatch(database)
        serves_opcua = settings.opcua_listen and settings.role in ("all", "opcua")
        self._opcua = OpcUaServing(database, settings, self.texts) if serves_opcua else None
        self._report_mailing = ReportMailing(database, settings, self.texts, self.leasing)
        self._parts = dict(self._parts_of_role())

    def start(self, closing: ExitStack) -> None:
        """Start the threads of the role; `closing` stops them in the reverse order."""
        watches: list[ServiceThread] = [self._backup_watch, self._audit_watch]
        if self._settings.role in ("all", "identify"):
            watches.append(self._report_mailing)
        for thread in (self._store_watch, *self._parts.values(), self._housekeeping, *watches):
            thread.start()
            closing.callback(thread.stop)

    def take_from_broker(self, sink: SubmissionSink, closing: ExitStack) -> None:
        """Start taking samples from the MQTT broker, if one is configured and this role stores samples."""
        settings = self._settings
        if not settings.mqtt_url or settings.mqtt_samples == "left" or settings.role not in ("all", "ingest"):
            return
        from service.mqtt.sample_intake import MqttSamples  # nobody else needs its library

        samples = MqttSamples(settings, self._database, sink, self.leasing)
        self._parts["mqtt_samples"] = samples
        self._broker_gauges.append(lambda: samples.gauges)
        samples.start()
        closing.callback(samples.stop)

    def _publisher(self) -> "MqttAlerts | None":
        """Return the publisher of alerts over MQTT, if a broker is configured and this role delivers."""
        if not self._settings.mqtt_url or self._settings.role not in ("all", "identify"):
            return None
        from service.mqtt.publisher import MqttAlerts

        publisher = MqttAlerts(self._settings, self._database, self.leasing, self.texts)
        self._broker_gauges.append(lambda: publisher.gauges)
        return publisher

    def states(self) -> dict[str, str]:
        """Return the state of each part that runs here: `ok`, or the fault."""
        return {name: _state(part) for name, part in self._parts.items()}

    def warnings(self) -> list[str]:
        """Return warnings that concern no part's state."""
        return [
            *self._housekeeping.warnings,
            *self._ingest.warnings,
            *self._scheduler.warnings,
            *self.dispatcher.watch.warnings,
            *self._audit_watch.warnings,
            *self._store_watch.warnings,
            *self._report_mailing.warnings,
        ]

    def gauges(self) -> Mapping[str, float]:
        """Return figures for a monitoring system."""
        of_broker = {name: value for one in self._broker_gauges for name, value in one().items()}
        return (
            {"rundown_longest_transaction_seconds": self._database.longest_transaction.seconds}
            | of_broker
            | self._housekeeping.gauges
            | self._ingest.gauges
            | self._scheduler.gauges
            | _certificate_gauges(self._settings)
            | self._backup_watch.gauges
            | self._audit_watch.gauges
            | self.dispatcher.watch.gauges
            | (self._opcua.gauges if self._opcua is not None else {})
        )

    def _parts_of_role(self) -> Iterator[tuple[str, ServicePart]]:
        """Yield the parts of the role by name, in the order in which they start; they stop in the reverse order.

        Identifications are given up first: on a busy machine their processes would slow down the storing of what has come.
        """
        yield "leasing", self.leasing
        if self._opcua is not None:
            yield "opcua", self._opcua
        if self._settings.role in ("all", "ingest"):
            yield "ingest", self._ingest
            yield "closing", self._closing
        if self._settings.role in ("all", "identify"):
            if self._alerts_to_broker is not None:
                yield "mqtt_alerts", self._alerts_to_broker
            yield "delivery", self.dispatcher
            yield "identifying", self._scheduler


def _state(part: ServicePart) -> str:
    if not part.alive:
        return ENDED
    return part.trouble or "ok"


def _certificate_gauges(settings: Settings) -> dict[str, float]:
    """Return the shortest remaining validity of the certificates, if any; an unreadable one counts as expired."""
    named = (
        settings.tls_certificate,
        settings.zenoh_tls_certificate,
        settings.mqtt_tls_certificate,
        settings.opcua_certificate,
    )
    files = [Path(one) for one in named if one]
    if not files:
        return {}
    try:
        return {"rundown_certificate_days_left": min(map(days_left, files))}
    except (OSError, ValueError):
        return {"rundown_certificate_days_left": 0.0}
