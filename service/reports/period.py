"""The period of a report: the year until now, a range that was asked for, or the last whole week or month (UTC)."""

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import Literal

from estimator.errors import Invalid
from storage.clock import from_datetime

ReportInterval = Literal["weekly", "monthly"]
YEAR = 365 * 86_400 * 10**9
"""Length of a report without a range [ns]."""


class PeriodEmpty(Invalid):
    """A period ends before it begins."""


@dataclass(frozen=True)
class ReportPeriod:
    """A closed range of time [ns since 1970]. Raises PeriodEmpty."""

    first: int
    last: int

    def __post_init__(self) -> None:
        if self.first > self.last:
            raise PeriodEmpty("the report's period ends before it begins: from must lie before to")


def asked_period(first: int | None, last: int | None, *, moment: int) -> ReportPeriod:
    """Return the period that was asked for; without an end until now, without a beginning over a year."""
    end = moment if last is None else last
    return ReportPeriod(end - YEAR if first is None else first, end)


def last_whole(interval: ReportInterval, moment: datetime) -> ReportPeriod:
    """Return the last whole week, from Monday, or month before a moment."""
    day = moment.astimezone(UTC).replace(hour=0, minute=0, second=0, microsecond=0)
    if interval == "weekly":
        end = day - timedelta(days=day.weekday())
        begin = end - timedelta(weeks=1)
    else:
        end = day.replace(day=1)
        begin = (end - timedelta(days=1)).replace(day=1)
    return ReportPeriod(from_datetime(begin), from_datetime(end) - 1)
