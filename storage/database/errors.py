"""Errors of the database and of leases: how far they reach, and their messages."""

from collections.abc import Collection

from sqlalchemy.exc import DataError, DBAPIError, IntegrityError, TimeoutError

from storage.database.damage import is_confined


class LeaseLost(RuntimeError):
    """A lease is held by another replica, or by none."""

    def __init__(self, names: Collection[str]) -> None:
        super().__init__(f"held by another replica, or by none: {', '.join(sorted(names))}")
        self.names = frozenset(names)


def is_database_wide(error: BaseException) -> bool:
    """Return whether an error comes from the database as a whole or from a lost lease, so that any further attempt would fail
    too.

    Damaged pages do not count: they hinder only those who need them.
    """
    of_one = isinstance(error, DataError | IntegrityError) or is_confined(error)
    return isinstance(error, LeaseLost | DBAPIError | TimeoutError) and not of_one


def error_message(error: Exception) -> str:
    """Return the message of the database or, without one, of the error."""
    return str(getattr(error, "orig", None) or error)
