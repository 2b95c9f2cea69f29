"""The wall clock, as the store writes it."""

import time
from datetime import UTC, datetime, timedelta

BEGINNING = datetime(1970, 1, 1, tzinfo=UTC)
TOLERANCE = 60_000_000_000
"""Clocks differ, and are set, by less than this [ns] without anybody's notice."""


def now() -> int:
    """Nanoseconds since 1970, UTC."""
    return time.time_ns()


def to_datetime(nanoseconds: int) -> datetime:
    """An aware UTC datetime, to the microsecond."""
    return BEGINNING + timedelta(microseconds=nanoseconds // 1000)


def from_datetime(moment: datetime) -> int:
    """Nanoseconds since 1970 of an aware datetime; a naive one counts as UTC."""
    aware = moment if moment.tzinfo else moment.replace(tzinfo=UTC)
    since = aware - BEGINNING
    return (since.days * 86_400 + since.seconds) * 1_000_000_000 + since.microseconds * 1000
