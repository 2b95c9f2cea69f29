"""The longest recent duration: kept for one period at least and two at most."""

import time

import pytest

from storage import recent_maximum
from storage.recent_maximum import RecentMaximum


def test_it_is_the_longest_of_all_that_were_noted() -> None:
    found = RecentMaximum()
    assert found.seconds == 0.0
    for seconds in (0.2, 0.7, 0.1):
        found.note(seconds)
    assert found.seconds == 0.7


def test_a_block_is_measured_although_it_fails() -> None:
    found = RecentMaximum()

    def fail() -> None:
        time.sleep(0.02)
        raise LookupError

    with pytest.raises(LookupError), found.measured():
        fail()
    assert 0.02 <= found.seconds < 5.0


def test_it_outlives_the_end_of_a_period_and_is_then_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [100.0]
    monkeypatch.setattr("storage.recent_maximum.time.monotonic", lambda: clock[0])
    found = RecentMaximum()
    found.note(3.0)
    clock[0] += recent_maximum.PERIOD_S + 1.0
    assert found.seconds == 3.0
    found.note(1.0)
    clock[0] += recent_maximum.PERIOD_S
    assert found.seconds == 1.0
    clock[0] += 2.0 * recent_maximum.PERIOD_S
    assert found.seconds == 0.0
