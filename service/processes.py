"""Worker processes on this machine, each with one piece of work at a time: one that dies takes nobody else's work with it."""

import multiprocessing
import threading
from collections.abc import Callable
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import ParamSpec, TypeVar

from service import worker

P = ParamSpec("P")
T = TypeVar("T")


class SeparateProcesses(Executor):
    """An executor of pools of one process each. Work beyond their number waits behind other work, and shares its fate.

    A piece of work whose process died ends in BrokenProcessPool; its pool is replaced.
    """

    def __init__(self, workers: int, *, memory_bytes: int) -> None:
        """memory_bytes: what each process may hold of its own; more raises MemoryError in it."""
        self._memory = memory_bytes
        self._lock = threading.Lock()
        self._pools = [self._pool() for _ in range(workers)]
        self._load = [0] * workers

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """As of `concurrent.futures`."""
        with self._lock:
            place = self._load.index(min(self._load))
            try:
                future = self._pools[place].submit(fn, *args, **kwargs)
            except BrokenProcessPool:
                self._pools[place].shutdown(wait=False)
                self._pools[place] = self._pool()
                future = self._pools[place].submit(fn, *args, **kwargs)
            self._load[place] += 1
        future.add_done_callback(lambda _: self._done(place))
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """As of `concurrent.futures`, but with `cancel_futures` what is being computed is given up as well."""
        if cancel_futures:
            for child in multiprocessing.active_children():
                child.terminate()
        for pool in self._pools:
            pool.shutdown(wait=wait, cancel_futures=cancel_futures)

    def _done(self, place: int) -> None:
        with self._lock:
            self._load[place] -= 1

    def _pool(self) -> ProcessPoolExecutor:
        # Spawned: a fork with a zenoh session open would crash.
        context = multiprocessing.get_context("spawn")
        return ProcessPoolExecutor(1, mp_context=context, initializer=worker.prepare, initargs=(self._memory,))
