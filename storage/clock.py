"""The wall clock, as the store writes it."""

import time
from datetime import UTC, datetime, timedelta

BEGINNING = datetime(1970, 1, 1, tzinfo=UTC)
TOLERANCE = 60_000_000_000
"""Clocks differ, and are set, by less than this [ns] without anybody's notice."""
FUTURE_TOLERANCE = 600_000_000_000
"""A sample may be ahead of this machine's clock by ten minutes [ns]; clocks that differ by more want mending."""


def now() -> int:
    """Nanoseconds since 1970, UTC."""
    return time.time_ns()


def latest() -> int:
    """The latest time [ns] that can be of the present; what lies beyond was dated by a clock that was wrong."""
    return now() + FUTURE_TOLERANCE


def is_ahead(time_ns: int) -> bool:
    """Whether a time [ns] lies so far ahead of this machine's clock that one of the two is wrong."""
    return time_ns > latest()


def to_datetime(nanoseconds: int) -> datetime:
    """An aware UTC datetime, to the microsecond."""
    return BEGINNING + timedelta(microseconds=nanoseconds // 1000)


def from_datetime(moment: datetime) -> int:
    """Nanoseconds since 1970 of an aware datetime; a naive one counts as UTC."""
    aware = moment if moment.tzinfo else moment.replace(tzinfo=UTC)
    since = aware - BEGINNING
    return (since.days * 86_400 + since.seconds) * 1_000_000_000 + since.microseconds * 1000
