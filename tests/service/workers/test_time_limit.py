"""The time limit of a task, in the process that computes it."""

import signal
import time

import pytest

from service.workers import time_limit
from service.workers.time_limit import OutOfTime, limit_time


def busy(seconds: float) -> float:
    """Compute for a time [s], and return how long it took."""
    start = time.monotonic()
    while time.monotonic() < start + seconds:
        sum(range(100))
    return time.monotonic() - start


class DestroyedSlowly:
    """Something whose destructor takes 0.2 s, and within which nobody hears of an error."""

    def __del__(self) -> None:
        busy(0.2)


def test_a_block_within_its_time_is_left_alone() -> None:
    with limit_time(5.0):
        assert busy(0.01) < 5.0
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)  # no alarm is left behind


def test_a_block_beyond_its_time_is_ended() -> None:
    start = time.monotonic()
    with pytest.raises(OutOfTime), limit_time(0.05):
        busy(10.0)
    assert time.monotonic() - start < 5.0


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_block_whose_first_alarm_is_lost_is_ended_by_the_next(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(time_limit, "REPEAT_S", 0.3)
    passed = []

    def work() -> None:
        slowly = DestroyedSlowly()
        del slowly
        passed.append("the destructor")
        busy(10.0)

    start = time.monotonic()
    with pytest.raises(OutOfTime), limit_time(0.05):
        work()
    assert passed == ["the destructor"]
    assert time.monotonic() - start < 5.0
