"""Computes models of long trains, of trains on oil films, and balancings in processes of their own, within time and memory.

LAPACK's eigenvalue solvers hold the interpreter's lock: for a train of 300 sections 0.2 to 0.9 s at a time, in which the
service's process would answer nobody. Films take seconds for each pad that is not known yet.
"""

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import ParamSpec, TypeVar

from estimator.errors import Unavailable
from estimator.machine.checks.document_size import document_size
from estimator.machine.document import Machine
from estimator.machine.film_speeds import follows_films
from service.workers.process_pool import Interrupted, ProcessPool, WorkerStuck
from service.workers.time_limit import OutOfTime, limit_time

AT_ONCE = 2
"""Computations that a service makes at a time, of different callers: one may take a minute."""
LONG_ELEMENTS, LONG_UNKNOWNS = 50, 150
"""Sizes beyond which a train is long."""
TIME_S = 60.0
"""Longest time of a computation [s]: it holds a request thread that others could use."""
MEMORY_BYTES = 2 * 2**30

P = ParamSpec("P")
T = TypeVar("T")


def is_long(machine: Machine) -> bool:
    """Check whether a machine's model is too long to be computed in this process."""
    size = document_size(machine)
    return size.elements > LONG_ELEMENTS or size.unknowns > LONG_UNKNOWNS or follows_films(machine)


class NotComputed(Unavailable):
    """A computation exceeded its time or memory, or its process ended."""


class ModelProcess:
    """One worker process, started with the first computation, and another one for each that comes while all compute."""

    def __init__(self, *, time_s: float = TIME_S, memory_bytes: int = MEMORY_BYTES) -> None:
        """Set the limits of each computation: its time [s] and its memory [B]."""
        self._time_s = time_s
        self._memory = memory_bytes
        self._lock = threading.Lock()
        self._begun: list[ProcessPool] = []
        self._free: list[ProcessPool] = []
        """Those that compute nothing; the last one was used last and knows most."""

    def compute(self, work: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> T:
        """Return or raise the outcome of a module's function. Raises NotComputed."""
        limits = f"within {self._time_s:.0f} s and {self._memory / 2**30:.1f} GiB"
        try:
            with self._process() as one:
                future: Future[T] = one.submit(self._time_s, _in_time, self._time_s, work, *args, **kwargs)
                return future.result()
        except (MemoryError, OutOfTime) as error:
            why = f"what was asked could not be computed {limits}: ask for fewer points, or of fewer runs"
            raise NotComputed(why) from error
        except (WorkerStuck, BrokenProcessPool) as error:
            why = f"the process that computes models ended, or did not answer {limits}: ask again"
            raise NotComputed(why) from error
        except Interrupted as error:
            raise NotComputed("the service stops") from error

    def close(self) -> None:
        """Kill the processes and give up what they compute."""
        with self._lock:
            for one in self._begun:
                one.shutdown()
            self._begun, self._free = [], []

    @contextmanager
    def _process(self) -> Iterator[ProcessPool]:
        """Yield a process that computes nothing else meanwhile."""
        with self._lock:
            if not self._free:
                self._begun.append(ProcessPool(1, memory_bytes=self._memory, tasks=[_in_time]))
                self._free.append(self._begun[-1])
            one = self._free.pop()
        try:
            yield one
        finally:
            with self._lock:
                if one in self._begun:  # else it was closed
                    self._free.append(one)


def _in_time(seconds: float, work: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> T:
    with limit_time(seconds):
        return work(*args, **kwargs)
