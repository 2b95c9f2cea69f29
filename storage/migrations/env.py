"""Alembic runs this to migrate over the connection that `storage.database.engine` opened."""

from alembic import context

from storage.tables.base import Base

context.configure(connection=context.config.attributes["connection"], target_metadata=Base.metadata, render_as_batch=True)
with context.begin_transaction():
    context.run_migrations()
