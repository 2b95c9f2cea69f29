"""Lists in parts: each goes on behind the last row of the one before, whatever was added meanwhile."""

from typing import Any, TypeVar

from sqlalchemy import Select, tuple_

Keys = tuple[int | str, ...]
"""Values of the columns by which a list is ordered, of one of its rows; together no two rows have the same."""

T = TypeVar("T")


def between(query: Select[T], column: Any, first: int | None, last: int | None) -> Select[T]:
    """The rows of a query whose column lies between two moments, both included; None: without an end there."""
    if first is not None:
        query = query.where(column >= first)
    return query if last is None else query.where(column <= last)


def ordered(query: Select[T], columns: tuple[Any, ...], after: Keys | None, *, descending: bool = True) -> Select[T]:
    """The query ordered by columns, from behind the row that has these keys on."""
    query = query.order_by(*(column.desc() if descending else column for column in columns))
    if after is None:
        return query
    place, begin = tuple_(*columns), tuple_(*after)
    return query.where(place < begin if descending else place > begin)
