"""Tests how far retention may go, by clock, settings and the time served."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.maintenance.retention_cut_offs import DAY_NS, CutOff, advanced_cut_off, initial_cut_off
from tests.plant import START, few_examples

HOUR, MINUTE = DAY_NS // 24, DAY_NS // 1440
YEAR, MONTH = 365 * DAY_NS, 30 * DAY_NS


@pytest.mark.parametrize(
    ("wanted", "served", "moved", "allowance"),
    [
        (10 * MINUTE, 10 * MINUTE, 10 * MINUTE, DAY_NS),  # a round as any other
        (5 * HOUR, 0, 5 * HOUR, 19 * HOUR),  # it was off for five hours
        (DAY_NS, 0, DAY_NS, 0),
        (DAY_NS + MINUTE, 0, 0, DAY_NS),  # for more than a day
        (YEAR, 10 * MINUTE, 10 * MINUTE, DAY_NS),  # a clock that is ahead
        (-YEAR, 10 * MINUTE, -YEAR, DAY_NS),  # one that is right again, or behind
        (-DAY_NS, 10 * MINUTE, -10 * MINUTE, DAY_NS),  # one that is a little behind
        (-MINUTE, 10 * MINUTE, -MINUTE, DAY_NS),  # one that was set
    ],
)
def test_it_moves_by_the_time_served_and_a_day(wanted: int, served: int, moved: int, allowance: int) -> None:
    found = advanced_cut_off(CutOff(START), wanted=START + wanted, served=served)
    assert found == CutOff(START + moved, allowance)


def test_a_day_off_in_small_parts_is_a_day() -> None:
    found = CutOff(START)
    for night in range(1, 4):
        found = advanced_cut_off(found, wanted=START + night * 10 * HOUR, served=HOUR)
    assert found == CutOff(START + 21 * HOUR, 6 * HOUR)


def test_a_clock_that_is_a_little_behind_for_a_while_spoils_nothing() -> None:
    found = advanced_cut_off(CutOff(START), wanted=START - DAY_NS, served=HOUR)
    assert advanced_cut_off(found, wanted=START + HOUR + MINUTE, served=MINUTE).time == START + HOUR + MINUTE


def test_behind_a_first_start_with_a_clock_ahead_the_next_jump_deletes_nothing() -> None:
    """A machine whose clock is wrong at each start, until it is set."""
    first = initial_cut_off(wanted=START + YEAR, oldest=None, kept=MONTH)
    right = advanced_cut_off(first, wanted=START, served=MINUTE)
    assert right.time == START
    assert advanced_cut_off(right, wanted=START + YEAR + MINUTE, served=MINUTE).time == START + MINUTE


@few_examples
@given(st.lists(st.tuples(st.integers(-2 * YEAR, 2 * YEAR), st.integers(0, 3 * DAY_NS)), max_size=30))
def test_whatever_the_clock_says_it_is_never_further_than_time_has_passed(rounds: list[tuple[int, int]]) -> None:
    cut_offs, served = [CutOff(START)], [0]
    for wanted, more in rounds:
        cut_offs.append(advanced_cut_off(cut_offs[-1], wanted=START + wanted, served=more))
        served.append(served[-1] + more)
    for first in range(len(cut_offs)):
        for last in range(first, len(cut_offs)):
            assert cut_offs[last].time - cut_offs[first].time <= served[last] - served[first] + DAY_NS


@pytest.mark.parametrize(
    ("oldest", "expected"),
    [
        (None, START),
        (START - HOUR, START),
        (START - DAY_NS - 1, START - DAY_NS - 1 - MONTH),
        (START - YEAR, START - YEAR - MONTH),
    ],
)
def test_a_store_that_has_none_begins_where_nothing_much_is_let_go_of(oldest: int | None, expected: int) -> None:
    assert initial_cut_off(wanted=START, oldest=oldest, kept=MONTH) == CutOff(expected)
