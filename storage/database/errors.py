"""Errors of the database and of leases: how far they reach, and their messages."""

import builtins
import sqlite3
from collections.abc import Collection

from sqlalchemy.exc import DataError, DBAPIError, IntegrityError, TimeoutError

from storage.database.claim import DatabaseUnusable
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


def error_outline(error: Exception) -> str:
    """Return the cause of an error of the database for callers, who may be anybody: without the database's place.

    PostgreSQL's own messages name its address, users and tables.
    """
    cause = getattr(error, "orig", None) or error
    if isinstance(cause, DatabaseUnusable):
        return cause.detail
    if isinstance(cause, sqlite3.Error | LeaseLost | TimeoutError | builtins.TimeoutError):
        return str(cause)
    return f"{type(cause).__name__} of PostgreSQL"


def error_message(error: Exception) -> str:
    """Return the message of the database or, without one, of the error, for the log and for administrators."""
    return str(getattr(error, "orig", None) or error)
