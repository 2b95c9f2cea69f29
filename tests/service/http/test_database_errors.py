"""Errors of a database, each in its category and with its status."""

import sqlite3

import pytest
from sqlalchemy.exc import DataError, DBAPIError, OperationalError

from service.http.database_errors import categorized
from service.http.error_status import status_of


def of_sqlite(code: int) -> sqlite3.DatabaseError:
    error = sqlite3.DatabaseError("it is so")
    error.sqlite_errorcode = code
    return error


@pytest.mark.parametrize(
    ("error", "status", "words"),
    [
        (DataError("SELECT 1", {}, sqlite3.DataError("out of range")), 422, "cannot hold or look for that: out of range"),
        (OperationalError("SELECT 1", {}, of_sqlite(sqlite3.SQLITE_CORRUPT)), 503, "damaged.*it is so.*restore a backup"),
        (OperationalError("SELECT 1", {}, of_sqlite(sqlite3.SQLITE_BUSY)), 503, "does not answer: it is so"),
    ],
)
def test_an_error_has_its_category(error: DBAPIError, status: int, words: str) -> None:
    told = categorized(error)
    assert status_of(told) == status
    with pytest.raises(type(told), match=words):
        raise type(told)(told.detail)
