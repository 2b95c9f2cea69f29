"""Messages of the store for the broker: the last event of each alert, and identifications as they are filed."""

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sqlalchemy.orm import Session

from service.advice.advice import FAULTS_OF_CONTENT
from service.advice.alert_advice import alert_event
from service.advice.site_texts import SiteTexts
from service.alerts.event_message import AlertEvent
from service.mqtt.topics import Topics
from service.mqtt.trend_message import trend_message
from storage.alerts import alerts, deliveries
from storage.database.engine import Database
from storage.findings import filed_estimates
from storage.findings.jobs import RUN
from storage.machines import machines
from storage.tables.alerting import AlertEventRow, SubscriptionRow
from storage.tables.findings import IdentificationRow

logger = logging.getLogger(__name__)

KIND = "mqtt"
"""Kind of the subscriptions that ask for it."""
MOST_READ = 100
"""Identifications that are read at once."""
LARGEST_LAST_STATES = 10_000
"""Most alerts whose last state is published at a connection, the newest first."""
OVERLAP = 50
"""Identifications before the last one that are looked at again: several replicas file at once."""

SubscriptionMarks = frozenset[tuple[int, tuple[str, ...] | None]]
"""Subscriptions by their ids, with the plants that each asks for; None for all."""


@dataclass(frozen=True)
class RetainedMessage:
    """A message that the broker keeps, or only passes on. number: number of the event; 0 for trends."""

    topic: str
    payload: bytes
    retain: bool = True
    number: int = 0


class StoredMessages:
    """Messages of what is stored, for plants with subscriptions. For one call at a time, `of_event` aside.

    published_for: the subscriptions for which the last states were published.
    """

    def __init__(self, database: Database, topics: Topics, texts: SiteTexts) -> None:
        self._database = database
        self._topics = topics
        self._texts = texts
        self._seen: dict[int, None] = {}  # identifications that were looked at, in order
        self._newest_measured: dict[str, int] = {}
        self.published_for: SubscriptionMarks = frozenset()

    def of_event(self, plant: str, event: AlertEvent) -> RetainedMessage:
        """Return the message of an alert event."""
        topic = self._topics.alert(plant, event.machine, rule=event.rule, element=event.element)
        return RetainedMessage(topic, event.model_dump_json().encode(), retain=event.id > 0, number=event.id)

    def last_states(self, *, connecting: bool = False) -> list[RetainedMessage]:
        """Return the last event of each alert and the newest identification of each machine, of plants with subscriptions.

        connecting: whether a connection begins: what was filed before is then no news.
        """
        with self._database.reading() as session:
            told = _subscribed(session)
            self.published_for = _marks(told)
            if connecting:
                self._seen |= _filed_lately(session)
            if not told:
                return []
            plants = {row.id: row.plant for row in machines.list_all(session) if _covers(told, row.plant)}
            rows = [one for one in alerts.last_events(session, limit=LARGEST_LAST_STATES) if one.machine_id in plants]
            last = (self._last_state(plants[one.machine_id], one) for one in rows)
            found = [one for one in last if one is not None]
            newest = filed_estimates.newest_of_each_machine(session)
            self._seen |= dict.fromkeys(one.id for one in newest)
            messages = self._trends_of(session, [one for one in newest if one.machine_id in plants], plants)
        return found + messages

    def _last_state(self, plant: str, row: AlertEventRow) -> RetainedMessage | None:
        """Return the message of an alert's last event; None for what cannot be told, which must not hold up the others."""
        try:
            return self.of_event(plant, alert_event(row, self._texts))
        except FAULTS_OF_CONTENT:
            logger.exception("the last event of alert %d cannot be published", row.alert_id)
            return None

    def due(self) -> list[RetainedMessage]:
        """Return the identifications since the last look, and all last states where subscriptions ask for them by now."""
        with self._database.reading() as session:
            asked = _marks(_subscribed(session))
        messages = self._new_trends()
        if asked - self.published_for:
            return messages + self.last_states()
        self.published_for = asked
        return messages

    def _new_trends(self) -> list[RetainedMessage]:
        """Return the identifications that were filed since the last look."""
        with self._database.reading() as session:
            after = max(self._seen, default=0) - OVERLAP
            filed = filed_estimates.filed(session, after=after, limit=MOST_READ, held_back_ns=0)
            rows = [row for row in filed if row.id not in self._seen]
            told = _subscribed(session) if rows else []
            plants = {row.id: row.plant for row in machines.list_all(session) if _covers(told, row.plant)} if told else {}
            messages = self._trends_of(session, [row for row in rows if row.machine_id in plants], plants)
        self._seen |= dict.fromkeys(row.id for row in rows)
        while len(self._seen) > 4 * OVERLAP:
            del self._seen[min(self._seen)]
        return messages

    def _trends_of(
        self, session: Session, rows: Sequence[IdentificationRow], plants: Mapping[str, str]
    ) -> list[RetainedMessage]:
        """Return the messages of identifications; the newest accepted one of single runs is kept by the broker."""
        found = []
        for row in rows:
            values = filed_estimates.values_of(session, [row.id])
            retain = row.scope == RUN and row.accepted and row.measured_at >= self._newest_measured.get(row.machine_id, 0)
            if retain:
                self._newest_measured[row.machine_id] = row.measured_at
            plant = plants[row.machine_id]
            found.append(
                RetainedMessage(self._topics.trends(plant, row.machine_id), trend_message(plant, row, values), retain)
            )
        return found


def _filed_lately(session: Session) -> dict[int, None]:
    """Return the newest identification, and those before it that a look would find: others may still be filed among them."""
    newest = filed_estimates.newest_id(session)
    rows = filed_estimates.filed(session, after=newest - OVERLAP, limit=MOST_READ, held_back_ns=0)
    return dict.fromkeys([newest, *(one.id for one in rows)])


def _subscribed(session: Session) -> list[SubscriptionRow]:
    """Return the active subscriptions over MQTT."""
    return [row for row in deliveries.list_subscriptions(session) if row.kind == KIND and row.state == deliveries.ACTIVE]


def _marks(told: Sequence[SubscriptionRow]) -> SubscriptionMarks:
    """Return marks that differ as soon as other subscriptions, or other plants, are active."""
    plants = ((row.id, deliveries.subscribed_plants(row)) for row in told)
    return frozenset((number, None if some is None else tuple(sorted(some))) for number, some in plants)


def _covers(told: Sequence[SubscriptionRow], plant: str) -> bool:
    return any(deliveries.covers_plant(row, plant) for row in told)
