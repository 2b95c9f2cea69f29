"""Upgrading the schema of a database when it is opened."""

from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy import Engine

from storage.database import postgresql_tools
from storage.database.claim import Claim, DatabaseUnusable
from storage.database.schema import known_revisions, revision_of


def bring_up_to_date(engine: Engine) -> None:
    """Create the schema of a new database, or upgrade an older one.

    Raises DatabaseUnusable after an interrupted restore, or while others use an older schema.
    """
    # Under the writer's lock: several processes may open a new database at once.
    with engine.execution_options(writing="alone").begin() as connection:
        if postgresql_tools.interrupted(connection):
            raise DatabaseUnusable("a restore into it was interrupted: run `rundown restore FILE --overwrite` again")
        found = revision_of(connection)
        if found == known_revisions()[0]:
            return
        with _claimed(engine, older=found is not None):
            from storage.database.migrate import upgrade  # alembic takes half a second to import

            upgrade(connection)


@contextmanager
def _claimed(engine: Engine, *, older: bool) -> Iterator[None]:
    """Claim a database with an older schema, which must not change under its users. Raises DatabaseUnusable when there are
    any."""
    claim = Claim(engine)
    try:
        if older:
            claim.acquire()
        yield
    finally:
        claim.release()
