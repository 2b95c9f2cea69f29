"""A database as seen by somebody who may see some plants only: rows of other plants do not exist for any query.

The ORM adds the condition on the plant to each statement over mapped classes, so that a new query cannot forget it. A table
without a known path to a plant has no rows here, and a statement that is not about mapped classes is refused.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import Any

from sqlalchemy import ColumnElement, Select, event, false, select
from sqlalchemy.orm import ORMExecuteState, Session, sessionmaker, with_loader_criteria

from storage.database.engine import Database
from storage.tables.alerting import AlertRow, DeliveryRow, SubscriptionPlantRow, SubscriptionRow
from storage.tables.base import Base
from storage.tables.machines import MachineRow

Plants = frozenset[str]
PLANTS = "plants"
EVERY_PLANT = {"every_plant": True}
"""Execution option of the few statements that must see all plants, whoever asks."""


class UnscopedStatement(RuntimeError):
    """A statement that cannot be limited to plants, since it is not about mapped classes."""


class PlantSession(Session):
    """A session that sees some plants only."""


class PlantScope:
    """A view of a database limited to some plants."""

    def __init__(self, database: Database, plants: Plants) -> None:
        self._database = database
        info = {PLANTS: plants}
        self._reading = sessionmaker(database.for_reading, class_=PlantSession, expire_on_commit=False, info=info)
        self._writing = sessionmaker(database.for_writing, class_=PlantSession, expire_on_commit=False, info=info)

    @contextmanager
    def transaction(self) -> Iterator[Session]:
        """Yield a session whose changes are committed together at the end, or not at all."""
        with self._database.turn(), self._writing.begin() as session:
            yield session

    @contextmanager
    def reading(self) -> Iterator[Session]:
        """Yield a session for reading only."""
        with self._reading() as session:
            yield session

    def check(self) -> None:
        """Raise DatabaseUnusable unless the database is usable, see `Database.check`."""
        self._database.check()


def plants_of(session: Session) -> Plants | None:
    """Return the plants that a session sees; None for all."""
    found: Plants | None = session.info.get(PLANTS)
    return found


@event.listens_for(PlantSession, "do_orm_execute")
def _narrow(state: ORMExecuteState) -> None:
    if not state.is_orm_statement:
        raise UnscopedStatement(f"not about mapped classes: {str(state.statement)[:200]}")
    if state.execution_options.get("every_plant"):
        return
    if state.is_column_load or state.is_relationship_load:
        return  # of an object that was read under the condition
    state.statement = state.statement.options(*_criteria(state.session.info[PLANTS]))


@lru_cache(maxsize=256)
def _criteria(plants: Plants) -> tuple[Any, ...]:
    return tuple(
        with_loader_criteria(mapper.class_, _condition(mapper.class_, plants), include_aliases=True)
        for mapper in Base.registry.mappers
    )


def _condition(row: Any, plants: Plants) -> ColumnElement[bool]:
    if row is MachineRow:
        return MachineRow.plant.in_(plants)
    if row is SubscriptionRow:
        return _subscribed_only_to(SubscriptionRow.id, plants)
    if row is SubscriptionPlantRow:
        return _subscribed_only_to(SubscriptionPlantRow.subscription_id, plants)
    if row is DeliveryRow:
        alerts = AlertRow.__table__
        return DeliveryRow.alert_id.in_(select(alerts.c.id).where(alerts.c.machine_id.in_(_machines(plants))))
    if "machine_id" in row.__table__.columns:
        return row.machine_id.in_(_machines(plants))  # type: ignore[no-any-return]
    return false()


def _machines(plants: Plants) -> Select[tuple[str]]:
    machines = MachineRow.__table__
    return select(machines.c.id).where(machines.c.plant.in_(plants))


def _subscribed_only_to(number: Any, plants: Plants) -> ColumnElement[bool]:
    told = SubscriptionPlantRow.__table__
    own = select(told.c.subscription_id).where(told.c.plant.in_(plants))
    foreign = select(told.c.subscription_id).where(told.c.plant.not_in(plants))
    return number.in_(own) & number.not_in(foreign)  # type: ignore[no-any-return]
