"""Reading as many rows as can be read, where a few lie on damaged pages."""

from collections.abc import Iterable
from typing import TypeVarTuple

from sqlalchemy import Row, Select
from sqlalchemy.exc import DBAPIError
from sqlalchemy.orm import QueryableAttribute, Session

from storage.database.damage import is_confined

RowColumns = TypeVarTuple("RowColumns")


def readable_rows(
    session: Session, query: Select[*RowColumns], key: QueryableAttribute[str], keys: Iterable[str]
) -> list[Row[*RowColumns]]:
    """Return the rows of a query; without those that are damaged, if there are any.

    Args:
        session: Reads them; it begins a new transaction where it has met damage.
        query: Selects them all.
        key: Column by which a row is found.
        keys: Its values, for a search one by one.

    Raises:
        DBAPIError: Of any other cause.
    """
    rows = _unless_damaged(session, query)
    if rows is None:
        found = [_unless_damaged(session, query.where(key == one)) for one in keys]
        rows = [row for some in found if some is not None for row in some]
    return rows


def _unless_damaged(session: Session, query: Select[*RowColumns]) -> list[Row[*RowColumns]] | None:
    try:
        return list(session.execute(query).all())
    except DBAPIError as error:
        if not is_confined(error):
            raise
        session.rollback()  # PostgreSQL refuses any further query of the transaction
        return None
