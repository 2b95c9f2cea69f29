"""Tests when this machine's own clock is doubted, and when it is a source's clock that is wrong."""

import time

import pytest

from formats.wire import SampleBatch
from service.ingest.clock_doubt import OwnClock, is_doubted
from tests.plant import SECOND, batch

MINUTE, DAY = 60 * SECOND, 86_400 * SECOND
YEAR = 365 * DAY


@pytest.mark.parametrize(
    ("behind", "ahead", "agreeing", "doubted"),
    [
        (False, 0, 0, False),
        (False, 1, 0, False),  # the only source: its clock is wrong
        (False, 1, 5, False),
        (False, 2, 0, True),
        (False, 2, 2, False),
        (False, 3, 2, True),
        (True, 0, 0, True),  # nobody has said otherwise yet
        (True, 1, 0, True),
        (True, 1, 1, True),
        (True, 0, 1, False),  # it was ahead when those samples came
        (True, 1, 2, False),
    ],
)
def test_the_rule(behind: bool, ahead: int, agreeing: int, doubted: bool) -> None:
    assert is_doubted(behind=behind, ahead=ahead, agreeing=agreeing) == doubted


class World:
    """True time; this machine's clock, which is off; sources, whose clocks are off by something else. All in ns."""

    def __init__(self) -> None:
        self.passed = self.off = 0
        self.begin = 1_800_000_000 * SECOND
        self.receipt = 0
        self.clock = OwnClock(lambda: self.receipt)

    @property
    def time(self) -> int:
        return self.begin + self.passed

    def batch(self, source: str, *, off: int = 0, length: int = 5) -> SampleBatch:
        """Return what a source has measured until now."""
        return batch(
            [900.0] * length, source=source, machine=f"machine-{source[:1]}", start=self.time + off - (length - 1) * SECOND
        )

    def hear(self, *sources: str, off: int = 0) -> list[bool]:
        """Return which batches of these sources have to wait."""
        found = []
        for one in sources:
            self.passed += SECOND // 1000
            found.append(self.clock.withholds(self.batch(one, off=off)))
        return found

    def assess(self) -> bool:
        """Return whether a doubt has ended."""
        self.passed += SECOND // 1000
        return self.clock.assess()

    def go_on(self, *sources: str, seconds: int = 120, off: int = 0) -> None:
        for _ in range(0, seconds, 10):
            self.passed += 10 * SECOND
            self.hear(*sources, off=off)
            self.assess()


@pytest.fixture
def world(monkeypatch: pytest.MonkeyPatch) -> World:
    one = World()
    monkeypatch.setattr(time, "time_ns", lambda: one.time + one.off)
    monkeypatch.setattr(time, "monotonic_ns", lambda: 10**15 + one.passed)
    return one


def test_one_source_that_is_ahead_is_wrong_itself(world: World) -> None:
    assert world.hear("a", off=YEAR) == [False]
    world.go_on("b")
    assert world.hear("a", off=YEAR) == [False]
    assert world.hear("b") == [False]
    assert world.clock.doubt is None


def test_several_that_are_ahead_are_right_unless_more_agree(world: World) -> None:
    assert world.hear("a", "b", "c", off=YEAR) == [False, True, True]
    assert world.clock.doubt is not None
    assert "3 sources say that it is 2028-01-15" in world.clock.doubt
    assert "365.0 days later" in world.clock.doubt
    world.go_on("c", "d", "e", "f")
    assert world.clock.doubt is None
    assert world.hear("a", "b", off=YEAR) == [False, False]


def test_a_clock_that_jumps_back_is_noticed_at_once_and_heals_by_itself(world: World) -> None:
    """Also with a single source; no further batch is needed to see that it is right again."""
    world.go_on("a")
    world.off = -YEAR
    assert world.hear("a") == [True]
    assert world.clock.doubt is not None
    assert "the newest samples came at 2027-01-15" in world.clock.doubt
    assert "a source says" in world.clock.doubt
    assert world.clock.doubt.endswith("Set it (NTP): samples that are ahead of it are not taken until then")
    world.go_on("a", seconds=1200)
    assert world.hear("a") == [True]
    world.off = 0
    assert world.assess()
    assert world.clock.doubt is None
    assert world.hear("a") == [False]


@pytest.mark.parametrize("off", [-11 * MINUTE, -DAY, -YEAR, -50 * YEAR])
def test_a_clock_that_is_behind_at_the_start_is_known_by_what_is_stored(world: World, off: int) -> None:
    world.receipt, world.off = world.time - 5 * SECOND, off
    world.assess()
    assert world.clock.doubt is not None
    assert world.hear("a") == [True]


def test_a_few_minutes_are_no_doubt(world: World) -> None:
    world.receipt, world.off = world.time, -9 * MINUTE
    world.assess()
    assert world.clock.doubt is None
    assert world.hear("a", "b") == [False, False]


def test_old_samples_are_taken_by_whatever_clock(world: World) -> None:
    """They do not lie ahead, and whoever sends them in their order could send nothing else."""
    world.receipt, world.off = world.time, -DAY
    assert world.hear("a", off=-2 * DAY) == [False]
    assert world.clock.doubt is None
    world.assess()
    assert world.clock.doubt is not None
    assert world.hear("a", off=-2 * DAY) == [False]


def test_samples_that_came_while_the_clock_was_ahead_cast_no_lasting_doubt(world: World) -> None:
    """The clock is right now: the sources say so, though one goes by the clock that was wrong."""
    world.receipt = world.time + YEAR
    world.assess()
    assert world.clock.doubt is not None
    assert world.hear("a", "b") == [False, False]
    assert world.hear("c", off=YEAR) == [True]
    world.go_on("a", "b")
    assert world.clock.doubt is None
    assert world.hear("c", off=YEAR) == [False]
    world.off = -YEAR  # and what is true is remembered
    assert world.hear("a", "b") == [True, True]


def test_a_log_that_is_caught_up_with_does_not_agree_as_it_passes(world: World) -> None:
    world.go_on("a")
    world.off = -DAY
    world.assess()
    for hours in range(-72, 0):
        waits = world.hear("a", off=hours * 3600 * SECOND)
        world.passed += 10 * SECOND
        world.assess()
        assert waits == [hours > -24]
        assert world.clock.doubt is not None


def test_rubbish_says_nothing_of_the_time(world: World) -> None:
    for moment in (2**62, -(2**62), 0):
        for source in "abc":
            assert not world.clock.withholds(batch([900.0] * 3, source=source, time_ns=[moment] * 3))
    assert world.clock.doubt is None


def test_a_machine_has_one_voice_however_many_sources_it_is_given(world: World) -> None:
    world.go_on("b")
    assert world.hear("a1", "a2", "a3", "a4", off=YEAR) == [False] * 4
    assert world.clock.doubt is None
