"""Runs computations one at a time: equal ones once, and only as long as somebody waits for the result."""

import threading
from collections import Counter
from collections.abc import Callable, Hashable
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor, wait
from contextvars import copy_context
from dataclasses import dataclass
from typing import NoReturn, TypeVar, cast

from estimator.errors import Unavailable

T = TypeVar("T")

MAXIMUM_WAITING = 32
"""Number of different computations that may wait in a queue."""
MAXIMUM_WAITING_PER_CALLER = 16
"""Number of those that one caller may ask for: two model pages of a train on oil films."""
MAXIMUM_REQUESTS = 200
"""Number of requests that may wait for a queue's results: each holds a thread."""
MAXIMUM_REQUESTS_PER_CALLER = 100
"""Number of those that one caller may make, also where they ask for the same."""
LOOK_S = 0.25
"""Time between two looks whether a request's client is still there [s]."""


class ComputationsBusy(Unavailable):
    """Too many computations wait, or nobody waits for this one any more."""

    retry_after_s = 5


@dataclass
class _Computation:
    """A computation that waits or runs. requests: number of those that wait for its result."""

    future: Future[object]
    caller: Hashable
    requests: int = 0


class ComputationQueue:
    """Computations in the order in which they were asked for; no caller can take all places."""

    def __init__(self, name: str) -> None:
        """Set up an empty queue. name: that of its thread."""
        self._thread = ThreadPoolExecutor(1, thread_name_prefix=name)
        self._lock = threading.RLock()
        self._computations: dict[Hashable, _Computation] = {}
        self._requests: Counter[Hashable] = Counter()
        """Number of waiting requests by their callers."""
        self._closed = False

    @property
    def waiting(self) -> int:
        """Return the number of different computations asked for and not finished."""
        return len(self._computations)

    def result(self, key: Hashable, compute: Callable[[], T], *, caller: Hashable, wanted: Callable[[], bool]) -> T:
        """Compute a result in its turn, or wait for the same one that was asked for before.

        Args:
            key: What is computed; equal keys share one computation.
            compute: Computes it.
            caller: Who asks.
            wanted: Whether its request's client is still there.

        Raises:
            ComputationsBusy: Too many wait, this caller waits for too many, the client has gone, or the service stops.

        What `compute` raises is raised by each request that waits for it.
        """
        computation = self._join(key, compute, caller)
        try:
            return cast(T, _result(computation.future, wanted))
        finally:
            self._leave(computation, caller)

    def close(self) -> None:
        """Give up what waits; what runs ends by itself."""
        with self._lock:
            self._closed = True
            for computation in list(self._computations.values()):
                computation.future.cancel()
        self._thread.shutdown(wait=False)

    def _join(self, key: Hashable, compute: Callable[[], object], caller: Hashable) -> _Computation:
        with self._lock:
            if self._closed:
                _refuse("the service stops")
            if self._requests[caller] >= MAXIMUM_REQUESTS_PER_CALLER:
                _refuse(f"{MAXIMUM_REQUESTS_PER_CALLER} requests of yours wait already for computations; ask again")
            if self._requests.total() >= MAXIMUM_REQUESTS:
                _refuse(f"{MAXIMUM_REQUESTS} requests wait already for computations; ask again")
            found = self._computations.get(key)
            if found is None:
                self._require_place(caller)
                found = self._computations[key] = _Computation(self._thread.submit(copy_context().run, compute), caller)
                found.future.add_done_callback(lambda _: self._forget(key))
            found.requests += 1
            self._requests[caller] += 1
            return found

    def _require_place(self, caller: Hashable) -> None:
        own = sum(one.caller == caller for one in self._computations.values())
        if own >= MAXIMUM_WAITING_PER_CALLER:
            _refuse(f"{own} computations that you asked for wait already; ask again")
        if len(self._computations) >= MAXIMUM_WAITING:
            _refuse(f"{len(self._computations)} computations wait already; ask again")

    def _leave(self, computation: _Computation, caller: Hashable) -> None:
        with self._lock:
            self._requests[caller] -= 1
            if not self._requests[caller]:
                del self._requests[caller]
            computation.requests -= 1
            if not computation.requests:
                computation.future.cancel()  # without effect once it runs

    def _forget(self, key: Hashable) -> None:
        with self._lock:
            del self._computations[key]


def _result(future: Future[object], wanted: Callable[[], bool]) -> object:
    while not future.done():
        wait([future], LOOK_S)  # a future that is cancelled does not wake it
        if not future.done() and not wanted():
            _refuse("nobody waits for this result any more")
    try:
        return future.result()
    except CancelledError:
        _refuse("the service stops")


def _refuse(why: str) -> NoReturn:
    raise ComputationsBusy(why)
