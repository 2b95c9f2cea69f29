"""A pool of worker processes on this machine, each with one task at a time.

Each process has a thread that talks to it through a pipe, and may wait for it for ever. Another thread enforces the time
limits: a process that exceeds its time is killed (SIGKILL, which ends stopped processes as well), its task ends in
WorkerStuck, and a new process takes its slot. Nothing waits for a process that the kernel does not let die, such as one in
hanging I/O.
"""

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

from service.resilience.supervised_thread import SupervisedThread
from service.workers import process_setup, time_limit
from service.workers.worker_process import WorkerSetup, serve

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
"""Pause between two looks at the processes."""
RETRY_S = 1.0
"""Pause after a process could not be started."""
DEATH_S = 2.0
"""Longest wait for the death of a process."""


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


class ProcessPool:
    """A number of processes, started with the first task, and the queue of tasks that wait for them.

    A task ends in its exception, in BrokenProcessPool when its process died, in WorkerStuck when that stopped responding, or
    in Interrupted by `shutdown`.
    """

    def __init__(self, workers: int, *, memory_bytes: int, tasks: Collection[Callable[..., object]] = ()) -> None:
        """Set up the pool without starting a process.

        memory_bytes: memory limit of each process; exceeding it raises MemoryError there. tasks: functions whose modules a
        process imports at its start, so that this does not count towards its first task's time.
        """
        self._workers = workers
        self._setup = WorkerSetup(memory_bytes, process_setup.NICENESS, tuple(tasks))
        self._waiting: SimpleQueue[_WorkItem | None] = SimpleQueue()
        self._lock = threading.Lock()
        self._slots: list[_Slot] = []
        self._shut_down = False
        self._watch = _SlotWatch(self._check_slots)

    def submit(self, limit_s: float, work: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Queue a task that keeps to its own time of `limit_s` [s]; one that does not is stopped shortly afterwards."""
        future: Future[T] = Future()
        payload = pickle.dumps((work, args, kwargs))
        with self._lock:
            if self._shut_down:
                raise Interrupted("these processes are shut down")
            if not self._slots:
                self._slots = [_Slot(self._waiting, self._setup) for _ in range(self._workers)]
                self._watch.start()
        self._waiting.put(_WorkItem(payload, limit_s, future))
        return future

    @property
    def start_trouble(self) -> str | None:
        """Return why no process can be started, as far as was tried; None while there is one."""
        with self._lock:
            slots = list(self._slots)
        if any(slot.started for slot in slots):
            return None
        return next((slot.start_trouble for slot in slots if slot.start_trouble is not None), None)

    def retry_start(self) -> None:
        """Queue a task that does nothing where no process could be started and nothing waits: it is the next attempt."""
        if self.start_trouble is not None and self._waiting.empty():
            self.submit(START_S, int)

    def shutdown(self) -> None:
        """Kill the processes, give up their tasks and cancel the queued ones."""
        with self._lock:
            self._shut_down = True
            slots = self._slots
        if not slots:
            return
        self._watch.stop()
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

    def _check_slots(self) -> None:
        """Check every process, even if another one's check fails; raise the first error after that."""
        errors = []
        for number, slot in enumerate(self._slots):
            try:
                self._check_slot(number, slot)
            except Exception as error:  # noqa: BLE001 - raised below
                errors.append(error)
        if errors:
            raise errors[0]

    def _check_slot(self, number: int, slot: "_Slot") -> None:
        if (silent := slot.silent_s()) is not None:
            logger.error("a worker process has not answered for %.0f s: it is killed and replaced", silent)
            self._slots[number] = _Slot(self._waiting, self._setup)
            slot.give_up(WorkerStuck(f"its process did not answer for {silent:.0f} s and was killed"))


class _SlotWatch(SupervisedThread):
    """The thread that kills and replaces processes which do not answer in time."""

    def __init__(self, look: Callable[[], None]) -> None:
        super().__init__(
            "watching processes",
            failure="worker processes cannot be looked after",
            retry_s=WATCH_S,
            first_pause_s=WATCH_S,
        )
        self._look = look

    def run_once(self) -> float:
        """Look at all processes once; return the pause before the next look [s]."""
        self._look()
        return WATCH_S


class _Slot:
    """A process and the thread that talks to it."""

    def __init__(self, waiting: "SimpleQueue[_WorkItem | None]", setup: "WorkerSetup") -> None:
        self._waiting = waiting
        self._setup = setup
        self._lock = threading.Lock()
        self._item: _WorkItem | None = None
        self._given_up: Exception | None = None
        self._sent_at, self._until = 0.0, math.inf
        self._process: Any = None  # of the context that spawns
        self._pipe: Connection | None = None
        self.started = False
        """Whether its process has started, and was not seen to end."""
        self.start_trouble: str | None = None
        """Why its last start failed; None when it did not."""
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
            pipe = self._begin()
        except (EOFError, MemoryError, OSError, RuntimeError) as error:
            if self._given_up is not None:  # killed while it was starting
                raise self._given_up from error
            self.start_trouble = f"no worker process can be started: {str(error) or 'it dies while it starts'}"
            logger.error(self.start_trouble)
            self._end()
            time.sleep(RETRY_S)
            raise Interrupted(self.start_trouble) from error
        self.started, self.start_trouble = True, None
        return pipe

    def _begin(self) -> Connection:
        # Spawned: a fork with a zenoh session open would crash.
        context = multiprocessing.get_context("spawn")
        self._allow(START_S)
        self._pipe, theirs = context.Pipe()
        process = context.Process(target=serve, args=(theirs, self._setup), daemon=True)
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
            self.started = False
            pipe, self._pipe = self._pipe, None
        if pipe is not None:
            pipe.close()
        if process is not None:
            process.kill()
            process.join(DEATH_S)
