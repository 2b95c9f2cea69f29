"""Lists in parts: each goes on behind the last row of the one before, whatever was added meanwhile."""

from typing import Any, TypeVar

from sqlalchemy import Select, tuple_

Keys = tuple[int | str, ...]
"""Values of the columns by which a list is ordered, of one of its rows; together no two rows have the same."""

T = TypeVar("T")


def ordered(query: Select[T], columns: tuple[Any, ...], after: Keys | None, *, descending: bool = True) -> Select[T]:
    """The query ordered by columns, from behind the row that has these keys on."""
    query = query.order_by(*(column.desc() if descending else column for column in columns))
    if after is None:
        return query
    place, begin = tuple_(*columns), tuple_(*after)
    return query.where(place < begin if descending else place > begin)
