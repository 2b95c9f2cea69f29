"""Worker processes that die, stop or hang: real ones, killed and stopped; those who wait are told, and the others go on."""

import contextlib
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError
from concurrent.futures.process import BrokenProcessPool

import psutil
import pytest

from service.identification.computation import compute
from service.workers import process_pool, process_setup, worker_process
from service.workers.executors import LocalExecutor
from service.workers.process_pool import Interrupted, ProcessPool, WorkerStuck
from tests.plant import wait_until

MEMORY = 2**31
SOON_S = 30.0


@pytest.fixture
def two(monkeypatch: pytest.MonkeyPatch) -> Iterator[ProcessPool]:
    """Two processes, with half a second of grace."""
    monkeypatch.setattr(process_pool, "GRACE_S", 0.5)
    monkeypatch.setattr(process_pool, "HAND_OVER_S", 1.5)
    made = ProcessPool(2, memory_bytes=MEMORY)
    try:
        yield made
    finally:
        made.shutdown()


def test_a_process_whose_service_is_gone_before_it_was_ready_ends_quietly(capfd: pytest.CaptureFixture[str]) -> None:
    spawning = multiprocessing.get_context("spawn")
    ours, theirs = spawning.Pipe()
    process = spawning.Process(target=worker_process.serve, args=(theirs, worker_process.WorkerSetup(MEMORY, 0, ())))
    process.start()
    theirs.close()
    ours.close()
    process.join(SOON_S)
    assert process.exitcode == 0
    assert capfd.readouterr().err == ""


class UnpicklableError(Exception):
    """Cannot be made again from what it tells."""

    def __init__(self, one: str, other: str) -> None:
        super().__init__(one + other)


def unreadable() -> None:
    raise UnpicklableError("half and ", "half")


@pytest.mark.parametrize("tasks", [[], [compute]])
def test_modules_of_the_tasks_are_imported_before_the_first(tasks: list[Callable[..., object]]) -> None:
    made = ProcessPool(1, memory_bytes=MEMORY, tasks=tasks)
    try:
        # A function of this module would import what is looked for.
        found = made.submit(10.0, eval, "'estimator.identification.quality_gate' in __import__('sys').modules").result(SOON_S)
        assert found == bool(tasks)
    finally:
        made.shutdown()


def test_work_is_done_in_two_processes_and_errors_are_reported(two: ProcessPool) -> None:
    here = [two.submit(10.0, os.getpid) for _ in range(6)]
    assert os.getpid() not in {future.result(SOON_S) for future in here}
    assert two.submit(10.0, bytes, 3_000_000).result(SOON_S) == bytes(3_000_000)
    assert two.submit(10.0, len, bytes(3_000_000)).result(SOON_S) == 3_000_000
    with pytest.raises(ValueError, match="invalid literal"):
        two.submit(10.0, int, "none").result(SOON_S)
    with pytest.raises(RuntimeError, match="UnpicklableError: half and half"):
        two.submit(60.0, unreadable).result(90.0)  # it imports this module, which takes seconds where cores are few
    with pytest.raises(BrokenProcessPool):
        two.submit(10.0, os._exit, 1).result(SOON_S)
    assert two.submit(10.0, abs, -1).result(SOON_S) == 1


def test_what_is_worked_on_is_less_urgent_than_what_asks_for_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(process_setup, "NICENESS", 3)
    with contextlib.closing(LocalExecutor(1, memory_bytes=MEMORY, tasks=[])) as executor:
        assert executor.submit(10.0, os.nice, 0).result(SOON_S) == min(19, os.nice(0) + 3)


def test_that_no_process_can_be_begun_is_not_held_against_the_work(two: ProcessPool, monkeypatch: pytest.MonkeyPatch) -> None:
    def short_of_descriptors(_: object) -> None:
        raise OSError(24, "Too many open files")

    monkeypatch.setattr(process_pool, "RETRY_S", 0.0)
    with monkeypatch.context() as short:
        short.setattr(process_pool._Slot, "_begin", short_of_descriptors)
        with pytest.raises(Interrupted, match="Too many open files"):
            two.submit(10.0, abs, -1).result(SOON_S)
        assert two.start_trouble == "no worker process can be started: [Errno 24] Too many open files"
    assert two.submit(10.0, abs, -1).result(SOON_S) == 1
    assert two.start_trouble is None


def test_trouble_of_starting_ends_without_a_task(two: ProcessPool, monkeypatch: pytest.MonkeyPatch) -> None:
    """The task that met it may have been cancelled, or computed by another replica."""

    def short_of_memory(_: object) -> None:
        raise MemoryError

    monkeypatch.setattr(process_pool, "RETRY_S", 0.0)
    with monkeypatch.context() as short:
        short.setattr(process_pool._Slot, "_begin", short_of_memory)
        with pytest.raises(Interrupted, match="it dies while it starts"):
            two.submit(10.0, abs, -1).result(SOON_S)
        two.retry_start()
        assert two.start_trouble is not None

    def is_over() -> bool:
        two.retry_start()
        return two.start_trouble is None

    wait_until(is_over)


def test_stopped_processes_are_killed_and_others_take_their_places(two: ProcessPool) -> None:
    pids: set[int] = set()
    while len(pids) < 2:
        pids |= {future.result(SOON_S) for future in [two.submit(10.0, os.getpid) for _ in range(4)]}
    computing = [two.submit(0.5, time.sleep, 0.4) for _ in range(2)]
    wait_until(lambda: all(future.running() for future in computing))
    for pid in pids:
        os.kill(pid, signal.SIGSTOP)
    for future in computing:
        with pytest.raises(WorkerStuck, match="did not answer for"):
            future.result(SOON_S)
    assert {two.submit(10.0, os.getpid).result(SOON_S) for _ in range(4)}.isdisjoint(pids)
    wait_until(lambda: not any(psutil.pid_exists(pid) for pid in pids))


def test_one_that_was_stopped_before_is_noticed_at_once_whatever_it_gets(two: ProcessPool) -> None:
    first = two.submit(10.0, os.getpid).result(SOON_S)
    second = two.submit(10.0, os.getpid).result(SOON_S)
    for pid in {first, second}:
        os.kill(pid, signal.SIGSTOP)
    large = [two.submit(300.0, len, bytes(5_000_000)) for _ in range(4)]
    ended = [future.exception(SOON_S) for future in large]
    assert {type(one) for one in ended} == {WorkerStuck, type(None)}


def test_work_that_does_not_keep_to_its_time_is_ended_and_the_other_process_works_on(two: ProcessPool) -> None:
    hanging = two.submit(0.5, time.sleep, 600.0)
    others = [two.submit(10.0, abs, -number) for number in range(20)]
    assert [future.result(SOON_S) for future in others] == list(range(20))
    with pytest.raises(WorkerStuck):
        hanging.result(SOON_S)


def test_an_error_of_the_watch_ends_one_look_and_is_logged(
    two: ProcessPool, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    silent_s, errors = process_pool._Slot.silent_s, iter([RuntimeError("can't start new thread")])

    def silent_after_an_error(slot: process_pool._Slot) -> float | None:
        for error in errors:
            raise error
        return silent_s(slot)

    monkeypatch.setattr(process_pool._Slot, "silent_s", silent_after_an_error)
    with pytest.raises(WorkerStuck):
        two.submit(0.5, time.sleep, 600.0).result(SOON_S)
    assert "worker processes cannot be looked after: unexpected error; trying again" in caplog.messages


def test_an_error_at_one_process_does_not_keep_the_watch_from_the_others(
    two: ProcessPool, monkeypatch: pytest.MonkeyPatch
) -> None:
    silent_s, first_fails = process_pool._Slot.silent_s, threading.Event()

    def silent_but_of_the_first(slot: process_pool._Slot) -> float | None:
        if first_fails.is_set() and slot is two._slots[0]:
            raise RuntimeError("can't start new thread")
        return silent_s(slot)

    monkeypatch.setattr(process_pool._Slot, "silent_s", silent_but_of_the_first)
    first_fails.set()
    hanging = [two.submit(0.5, time.sleep, 600.0) for _ in range(2)]
    wait_until(lambda: any(future.done() for future in hanging))
    assert not all(future.done() for future in hanging)
    first_fails.clear()
    assert {type(future.exception(SOON_S)) for future in hanging} == {WorkerStuck}


def pool_threads() -> set[threading.Thread]:
    """Threads of process pools, those of tests before among them."""
    return {one for one in threading.enumerate() if one.name == "worker process"}


def test_a_process_that_a_shutdown_kills_while_it_starts_is_no_error(caplog: pytest.LogCaptureFixture) -> None:
    others, before = pool_threads(), {one.pid for one in multiprocessing.active_children()}
    made = ProcessPool(1, memory_bytes=MEMORY)
    waiting = made.submit(10.0, os.getpid)
    wait_until(lambda: any(one.pid not in before for one in multiprocessing.active_children()))
    made.shutdown()
    with pytest.raises(Interrupted, match="was shut down"):
        waiting.result(SOON_S)
    wait_until(lambda: pool_threads() <= others)
    assert [one.getMessage() for one in caplog.records if one.levelname == "ERROR"] == []


def test_a_shutdown_waits_for_nobody_and_leaves_nothing() -> None:
    others = pool_threads()
    made = ProcessPool(1, memory_bytes=MEMORY)
    pid = made.submit(10.0, os.getpid).result(SOON_S)
    os.kill(pid, signal.SIGSTOP)
    first, second = (made.submit(300.0, len, bytes(5_000_000)) for _ in range(2))
    wait_until(first.running)
    began = time.monotonic()
    made.shutdown()
    assert time.monotonic() - began < 5.0
    with pytest.raises(Interrupted):
        first.result(SOON_S)
    with pytest.raises(CancelledError):
        second.result(SOON_S)
    with pytest.raises(Interrupted):
        made.submit(1.0, os.getpid)
    with contextlib.suppress(psutil.NoSuchProcess):
        psutil.Process(pid).wait(5.0)
    wait_until(lambda: pool_threads() <= others)
