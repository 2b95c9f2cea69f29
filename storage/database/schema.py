"""Schema revisions of a database and of this release, and the number of rows in its tables."""

from importlib import resources
from pathlib import Path

from sqlalchemy import Connection, func, inspect, select, text

from storage.database.claim import DatabaseUnusable
from storage.tables.base import Base
from storage.tables.operation import ChangeCountRow

MIGRATIONS = Path(str(resources.files("storage"))) / "migrations"
"""Folder of the migrations; each file name begins with the revision it leads to, in ascending order."""
KEPT_BY_ITSELF = frozenset({ChangeCountRow.__tablename__})
"""Tables that each database fills by itself; they hold no data to be copied."""


def known_revisions() -> list[str]:
    """Return all revisions that this release knows, newest first."""
    return sorted((one.name.partition("_")[0] for one in (MIGRATIONS / "versions").glob("[0-9]*.py")), reverse=True)


def revision_of(connection: Connection) -> str | None:
    """Return the schema revision of a database; None when it has no schema."""
    if not inspect(connection).has_table("alembic_version"):
        return None
    found: str | None = connection.scalar(text("SELECT version_num FROM alembic_version"))
    return found


def require_known(revision: str | None, what: str) -> str:
    """Raise DatabaseUnusable unless this release knows the revision. what: name of the database in the message."""
    known = known_revisions()
    if revision is None:
        raise DatabaseUnusable(f"{what} holds no data of Rundown")
    if revision not in known:
        raise DatabaseUnusable(
            f"{what} has schema revision {revision}, which this release does not know; its newest is {known[0]}: "
            "use the release that wrote it, or a newer one"
        )
    return revision


def row_counts(connection: Connection) -> dict[str, int]:
    """Return the number of rows of each existing table that holds data, by name."""
    there = set(inspect(connection).get_table_names())
    return {
        table.name: connection.scalar(select(func.count()).select_from(table)) or 0
        for table in Base.metadata.sorted_tables
        if table.name in there - KEPT_BY_ITSELF
    }
