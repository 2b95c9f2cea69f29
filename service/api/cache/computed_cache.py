"""Caches results computed from data that never change; the least recently used ones are dropped first."""

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from contextlib import AbstractContextManager, nullcontext
from typing import TypeVar, cast

import threadpoolctl
from fastapi import HTTPException, status

T = TypeVar("T")

MAXIMUM_ENTRIES = 256
MAXIMUM_WAITING = 24
"""Number of slow computations that may wait: each has one thread, and another is lent to the server for it.

It is enough for the model's page of a train on oil films that is loaded three times in a row.
"""
MAXIMUM_WAITING_SHORT = 16
"""Number of those of ordinary trains that may wait, each of which takes tenths of a second."""
RETRY_AFTER_S = 5


class ComputedCache:
    """Results by key. The key holds the id of an identification, which never changes.

    Long and short computations have a queue each, so that short ones do not wait for long ones.
    """

    def __init__(self, aside: Callable[[], AbstractContextManager[None]] = nullcontext) -> None:
        """Set up without a result. aside: entered by a thread while it waits and computes."""
        self._entries: OrderedDict[Hashable, object] = OrderedDict()
        self._lock = threading.Lock()
        self._aside = aside
        self._slow, self._short = _Queue(MAXIMUM_WAITING), _Queue(MAXIMUM_WAITING_SHORT)

    @property
    def waiting(self) -> int:
        """Return the number of slow computations asked for and not finished."""
        return self._slow.waiting

    def quick(self, key: Hashable, compute: Callable[[], T]) -> T:
        """Return the cached result, or compute one that takes no time. Raises what `compute` raises."""
        with self._lock:
            if key in self._entries:
                self._entries.move_to_end(key)
                return cast(T, self._entries[key])
        found = compute()
        with self._lock:
            self._entries[key] = found
            while len(self._entries) > MAXIMUM_ENTRIES:
                self._entries.popitem(last=False)
        return found

    def slow(self, key: Hashable, compute: Callable[[], T]) -> T:
        """Return the cached result, or compute one that takes seconds.

        Computations run one at a time, on one core, to leave the other cores to samples and other requests. Call it from a
        worker thread, not on the event loop. Raises HTTPException 503 when too many wait.
        """
        return self._in_turn(self._slow, key, compute)

    def short(self, key: Hashable, compute: Callable[[], T]) -> T:
        """Return the cached result, or compute one that takes tenths of a second, as `slow` does in a queue of its own."""
        return self._in_turn(self._short, key, compute)

    def _in_turn(self, queue: "_Queue", key: Hashable, compute: Callable[[], T]) -> T:
        with self._lock:
            if key in self._entries:
                self._entries.move_to_end(key)
                return cast(T, self._entries[key])
            queue.enter()
        try:
            with self._aside(), queue.turn, threadpoolctl.threadpool_limits(1):
                return self.quick(key, compute)  # another thread may have computed it meanwhile
        finally:
            with self._lock:
                queue.waiting -= 1


class _Queue:
    """Computations that take turns. waiting: number of those asked for and not finished."""

    def __init__(self, most: int) -> None:
        self._most = most
        self.turn = threading.Lock()
        self.waiting = 0

    def enter(self) -> None:
        """Count one more. Raises HTTPException 503 when too many wait."""
        if self.waiting >= self._most:
            raise HTTPException(
                status.HTTP_503_SERVICE_UNAVAILABLE,
                f"{self.waiting} computations wait already; ask again",
                {"Retry-After": str(RETRY_AFTER_S)},
            )
        self.waiting += 1
