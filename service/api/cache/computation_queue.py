"""Runs a few computations at a time: equal ones once, and only as long as somebody waits for the result.

Callers take turns: next comes a computation of the one who was served longest ago, of these the first that was asked for.
Where two or more run at a time, no caller has all of them, so that nobody waits behind another's long one.
"""

import threading
from collections import Counter, OrderedDict
from collections.abc import Callable, Hashable
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor, wait
from contextvars import Context, copy_context
from dataclasses import dataclass, field
from typing import NoReturn, TypeVar, cast

from estimator.errors import Unavailable

T = TypeVar("T")

MAXIMUM_WAITING = 48
"""Number of different computations that may wait in a queue."""
MAXIMUM_WAITING_PER_CALLER = 16
"""Number of those that one caller may ask for: two model pages of a train on oil films."""
MAXIMUM_REQUESTS = 300
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
    """A computation that waits or runs.

    caller: who asked first, and whose place it takes. requests: number of those that wait for its result, by caller.
    """

    compute: Callable[[], object]
    caller: Hashable
    context: Context = field(default_factory=copy_context)
    future: Future[object] = field(default_factory=Future)
    requests: Counter[Hashable] = field(default_factory=Counter)

    @property
    def waits(self) -> bool:
        """Return whether it neither runs nor is finished or given up."""
        return not self.future.running() and not self.future.done()

    def run(self) -> None:
        """Compute the result for all who wait; the future must be marked as running."""
        try:
            found = self.context.run(self.compute)
        except BaseException as error:  # noqa: BLE001 - it is whoever waits for the result who must see it
            self.future.set_exception(error)
        else:
            self.future.set_result(found)


class ComputationQueue:
    """Computations in turns between callers; no caller can take all places."""

    def __init__(self, name: str, *, at_once: int = 1) -> None:
        """Set up an empty queue. name: that of its threads; at_once: computations that run at a time."""
        self._threads = ThreadPoolExecutor(at_once, thread_name_prefix=name)
        self._most = max(at_once - 1, 1)
        """Computations of one caller that may run at a time."""
        self._running: Counter[Hashable] = Counter()
        """Number of running computations by the callers in whose turns they began."""
        self._passed_over = 0
        """Times that a thread found only computations whose callers had as many running as they may."""
        self._lock = threading.RLock()
        self._computations: dict[Hashable, _Computation] = {}
        self._requests: Counter[Hashable] = Counter()
        """Number of waiting requests by their callers."""
        self._served: OrderedDict[Hashable, None] = OrderedDict()
        """Callers that have had a turn, the one served longest ago first."""
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
            self._withdraw(computation, caller)

    def close(self) -> None:
        """Give up what waits; what runs ends by itself."""
        with self._lock:
            self._closed = True
            for computation in list(self._computations.values()):
                computation.future.cancel()
        self._threads.shutdown(wait=False)

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
                found = self._computations[key] = _Computation(compute, caller)
                found.future.add_done_callback(lambda _: self._forget(key))
                self._threads.submit(self._run_next)
            found.requests[caller] += 1
            self._requests[caller] += 1
            return found

    def _run_next(self) -> None:
        with self._lock:
            turn = self._next()
            if turn is None:  # it was given up, or must wait
                self._passed_over += any(one.waits for one in self._computations.values())
                return
            caller, found = turn
            found.future.set_running_or_notify_cancel()
            self._running[caller] += 1
        found.run()
        with self._lock:
            self._running -= Counter([caller])
            again, self._passed_over = self._passed_over, 0
            for _ in range(0 if self._closed else again):
                self._threads.submit(self._run_next)

    def _next(self) -> tuple[Hashable, _Computation] | None:
        """Return the caller whose turn it is with the waiting computation, and give the last place in the next turn."""
        places = {caller: place for place, caller in enumerate(self._served)}
        waiting = [
            (places.get(caller, -1), caller, one)
            for one in self._computations.values()
            if one.waits
            for caller, requests in one.requests.items()
            if requests and self._running[caller] < self._most
        ]
        if not waiting:
            return None
        _, caller, found = min(waiting, key=lambda turn: turn[0])  # the first of equal ones
        self._served[caller] = None
        self._served.move_to_end(caller)
        while len(self._served) > MAXIMUM_REQUESTS:  # more cannot wait
            self._served.popitem(last=False)
        return caller, found

    def _require_place(self, caller: Hashable) -> None:
        own = sum(one.caller == caller for one in self._computations.values())
        if own >= MAXIMUM_WAITING_PER_CALLER:
            _refuse(f"{own} computations that you asked for wait already; ask again")
        if len(self._computations) >= MAXIMUM_WAITING:
            _refuse(f"{len(self._computations)} computations wait already; ask again")

    def _withdraw(self, computation: _Computation, caller: Hashable) -> None:
        with self._lock:
            self._requests[caller] -= 1
            if not self._requests[caller]:
                del self._requests[caller]
            computation.requests[caller] -= 1
            if not computation.requests.total():
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
