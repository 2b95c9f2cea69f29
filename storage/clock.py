"""The wall clock of the store."""

import time
from datetime import UTC, datetime, timedelta

BEGINNING = datetime(1970, 1, 1, tzinfo=UTC)
TOLERANCE = 60_000_000_000
"""Largest deviation [ns] between clocks, and by setting a clock, that passes for normal."""
FUTURE_TOLERANCE = 600_000_000_000
"""Ten minutes [ns]: how far a sample may be ahead of this machine's clock before one of the two must be corrected."""


def now() -> int:
    """Return the nanoseconds since 1970, UTC."""
    return time.time_ns()


def latest() -> int:
    """Return the latest time [ns] that is plausible at present; a later one was stamped by a wrong clock."""
    return now() + FUTURE_TOLERANCE


def is_ahead(time_ns: int) -> bool:
    """Return whether a time [ns] is so far ahead of this machine's clock that one of the two is wrong."""
    return time_ns > latest()


def to_datetime(nanoseconds: int) -> datetime:
    """Return an aware UTC datetime, to the microsecond."""
    return BEGINNING + timedelta(microseconds=nanoseconds // 1000)


def from_datetime(moment: datetime) -> int:
    """Return the nanoseconds since 1970 of an aware datetime; a naive one counts as UTC."""
    aware = moment if moment.tzinfo else moment.replace(tzinfo=UTC)
    since = aware - BEGINNING
    return (since.days * 86_400 + since.seconds) * 1_000_000_000 + since.microseconds * 1000
