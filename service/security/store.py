"""The database as it is given to an operation: with the plants of who asks, and with what they change written down."""

from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Protocol

from sqlalchemy.orm import Session

from storage.database.engine import Database
from storage.database.plant_scope import Plants, PlantScope
from storage.operation import audit
from storage.operation.audit import AuditedOperation


class Store(Protocol):
    """Operations on a database."""

    def transaction(self) -> AbstractContextManager[Session]:
        """Open a session whose changes are committed together at the end, or not at all."""

    def reading(self) -> AbstractContextManager[Session]:
        """Open a session for reading only."""

    def check(self) -> None:
        """Raise DatabaseUnusable."""


class AuditedTransactions:
    """Each transaction ends with an entry in the audit trail: no change without it, and none of it without a change."""

    def __init__(self, database: Database, plants: Plants | None, entry: AuditedOperation) -> None:
        self._database = database
        self._store: Store = database if plants is None else PlantScope(database, plants)
        self._entry = entry
        self.written = False

    @contextmanager
    def transaction(self) -> Iterator[Session]:
        """Open a transaction as the database does."""
        with self._store.transaction() as session:
            yield session
            session.flush()
            self._append(session)
        self.written = True

    def reading(self) -> AbstractContextManager[Session]:
        """Open a reading session as the database does."""
        return self._store.reading()

    def check(self) -> None:
        """Check as the database does."""
        self._store.check()

    def _append(self, session: Session) -> None:
        # The trail is nobody's plant: in the same transaction, but not under the plants' condition.
        with Session(session.connection(), join_transaction_mode="rollback_only") as own:
            audit.append(own, self._entry)
            own.commit()


def plain(database: Database, plants: Plants | None) -> Store:
    """Return the database, or some plants of it."""
    return database if plants is None else PlantScope(database, plants)
