"""Ingest pauses after its steps, never for long, and not at all while there is a backlog."""

import time

from service.giving_way import LONGEST_S, PAUSE_S, GivingWay


def paused_s(give_way: GivingWay, steps: int) -> float:
    began = time.perf_counter()
    for _ in range(steps):
        give_way()
    return time.perf_counter() - began


def test_each_step_pauses_until_the_cycle_has_no_time_left_for_it() -> None:
    give_way = GivingWay()
    give_way.begin(hurried=False)
    assert paused_s(give_way, 10) >= 10 * PAUSE_S
    paused_s(give_way, round(LONGEST_S / PAUSE_S))
    assert paused_s(give_way, 100) < 10 * PAUSE_S
    give_way.begin(hurried=False)
    assert paused_s(give_way, 10) >= 10 * PAUSE_S


def test_a_backlog_is_worked_off_without_pauses() -> None:
    give_way = GivingWay()
    assert paused_s(give_way, 100) < 10 * PAUSE_S
    give_way.begin(hurried=True)
    assert paused_s(give_way, 100) < 10 * PAUSE_S
