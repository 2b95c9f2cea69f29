"""The database as operations get it: restricted to the principal's plants, with an audit entry for each change."""

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
        """Raise DatabaseUnusable unless the database answers."""


class AuditedTransactions:
    """Transactions that end with an entry in the audit trail: no change without an entry, no entry without a change."""

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
        # The trail belongs to no plant: it is written in the same transaction, but without the restriction to plants.
        with Session(session.connection(), join_transaction_mode="rollback_only") as own:
            audit.append(own, self._entry)
            own.commit()


def scoped_store(database: Database, plants: Plants | None) -> Store:
    """Return the database, restricted to some plants where they are given."""
    return database if plants is None else PlantScope(database, plants)
