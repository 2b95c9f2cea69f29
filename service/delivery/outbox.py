"""The outbox: deliveries in the database that are due, and the outcomes of finished ones."""

import logging
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

from sqlalchemy.exc import DataError, DBAPIError, IntegrityError
from sqlalchemy.orm import Session

from service.delivery.channel import Channel, DeliveryOutcome, EventMessage
from service.delivery.channel_kind import Connections
from service.delivery.channels import open_channel
from service.delivery.messages import message_of
from service.delivery.retry_policy import give_up, record_outcome
from storage.alerts import deliveries
from storage.clock import now
from storage.database.damage import is_damage
from storage.database.engine import Database
from storage.database.errors import is_database_wide
from storage.tables.alerting import AlertEventRow, DeliveryRow

logger = logging.getLogger(__name__)

AT_ONCE = 4
"""Largest number of concurrent deliveries to one subscription: a hanging receiver delays no others."""
LARGEST_TAKE = 500
"""Largest number of deliveries begun at once."""


@dataclass(frozen=True)
class Delivery:
    """A delivery to be sent."""

    id: int
    subscription_id: int
    message: EventMessage
    channel: Channel


class Outbox:
    """Outbox of the deliveries in the database."""

    def __init__(self, database: Database) -> None:
        self._database = database

    def due(self, under_way: Mapping[int, Delivery], connections: Connections) -> list[Delivery]:
        """Return the due deliveries that are not under way; give up those whose message cannot be made."""
        load = Counter(one.subscription_id for one in under_way.values())
        busy = [subscription for subscription, count in load.items() if count >= AT_ONCE]
        found: list[Delivery] = []
        unsayable: dict[int, str] = {}
        with self._database.reading() as session:
            for row in deliveries.due(session, now(), busy=busy, limit=LARGEST_TAKE):
                if row.id in under_way or load[row.subscription_id] >= AT_ONCE:
                    continue
                try:
                    with session.begin_nested():
                        found.append(_delivery(session, row, connections))
                    load[row.subscription_id] += 1
                except MemoryError:
                    raise  # of the moment, not of the row
                except Exception as error:
                    if is_database_wide(error):
                        raise  # so is this
                    logger.exception("delivery %d of event %d cannot be made into a message", row.id, row.event_id)
                    unsayable[row.id] = f"event {row.event_id} cannot be made into a message: {type(error).__name__}: {error}"
        if unsayable:
            self._give_up(unsayable)
        return found

    def _give_up(self, reasons: Mapping[int, str]) -> None:
        """Give deliveries up: later events of the same alerts wait behind them."""
        with self._database.transaction() as session:
            for number, reason in reasons.items():
                give_up(session, number, reason)

    def record(self, finished: Mapping[int, DeliveryOutcome]) -> list[int]:
        """Store the outcomes of deliveries; return those that are settled. One that cannot be stored stops no other."""
        try:
            return self._record_together(finished)
        except DBAPIError as error:
            if is_database_wide(error):
                raise
        done = []
        for number, outcome in finished.items():
            try:
                done += self._record_together({number: outcome})
            except DBAPIError as error:
                if is_database_wide(error):
                    raise
                logger.error("how delivery %d ended cannot be recorded: %s", number, error.orig)
        return done

    def _record_together(self, finished: Mapping[int, DeliveryOutcome]) -> list[int]:
        """Store outcomes in one transaction. Raises DBAPIError, also for damage: SQLite writes nothing more in it then."""
        done = []
        with self._database.transaction() as session:
            for number, outcome in finished.items():
                try:
                    with session.begin_nested():
                        record_outcome(session, number, outcome)
                except deliveries.DeliveryUnknown:
                    logger.warning("delivery %d has ended, and is not in the database any more", number)
                except (DataError, IntegrityError):
                    logger.exception("how delivery %d ended cannot be recorded", number)
                    continue
                except Exception as error:
                    if is_database_wide(error) or is_damage(error):
                        raise  # of the database, which is asked again
                    logger.exception("how delivery %d ended cannot be recorded", number)
                    continue
                done.append(number)
        return done


def _delivery(session: Session, row: DeliveryRow, connections: Connections) -> Delivery:
    channel = open_channel(deliveries.get(session, row.subscription_id), connections)
    message = message_of(session, session.get_one(AlertEventRow, row.event_id), connections.texts)
    return Delivery(row.id, row.subscription_id, message, channel)
