"""A dispatcher that runs while a block lasts, and what it has recorded."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import zenoh

from service.alerts.transitions import Person
from service.delivery.dispatcher import Dispatcher
from storage.alerts import deliveries
from storage.database.engine import Database
from storage.tables.alerting import DeliveryRow
from tests.service.delivery.receivers import settings

ANNA = Person("anna")
Router = tuple[zenoh.Session, str]
"""A session of zenoh that is a router, and its endpoint."""


@contextmanager
def delivering(database: Database, network: Router, **changes: Any) -> Iterator[Dispatcher]:
    """Run a dispatcher on a database and a network. changes: settings that differ."""
    one = Dispatcher(database, network[0], settings(**changes))
    one.start()
    try:
        yield one
    finally:
        one.stop()


def rows(database: Database, subscription: int) -> list[DeliveryRow]:
    """Return the recorded deliveries of a subscription, oldest first."""
    with database.reading() as session:
        return list(deliveries.of_subscription(session, subscription, limit=1000))[::-1]


def states(database: Database, subscription: int) -> list[str]:
    """Return the states of the deliveries of a subscription, oldest first."""
    return [row.state for row in rows(database, subscription)]
