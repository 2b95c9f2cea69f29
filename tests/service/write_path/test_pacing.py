"""Ingest pauses after its steps, never for long, and not at all while there is a backlog."""

import time

import pytest

from service.write_path.pacing import LONGEST_IN_TRANSACTION_S, LONGEST_S, PAUSE_S, Pacing


def paused_s(pacing: Pacing, steps: int) -> float:
    began = time.perf_counter()
    for _ in range(steps):
        pacing.pause()
    return time.perf_counter() - began


def test_each_step_pauses_until_the_cycle_has_no_time_left_for_it() -> None:
    pacing = Pacing()
    pacing.begin(without_pauses=False)
    assert paused_s(pacing, 10) >= 10 * PAUSE_S
    paused_s(pacing, round(LONGEST_S / PAUSE_S))
    assert paused_s(pacing, 100) < 10 * PAUSE_S
    pacing.begin(without_pauses=False)
    assert paused_s(pacing, 10) >= 10 * PAUSE_S


def test_a_backlog_is_worked_off_without_pauses() -> None:
    pacing = Pacing()
    assert paused_s(pacing, 100) < 10 * PAUSE_S
    pacing.begin(without_pauses=True)
    assert paused_s(pacing, 100) < 10 * PAUSE_S


def test_pauses_that_take_longer_than_meant_are_fewer(monkeypatch: pytest.MonkeyPatch) -> None:
    """As on a machine where whoever sleeps gets its processor back much later."""
    sleep, pauses = time.sleep, list[float]()

    def oversleep(seconds: float) -> None:
        pauses.append(seconds)
        sleep(seconds + LONGEST_S / 4)

    monkeypatch.setattr(time, "sleep", oversleep)
    pacing = Pacing()
    pacing.begin(without_pauses=False)
    with pacing.in_transaction():
        paused_s(pacing, 100)
    assert len(pauses) == 1, "one takes all the time that a transaction has for it"
    paused_s(pacing, 100)
    assert len(pauses) <= 4, "a cycle has no more time than before"


def test_a_transaction_has_less_time_for_pauses_and_the_cycle_keeps_the_rest() -> None:
    in_transaction = []
    for _ in range(5):  # whose thread loses its processor on the way pauses longer than it meant to
        pacing = Pacing()
        pacing.begin(without_pauses=False)
        with pacing.in_transaction():
            in_transaction.append(paused_s(pacing, 100))
        assert paused_s(pacing, 10) >= 10 * PAUSE_S
    assert min(in_transaction) < 2 * LONGEST_IN_TRANSACTION_S
