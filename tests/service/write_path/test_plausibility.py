"""Samples in the order of time with speeds that a shaft can follow: what is believed, what is not, and what after all is."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from formats.wire import Fault
from service.write_path.plausibility import FASTEST_CHANGE, JITTER, STRIKES, Plausibility
from tests.plant import SECOND, START, few_examples, machine, samples

HIGHEST = 3000.0


def check(order: Plausibility, rpm: list[float], seconds: list[float] | None = None) -> tuple[list[bool], list[Fault]]:
    """Return which samples at these speeds [r/min] and times after `START` are taken, and every fault."""
    held = samples(len(rpm), rpm=rpm)
    if seconds is not None:
        held.time[:] = [START + round(s * SECOND) for s in seconds]
    taken = np.ones(len(rpm), bool)
    faults = order.check(machine(), held, taken)
    return taken.tolist(), faults


def test_a_steady_sweep_is_taken_whole() -> None:
    assert check(Plausibility(), [1000.0, 1100.0, 1200.0, 1300.0]) == ([True] * 4, [])


def test_time_must_go_on() -> None:
    taken, faults = check(Plausibility(), [1000.0] * 5, [0, 2, 2, 1, 3])
    assert taken == [True, True, False, False, True]
    assert [(fault.index, fault.reason) for fault in faults] == [(2, "time_out_of_order"), (3, "time_out_of_order")]


def test_time_must_go_on_from_one_batch_to_the_next() -> None:
    order = Plausibility()
    check(order, [1000.0, 1000.0], [0, 1])
    assert check(order, [1000.0, 1000.0], [1, 2])[0] == [False, True]


def test_after_a_restart_only_the_time_is_known() -> None:
    assert check(Plausibility(time=START), [2900.0, 2900.0], [0, 1])[0] == [False, True]


def test_one_wrong_speed_is_left_out() -> None:
    taken, faults = check(Plausibility(), [1000.0, 1010.0, 3000.0, 1030.0, 1040.0], [0, 0.1, 0.2, 0.3, 0.4])
    assert taken == [True, True, False, True, True]
    assert [(fault.index, fault.reason) for fault in faults] == [(2, "speed_out_of_order")]
    assert "cannot follow" in faults[0].detail


def test_speeds_that_agree_with_each_other_are_believed_after_all() -> None:
    taken, faults = check(Plausibility(), [1000.0, *[2000.0] * 4], [0, 0.1, 0.2, 0.3, 0.4])
    assert taken == [True, *[False] * (STRIKES - 1), True, True]
    assert len(faults) == STRIKES - 1


def test_wrong_speeds_that_disagree_are_never_believed() -> None:
    taken, _ = check(Plausibility(), [1000.0, 2000.0, 3000.0, 2000.0, 3000.0, 1000.0], [0, 0.1, 0.2, 0.3, 0.4, 0.5])
    assert taken == [True, False, False, False, False, True]


def test_strikes_are_remembered_between_batches() -> None:
    order = Plausibility()
    check(order, [1000.0], [0])
    for number, expected in enumerate([False, False, True], start=1):
        assert check(order, [2000.0], [number / 10])[0] == [expected]


def test_a_believed_speed_forgives_earlier_strikes() -> None:
    order = Plausibility()
    taken, _ = check(order, [1000.0, 2000.0, 2000.0, 1000.0, 2000.0, 2000.0], [0, 0.1, 0.2, 0.3, 0.4, 0.5])
    assert taken == [True, False, False, True, False, False]


@pytest.mark.parametrize("seconds", [0.01, 1.0])
@pytest.mark.parametrize("sign", [1, -1])
def test_the_limit_is_what_a_shaft_can_do(seconds: float, sign: int) -> None:
    change = sign * HIGHEST * (FASTEST_CHANGE * seconds + JITTER)
    assert check(Plausibility(), [1500.0, 1500.0 + 0.999 * change], [0, seconds])[0] == [True, True]
    assert check(Plausibility(), [1500.0, 1500.0 + 1.001 * change], [0, seconds])[0] == [True, False]


def test_after_a_long_pause_any_speed_is_believed() -> None:
    assert check(Plausibility(), [3000.0, 0.0], [0, 3])[0] == [True, True]


def test_what_is_already_left_out_is_not_looked_at() -> None:
    held = samples(3, rpm=[1000.0, 3000.0, 1010.0], step=SECOND // 10)
    taken = np.array([True, False, True])
    assert Plausibility().check(machine(), held, taken) == []
    assert taken.tolist() == [True, False, True]


@few_examples
@given(st.lists(st.tuples(st.floats(0, 3900), st.integers(-SECOND, 5 * SECOND)), min_size=1, max_size=30), st.data())
def test_what_is_taken_is_in_order_however_it_is_cut_into_batches(steps: list[tuple[float, int]], data: st.DataObject) -> None:
    rpm = [speed for speed, _ in steps]
    seconds = (np.cumsum([step for _, step in steps]) / SECOND).tolist()
    whole, _ = check(Plausibility(), rpm, seconds)
    kept = [index for index, taken in enumerate(whole) if taken]
    for before, after in zip(kept, kept[1:], strict=False):
        # Time goes on, or enough others have said before that it was set back.
        assert seconds[after] > seconds[before] or after - before >= STRIKES
    cut = data.draw(st.integers(0, len(steps)))
    order = Plausibility()
    assert check(order, rpm[:cut], seconds[:cut])[0] + check(order, rpm[cut:], seconds[cut:])[0] == whole


def test_a_clock_that_was_ahead_or_is_set_back_is_believed_after_three_times() -> None:
    taken, faults = check(Plausibility(), [1000.0] * 8, [0, 1, 60, 2, 3, 4, 5, 6])
    assert taken == [True, True, True, False, False, True, True, True]
    assert [fault.reason for fault in faults] == ["time_out_of_order"] * 2


def test_reversed_time_is_never_believed() -> None:
    assert check(Plausibility(), [1000.0] * 6, [9, 8, 7, 6, 5, 4])[0] == [True] + [False] * 5


def test_a_sample_that_fills_a_hole_stays_between_its_neighbours() -> None:
    order = Plausibility(time=START + 5 * SECOND, before=START + 9 * SECOND)
    assert check(order, [1000.0] * 4, [1, 2, 3, 4])[0] == [False] * 4
