"""A pool of worker processes on this machine, each with one task at a time.

Each process has a thread that talks to it through a pipe, and may wait for it for ever. Another thread enforces the time
limits: a process that exceeds its time is killed (SIGKILL, which ends stopped processes as well), its task ends in Stuck, and
a new process takes its slot. Nothing waits for a process that the kernel does not let die, such as one in hanging I/O.
"""

import contextlib
import logging
import math
import multiprocessing
import pickle
import threading
import time
from collections.abc import Callable, Collection
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing.connection import Connection
from queue import Empty, SimpleQueue
from typing import Any, ParamSpec, TypeVar

from service.workers import process_setup, time_limit

P = ParamSpec("P")
T = TypeVar("T")

logger = logging.getLogger(__name__)

START_S = 60.0
"""Time that a process may take to start."""
HAND_OVER_S = 30.0
"""Time that a process may take to confirm the receipt of a task."""
GRACE_S = time_limit.GRACE_S + 5.0
"""Time after a task's limit at which its process is killed; it should have ended itself by then."""
WATCH_S = 0.25
RETRY_S = 1.0
"""Pause after a process could not be started."""
DEATH_S = 2.0
"""Longest wait for the death of a process."""
HERE = b"here"


class WorkerStuck(RuntimeError):
    """A process exceeded its time without an answer, and was killed."""


class Interrupted(RuntimeError):
    """A task was given up because its processes are shut down."""


@dataclass(frozen=True)
class _WorkItem:
    """A pickled task, its time limit [s], and the future of its result."""

    payload: bytes
    limit_s: float
    future: Future[Any]


@dataclass(frozen=True)
class _Setup:
    """The setup sent to each process at its start; unpickling its tasks there imports their modules."""

    memory_bytes: int
    niceness: int
    tasks: tuple[Callable[..., object], ...]


class ProcessPool:
    """A number of processes, started with the first task, and the queue of tasks that wait for them.

    A task ends in its exception, in BrokenProcessPool when its process died, in Stuck when that stopped responding, or in
    Interrupted by `shutdown`.
    """

    def __init__(self, workers: int, *, memory_bytes: int, tasks: Collection[Callable[..., object]] = ()) -> None:
        """Set up the pool without starting a process.

        memory_bytes: memory limit of each process; exceeding it raises MemoryError there. tasks: functions whose modules a
        process imports at its start, so that this does not count towards its first task's time.
        """
        self._workers = workers
        self._setup = _Setup(memory_bytes, process_setup.NICENESS, tuple(tasks))
        self._waiting: SimpleQueue[_WorkItem | None] = SimpleQueue()
        self._lock = threading.Lock()
        self._slots: list[_Slot] = []
        self._stop = threading.Event()
        self._watching = threading.Thread(target=self._watch, name="watching processes", daemon=True)

    def submit(self, limit_s: float, work: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Queue a task that keeps to its own time of `limit_s` [s]; one that does not is stopped shortly afterwards."""
        future: Future[T] = Future()
        payload = pickle.dumps((work, args, kwargs))
        with self._lock:
            if self._stop.is_set():
                raise Interrupted("these processes are shut down")
            if not self._slots:
                self._slots = [_Slot(self._waiting, self._setup) for _ in range(self._workers)]
                self._watching.start()
        self._waiting.put(_WorkItem(payload, limit_s, future))
        return future

    def shutdown(self) -> None:
        """Kill the processes, give up their tasks and cancel the queued ones."""
        with self._lock:
            self._stop.set()
            slots = self._slots
        if not slots:
            return
        self._watching.join()
        while (item := self._next()) is not None:
            item.future.cancel()
        for slot in slots:
            slot.give_up(Interrupted("its process was shut down"))
            self._waiting.put(None)
        until = time.monotonic() + DEATH_S
        for slot in slots:
            slot.join(until - time.monotonic())

    def _next(self) -> _WorkItem | None:
        try:
            return self._waiting.get_nowait()
        except Empty:
            return None

    def _watch(self) -> None:
        while not self._stop.wait(WATCH_S):
            for number, slot in enumerate(self._slots):
                try:
                    self._look_at(number, slot)
                except Exception:
                    logger.exception("a worker process cannot be looked after, trying again")

    def _look_at(self, number: int, slot: "_Slot") -> None:
        if (silent := slot.silent_s()) is not None:
            logger.error("a worker process has not answered for %.0f s: it is killed and replaced", silent)
            self._slots[number] = _Slot(self._waiting, self._setup)
            slot.give_up(WorkerStuck(f"its process did not answer for {silent:.0f} s and was killed"))


class _Slot:
    """A process and the thread that talks to it."""

    def __init__(self, waiting: "SimpleQueue[_WorkItem | None]", setup: "_Setup") -> None:
        self._waiting = waiting
        self._setup = setup
        self._lock = threading.Lock()
        self._item: _WorkItem | None = None
        self._given_up: Exception | None = None
        self._sent_at, self._until = 0.0, math.inf
        self._process: Any = None  # of the context that spawns
        self._pipe: Connection | None = None
        self._thread = threading.Thread(target=self._run, name="worker process", daemon=True)
        self._thread.start()

    def silent_s(self) -> float | None:
        """Return for how long the process has not answered [s], if that is too long; otherwise None."""
        now = time.monotonic()
        return now - self._sent_at if now > self._until else None

    def give_up(self, reason: Exception) -> None:
        """Kill the process; its task ends in `reason`. It gets no other task, and its thread ends when it can."""
        with self._lock:
            self._given_up = reason
            process = self._process
        if process is not None:
            process.kill()
        self._complete(error=reason)

    def join(self, seconds: float) -> None:
        """Wait until the thread has ended, at most `seconds`."""
        self._thread.join(max(0.0, seconds))

    def _run(self) -> None:
        while self._given_up is None and (item := self._waiting.get()) is not None:
            if item.future.set_running_or_notify_cancel():
                with self._lock:
                    self._item = item
                self._compute(item)
        self._end()

    def _compute(self, item: _WorkItem) -> None:
        try:
            if self._given_up is not None:
                raise self._given_up
            pipe = self._pipe or self._start_process()
            self._allow(HAND_OVER_S)
            pipe.send_bytes(item.payload)
            pipe.recv_bytes()
            self._allow(item.limit_s + GRACE_S)
            done, value = pickle.loads(pipe.recv_bytes())
        except (EOFError, OSError) as error:
            self._end()
            self._complete(error=BrokenProcessPool(f"its process died: {error}" if str(error) else "its process died"))
        except Exception as error:  # noqa: BLE001 - whoever waits for it is told
            self._complete(error=error)
        else:
            self._complete(value) if done else self._complete(error=value)

    def _start_process(self) -> Connection:
        """Start a process. Raises Interrupted when none can be started at present, which is not the task's fault."""
        try:
            return self._begin()
        except (EOFError, OSError, RuntimeError) as error:
            if self._given_up is not None:  # killed while it was starting
                raise self._given_up from error
            logger.error("no worker process can be begun at present: %s", error)
            self._end()
            time.sleep(RETRY_S)
            raise Interrupted(f"no worker process can be begun at present: {error}") from error

    def _begin(self) -> Connection:
        # Spawned: a fork with a zenoh session open would crash.
        context = multiprocessing.get_context("spawn")
        self._allow(START_S)
        self._pipe, theirs = context.Pipe()
        process = context.Process(target=_serve, args=(theirs, self._setup), daemon=True)
        with theirs:
            process.start()
        with self._lock:
            self._process = process
            if self._given_up is not None:
                process.kill()
        self._pipe.recv_bytes()
        return self._pipe

    def _allow(self, seconds: float) -> None:
        self._sent_at = time.monotonic()
        self._until = self._sent_at + seconds

    def _complete(self, value: object = None, *, error: BaseException | None = None) -> None:
        """Complete the future, once: the monitoring thread may have done so already."""
        with self._lock:
            item, self._item = self._item, None
            self._until = math.inf
        if item is None:
            return
        if error is None:
            item.future.set_result(value)
        else:
            item.future.set_exception(error)

    def _end(self) -> None:
        with self._lock:
            process, self._process = self._process, None
            pipe, self._pipe = self._pipe, None
        if pipe is not None:
            pipe.close()
        if process is not None:
            process.kill()
            process.join(DEATH_S)


def _serve(pipe: Connection, setup: _Setup) -> None:
    """Compute one task after the other in the process, until the parent closes the pipe or is gone."""
    process_setup.set_up(setup.memory_bytes, setup.niceness)
    with contextlib.suppress(EOFError, BrokenPipeError, ConnectionResetError):  # what a task raises is part of its outcome
        pipe.send_bytes(HERE)
        while True:
            payload = pipe.recv_bytes()
            pipe.send_bytes(HERE)
            pipe.send_bytes(_outcome(payload))


def _outcome(payload: bytes) -> bytes:
    try:
        work, args, kwargs = pickle.loads(payload)
        return pickle.dumps((True, work(*args, **kwargs)))
    except Exception as error:  # noqa: BLE001 - whatever it is, it is told
        return failed(error)


def failed(error: BaseException) -> bytes:
    """Pickle an error for another process; as a RuntimeError with its message when it does not survive pickling."""
    try:
        told = pickle.dumps((False, error))
        pickle.loads(told)
    except Exception:  # noqa: BLE001 - errors may be anything
        return pickle.dumps((False, RuntimeError(f"{type(error).__name__}: {error}")))
    return told
