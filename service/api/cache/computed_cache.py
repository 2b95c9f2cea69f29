"""Caches results computed from data that never change; the least recently used ones are dropped first."""

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import TypeVar, cast

import threadpoolctl
from fastapi import HTTPException, status

T = TypeVar("T")

MAXIMUM_ENTRIES = 256
MAXIMUM_WAITING = 8
"""Largest number of waiting computations; further requests get a 503, because each waiting one holds a thread.

It is enough for a page of the model that is loaded three times in a row.
"""
RETRY_AFTER_S = 5


class ComputedCache:
    """Results by key. The key holds the id of an identification, which never changes.

    waiting: number of slow computations asked for and not finished.
    """

    def __init__(self) -> None:
        self._entries: OrderedDict[Hashable, object] = OrderedDict()
        self._lock = threading.Lock()
        self._turn = threading.Lock()
        self.waiting = 0

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
        with self._lock:
            if key in self._entries:
                self._entries.move_to_end(key)
                return cast(T, self._entries[key])
            if self.waiting >= MAXIMUM_WAITING:
                raise HTTPException(
                    status.HTTP_503_SERVICE_UNAVAILABLE,
                    f"{self.waiting} computations wait already; ask again",
                    {"Retry-After": str(RETRY_AFTER_S)},
                )
            self.waiting += 1
        try:
            with self._turn, threadpoolctl.threadpool_limits(1):
                return self.quick(key, compute)  # another thread may have computed it meanwhile
        finally:
            with self._lock:
                self.waiting -= 1
