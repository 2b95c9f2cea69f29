"""Caches results computed from data that never change; the least recently used ones are dropped first."""

import threading
from collections import OrderedDict
from collections.abc import Callable, Hashable
from contextlib import AbstractContextManager, nullcontext
from typing import TypeVar, cast

import threadpoolctl

from service.api.cache.computation_queue import ComputationQueue

T = TypeVar("T")

MAXIMUM_ENTRIES = 256


class ComputedCache:
    """Results by key. The key holds the id of an identification, which never changes.

    Long and short computations have a queue each, so that short ones do not wait for long ones.
    """

    def __init__(
        self,
        aside: Callable[[], AbstractContextManager[None]] = nullcontext,
        *,
        entries: int = MAXIMUM_ENTRIES,
        long_at_once: int = 1,
    ) -> None:
        """Set up without a result. aside: context that a request's thread enters while it waits; entries: results that are
        kept; long_at_once: long computations that run at a time."""
        self._largest = entries
        self._entries: OrderedDict[Hashable, object] = OrderedDict()
        self._lock = threading.Lock()
        self._aside = aside
        self._long = ComputationQueue("long computations", at_once=long_at_once)
        self._short = ComputationQueue("short computations")

    @property
    def waiting(self) -> int:
        """Return the number of different computations asked for and not finished."""
        return self._long.waiting + self._short.waiting

    def get_or_compute(self, key: Hashable, compute: Callable[[], T]) -> T:
        """Return the cached result, or compute one that takes no time. Raises what `compute` raises."""
        with self._lock:
            if key in self._entries:
                self._entries.move_to_end(key)
                return cast(T, self._entries[key])
        found = compute()
        with self._lock:
            self._entries[key] = found
            while len(self._entries) > self._largest:
                self._entries.popitem(last=False)
        return found

    def compute_queued(
        self, key: Hashable, compute: Callable[[], T], *, long: bool, caller: Hashable, wanted: Callable[[], bool]
    ) -> T:
        """Return the cached result, or compute one that takes tenths of a second, or seconds where it is long.

        Short ones run one at a time, and each on one core, to leave the others to samples and other requests. Call it from a
        worker thread, not on the event loop. For caller, wanted and what is raised see `ComputationQueue.result`.
        """
        with self._lock:
            if key in self._entries:
                self._entries.move_to_end(key)
                return cast(T, self._entries[key])
        queue = self._long if long else self._short
        with self._aside():
            return queue.result(key, lambda: self._on_one_core(key, compute), caller=caller, wanted=wanted)

    def close(self) -> None:
        """Give up the computations that wait."""
        self._long.close()
        self._short.close()

    def _on_one_core(self, key: Hashable, compute: Callable[[], T]) -> T:
        with threadpoolctl.threadpool_limits(1):
            return self.get_or_compute(key, compute)  # it may have been computed between the first look and its turn
