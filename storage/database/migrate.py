"""Migrating a database's schema. Only a database that needs it imports this module: Alembic takes a while to load."""

import alembic.command
import alembic.config
from alembic.util.exc import CommandError
from sqlalchemy import Connection

from storage.database.claim import DatabaseUnusable
from storage.database.schema import MIGRATIONS


def upgrade(connection: Connection) -> None:
    """Upgrade the schema to the newest revision that this release knows. Raises DatabaseUnusable, DBAPIError."""
    config = alembic.config.Config()
    config.set_main_option("script_location", str(MIGRATIONS))
    config.attributes["connection"] = connection
    try:
        alembic.command.upgrade(config, "head")
    except CommandError as error:
        raise DatabaseUnusable(f"its schema is of another version of Rundown, probably a newer one: {error}") from error
