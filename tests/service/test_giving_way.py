"""Ingest pauses after its steps, never for long, and not at all while there is a backlog."""

import time

from service.giving_way import LONGEST_S, PAUSE_S, Pacing


def paused_s(pacing: Pacing, steps: int) -> float:
    began = time.perf_counter()
    for _ in range(steps):
        pacing.pause()
    return time.perf_counter() - began


def test_each_step_pauses_until_the_cycle_has_no_time_left_for_it() -> None:
    pacing = Pacing()
    pacing.begin(hurried=False)
    assert paused_s(pacing, 10) >= 10 * PAUSE_S
    paused_s(pacing, round(LONGEST_S / PAUSE_S))
    assert paused_s(pacing, 100) < 10 * PAUSE_S
    pacing.begin(hurried=False)
    assert paused_s(pacing, 10) >= 10 * PAUSE_S


def test_a_backlog_is_worked_off_without_pauses() -> None:
    pacing = Pacing()
    assert paused_s(pacing, 100) < 10 * PAUSE_S
    pacing.begin(hurried=True)
    assert paused_s(pacing, 100) < 10 * PAUSE_S
