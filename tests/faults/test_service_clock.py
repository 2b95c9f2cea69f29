"""The clock of a running service jumps a year ahead and back, and a year back: nothing is lost, and the present is told."""

import time
from pathlib import Path

import httpx
import pytest

from formats.wire import JSON, encode_body
from storage.clock import to_datetime
from tests.end_to_end.processes import until
from tests.faults.shifted_clock import ShiftedService
from tests.plant import KEY, SECOND, batch, document

HOUR = 3600 * SECOND
YEAR_S = 365 * 86_400
WITHIN_S = 30.0
LOOK_S = 5.0
"""Time in which retention has looked at the clock, and late samples are worked off [s]."""


class ClockSource:
    """Over HTTP, without a log of its own. sequence: of its next sample; taken: samples that are stored."""

    def __init__(self, service: ShiftedService) -> None:
        self.service, self.sequence, self.taken = service, 0, 0

    def post(self, rpm: list[float], *, age: int = 0, ahead_s: int = 0) -> httpx.Response:
        """Samples a millisecond apart, which began that long ago [ns] by a clock that is so far ahead [s]."""
        begin = time.time_ns() - age + ahead_s * SECOND
        one = batch(rpm, sequence=self.sequence, start=begin, step=SECOND // 1000)
        headers = {"content-type": JSON}
        answer = self.service.client.post(f"/machines/{KEY.machine}/samples", content=encode_body(one, JSON), headers=headers)
        if answer.status_code == 200:
            self.taken += answer.json()["received"]
            self.sequence += len(rpm)
        return answer


def told(service: ShiftedService, words: str) -> bool:
    return any(words in one for one in service.get("/health")["warnings"])


def before(service: ShiftedService, source: ClockSource) -> None:
    """Twelve hours by a right clock, then eight samples a year ahead."""
    with service.running():
        assert service.client.post("/machines", json=document()).status_code == 201
        for hours in range(12, 0, -1):
            assert source.post([1000.0] * 50, age=hours * HOUR).json()["received"] == 50
        service.offset_s = YEAR_S  # and the source with it
        assert source.post([1480.0] * 8, ahead_s=YEAR_S).status_code == 200


def after(service: ShiftedService, source: ClockSource) -> None:
    """Started anew, still ahead; then set right, a year behind, and right again."""
    with service.running():
        # Started anew: nothing is let go of, and it is said what waits.
        until(lambda: service.figure("rundown_retention_waiting") == 1.0, within_s=WITHIN_S, what="old samples wait")
        assert told(service, "rundown retention confirm")
        assert service.figure("rundown_released_sample_blocks") == 0.0
        # Right again, while it runs: the state is that of the present.
        service.offset_s = 0
        assert source.post([700.0] * 20, age=SECOND).status_code == 200
        assert source.post([700.0] * 20).json()["received"] == 20
        state = service.get(f"/machines/{KEY.machine}/state")
        assert (state["state"], round(state["speed_rpm"])) == ("at speed", 700)
        assert state["newest_sample_at"] < to_datetime(time.time_ns() + HOUR).isoformat()
        # A year behind: what is live waits, and none of it is used up.
        service.offset_s = -YEAR_S
        refused = source.post([700.0] * 20)
        assert refused.status_code == 503
        assert "this machine's clock" in refused.json()["detail"]
        until(lambda: service.figure("rundown_clock_doubted") == 1.0, within_s=WITHIN_S, what="the clock is doubted")
        assert told(service, "Set it (NTP)")
        service.offset_s = 0
        assert source.post([700.0] * 20).json()["received"] == 20
        (row,) = service.get("/sources")
        assert (row["received"], row["lost"]) == (source.taken, 0)
    assert source.taken == 12 * 50 + 8 + 18 + 2 * 20  # two of those that followed the wrong times were put apart


def test_a_year_ahead_and_a_year_behind(tmp_path: Path) -> None:
    service = ShiftedService(tmp_path, RUNDOWN_RAW_DAYS="30")
    with service.client:
        source = ClockSource(service)
        before(service, source)
        after(service, source)


@pytest.mark.long
def test_a_first_start_a_year_ahead_lets_no_later_jump_delete(tmp_path: Path) -> None:
    """As of a machine whose clock is wrong at each start, until it is set."""
    service = ShiftedService(tmp_path, RUNDOWN_RAW_DAYS="30", RUNDOWN_LATE_S="1")
    with service.client:
        source = ClockSource(service)
        service.offset_s = YEAR_S
        with service.running():
            assert service.client.post("/machines", json=document()).status_code == 201
            assert source.post([1000.0] * 8, ahead_s=YEAR_S).status_code == 200
        with service.running():
            time.sleep(LOOK_S)
        service.offset_s = 0
        with service.running():
            for hours in range(12, 0, -1):
                source.post([1000.0] * 50, age=hours * HOUR)
            time.sleep(LOOK_S)
        service.offset_s = YEAR_S
        for _ in range(2):
            with service.running():
                source.post([1480.0] * 8, ahead_s=YEAR_S)
                until(lambda: service.figure("rundown_retention_waiting") == 1.0, within_s=WITHIN_S, what="it waits")
                assert service.figure("rundown_released_sample_blocks") == 0.0
