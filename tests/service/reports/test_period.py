"""Periods of reports."""

from datetime import UTC, datetime

import pytest

from service.reports.period import PeriodEmpty, ReportInterval, ReportPeriod, asked_period, last_whole
from storage.clock import from_datetime


@pytest.mark.parametrize(
    ("interval", "moment", "first", "end"),
    [
        ("weekly", "2026-11-26T11:00", "2026-11-16", "2026-11-23"),
        ("weekly", "2026-11-23T00:00", "2026-11-16", "2026-11-23"),
        ("weekly", "2026-11-22T23:59", "2026-11-09", "2026-11-16"),
        ("monthly", "2026-03-01T00:00", "2026-02-01", "2026-03-01"),
        ("monthly", "2026-01-31T12:00", "2025-12-01", "2026-01-01"),
    ],
)
def test_the_last_whole_week_or_month(interval: ReportInterval, moment: str, first: str, end: str) -> None:
    begin, after = (from_datetime(datetime.fromisoformat(one).replace(tzinfo=UTC)) for one in (first, end))
    found = last_whole(interval, datetime.fromisoformat(moment).replace(tzinfo=UTC))
    assert found == ReportPeriod(begin, after - 1)


def test_what_is_asked_for_ends_now_and_lasts_a_year() -> None:
    assert asked_period(None, None, moment=400 * 86_400 * 10**9) == ReportPeriod(35 * 86_400 * 10**9, 400 * 86_400 * 10**9)
    assert asked_period(5, 7, moment=9) == ReportPeriod(5, 7)
    with pytest.raises(PeriodEmpty, match="from must lie before to"):
        asked_period(10, None, moment=9)
