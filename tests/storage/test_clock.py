"""Times of the store: exact conversions, and what is too far ahead to be believed."""

from datetime import UTC, datetime, timedelta, timezone

import pytest

from storage.clock import FUTURE_TOLERANCE, from_datetime, is_ahead, latest, now, to_datetime

MICROSECOND = 1_000


@pytest.mark.parametrize("time_ns", [0, MICROSECOND, 1_700_000_000_123_456_000, -86_400_000_000_001_000, 2**62 // 1000 * 1000])
def test_times_go_there_and_back_without_rounding(time_ns: int) -> None:
    moment = to_datetime(time_ns)
    assert moment.utcoffset() == timedelta(0)
    assert from_datetime(moment) == time_ns


def test_nanoseconds_below_a_microsecond_are_cut_off() -> None:
    assert from_datetime(to_datetime(1_999)) == 1_000


def test_zones_are_heeded_and_a_naive_time_is_utc() -> None:
    east = datetime(2024, 1, 1, 2, tzinfo=timezone(timedelta(hours=2)))
    assert from_datetime(east) == from_datetime(datetime(2024, 1, 1, tzinfo=UTC)) == from_datetime(datetime(2024, 1, 1))


def test_a_time_far_ahead_is_distinguished_from_one_that_is_nearly_now() -> None:
    before = now()
    assert before + FUTURE_TOLERANCE <= latest()
    assert not is_ahead(before + FUTURE_TOLERANCE)
    assert is_ahead(latest() + 60_000_000_000)
