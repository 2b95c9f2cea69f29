"""Models of long trains are computed in a process of their own, within limits of time and memory.

LAPACK's eigenvalue solvers keep the interpreter's lock: of a train of 300 sections for 0.2 to 0.9 s at a time, in which nobody
else in the service's process is answered.
"""

import threading
from collections.abc import Callable
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from typing import ParamSpec, TypeVar

from fastapi import HTTPException, status

from estimator.machine.document import Machine
from estimator.machine.document_size import document_size
from service.workers.process_pool import ProcessPool, WorkerStuck
from service.workers.time_limit import OutOfTime, limited

LONG_ELEMENTS, LONG_UNKNOWNS = 50, 150
"""A train of more is a long one."""
TIME_S = 60.0
"""What a computation may take: somebody waits for it, and holds a thread that others could use."""
MEMORY_BYTES = 2 * 2**30

P = ParamSpec("P")
T = TypeVar("T")


def is_long(machine: Machine) -> bool:
    """Tell whether a machine's model is too long to be computed in this process."""
    size = document_size(machine)
    return size.elements > LONG_ELEMENTS or size.unknowns > LONG_UNKNOWNS


class ModelProcess:
    """One process, begun with the first work."""

    def __init__(self, *, time_s: float = TIME_S, memory_bytes: int = MEMORY_BYTES) -> None:
        """time_s, memory_bytes: what each piece of work may take."""
        self._time_s = time_s
        self._memory = memory_bytes
        self._lock = threading.Lock()
        self._processes: ProcessPool | None = None

    def compute(self, work: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> T:
        """Return or raise what a function of a module does. Raises HTTPException 503 where it needs more time or memory."""
        with self._lock:
            if self._processes is None:
                self._processes = ProcessPool(1, memory_bytes=self._memory, tasks=[_in_time])
            future: Future[T] = self._processes.submit(self._time_s, _in_time, self._time_s, work, *args, **kwargs)
        try:
            return future.result()
        except (MemoryError, OutOfTime, WorkerStuck, BrokenProcessPool) as error:
            limits = f"{self._time_s:.0f} s and {self._memory / 2**30:.1f} GiB"
            raise HTTPException(
                status.HTTP_503_SERVICE_UNAVAILABLE,
                f"this model of a long train could not be computed within {limits}: ask for fewer points",
            ) from error

    def close(self) -> None:
        """End the process, after what it computes."""
        with self._lock:
            if self._processes is not None:
                self._processes.shutdown()
            self._processes = None


def _in_time(seconds: float, work: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> T:
    with limited(seconds):
        return work(*args, **kwargs)
