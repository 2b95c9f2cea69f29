"""Errors of the database and of leases: whom they concern, and the words that they say."""

from collections.abc import Collection

from sqlalchemy.exc import DataError, DBAPIError, IntegrityError, TimeoutError

from storage.database.damage import is_confined


class LeaseLost(RuntimeError):
    """A lease is another replica's by now."""

    def __init__(self, names: Collection[str]) -> None:
        super().__init__(f"held by another replica, or by none: {', '.join(sorted(names))}")
        self.names = frozenset(names)


def is_database_wide(error: BaseException) -> bool:
    """Whether an error is the database's, or of who may write to it: whatever else is tried now would fail as well. Damaged
    pages hinder only who needs them.
    """
    of_one = isinstance(error, DataError | IntegrityError) or is_confined(error)
    return isinstance(error, LeaseLost | DBAPIError | TimeoutError) and not of_one


def error_message(error: Exception) -> str:
    """What the database said, or what said that there is none."""
    return str(getattr(error, "orig", None) or error)
