"""Paging by key: each page continues behind the last row of the one before, whatever was added meanwhile."""

from typing import Any, TypeVar

from sqlalchemy import Select, tuple_

Keys = tuple[int | str, ...]
"""Values, for one row, of the columns that order a list; no two rows have the same."""

T = TypeVar("T")


def between(query: Select[T], column: Any, first: int | None, last: int | None) -> Select[T]:
    """Restrict a query to rows whose column lies between two times, both included; None: without that limit."""
    if first is not None:
        query = query.where(column >= first)
    return query if last is None else query.where(column <= last)


def ordered(query: Select[T], columns: tuple[Any, ...], after: Keys | None, *, descending: bool = True) -> Select[T]:
    """Order a query by columns, starting behind the row with the given keys."""
    query = query.order_by(*(column.desc() if descending else column for column in columns))
    if after is None:
        return query
    place, begin = tuple_(*columns), tuple_(*after)
    return query.where(place < begin if descending else place > begin)
