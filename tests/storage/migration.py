"""Migrating a test's database up and down, as an upgrade does."""

from collections.abc import Callable

import alembic.config

from storage.database.engine import Database
from storage.database.schema import MIGRATIONS


def migrate(database: Database, command: Callable[[alembic.config.Config, str], None], revision: str) -> None:
    """Run a command of Alembic, such as `alembic.command.downgrade`, alone in a transaction."""
    config = alembic.config.Config()
    config.set_main_option("script_location", str(MIGRATIONS))
    with database.engine.execution_options(writing="alone").begin() as connection:
        config.attributes["connection"] = connection
        command(config, revision)
