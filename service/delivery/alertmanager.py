"""Pushes alerts to API v2 of a Prometheus Alertmanager: repeatedly while they last, and once more when they end."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from aiohttp import ClientSession

from service.advice.advice_lines import advice_lines
from service.alerts.event_message import AlertEvent
from service.alerts.lifecycle import Severity
from service.delivery.addresses import Network
from service.delivery.channel import FIRING, DeliveryOutcome, EventMessage
from service.delivery.channel_kind import ChannelKind, Connections
from service.delivery.webhook import post
from service.wording.language import ENGLISH, Language
from storage.tables.alerting import SubscriptionRow


@dataclass(frozen=True)
class Alertmanager:
    """Channel to one Alertmanager."""

    client: ClientSession
    target: str
    allowed: tuple[Network, ...]
    public_url: str
    language: Language = ENGLISH

    async def send(self, message: EventMessage) -> DeliveryOutcome:
        """Push the state of an alert after an event."""
        return await self.push([message])

    async def push(self, messages: Sequence[EventMessage]) -> DeliveryOutcome:
        """Push the states of alerts after their events."""
        body = json.dumps([alert for message in messages for alert in self._alerts(message)]).encode()
        url = self.target.rstrip("/") + "/api/v2/alerts"
        return await post(self.client, url, body, {"content-type": "application/json"}, self.allowed)

    def _alerts(self, message: EventMessage) -> list[dict[str, object]]:
        """Return the alert, and its variants of other severities as ended: labels, and so the severity, form the identity."""
        event = message.event
        ended = None if event.state in FIRING else event.at
        return [
            self._alert(message, severity.label, ended if severity.label == event.severity else event.at)
            for severity in Severity
            if severity.label == event.severity or event.number > 1
        ]

    def _alert(self, message: EventMessage, severity: str, ended: datetime | None) -> dict[str, object]:
        event: AlertEvent = message.event
        alert: dict[str, object] = {
            "labels": {
                "alertname": f"Rundown_{event.rule}",
                "plant": message.plant,
                "machine": event.machine,
                "rule": event.rule,
                "element": event.element,
                "severity": severity,
            },
            "annotations": _annotations(event, self.language),
            "startsAt": event.opened_at.isoformat(),
            "generatorURL": f"{self.public_url}/#/alerts/{event.alert}",
        }
        return alert if ended is None else alert | {"endsAt": ended.isoformat()}


def _annotations(event: AlertEvent, language: Language) -> dict[str, str]:
    said = {"summary": event.message, "state": event.state, "alert": str(event.alert)}
    return said if event.advice is None else said | {"description": "\n".join(advice_lines(event.advice, language))}


def _open(row: SubscriptionRow, connections: Connections) -> Alertmanager:
    settings = connections.settings
    return Alertmanager(
        connections.client, row.target, tuple(settings.delivery_networks), settings.public_url, connections.texts.language
    )


ALERTMANAGER = ChannelKind(
    "alertmanager",
    title={"en": "Prometheus Alertmanager", "de": "Prometheus Alertmanager"},
    description="the URL of a Prometheus Alertmanager",
    address={"en": "a URL", "de": "eine URL"},
    open=_open,
    url_target=True,
    reminded=True,
)
