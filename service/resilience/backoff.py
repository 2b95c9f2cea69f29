"""Exponential backoff: work that failed for a reason of its own is retried later, after twice the pause each time."""

import time
from typing import Generic, TypeVar

from service.resilience.bounded_dict import BoundedDict

FIRST_PAUSE_S = 10.0
LONGEST_PAUSE_S = 3600.0

WorkName = TypeVar("WorkName")


class Backoff(Generic[WorkName]):
    """Retry times of many pieces of work, by name. free: this many failures in a row cause no pause."""

    def __init__(self, *, free: int = 0) -> None:
        self._free = free
        self._failures: BoundedDict[WorkName, int] = BoundedDict()  # in a row
        self._until: BoundedDict[WorkName, float] = BoundedDict()

    def __len__(self) -> int:
        """Return how many failed at their last attempt."""
        return len(self._failures)

    def failures(self, name: WorkName) -> int:
        """Return the number of failures in a row."""
        return self._failures.get(name, 0)

    def is_due(self, name: WorkName) -> bool:
        """Return whether an attempt may be made now."""
        return self._until.get(name, 0.0) <= time.monotonic()

    def failed(self, name: WorkName, *, at_once: bool = False) -> float:
        """Count a failure; return the pause before the next attempt [s]. at_once: pause even if the failure is free."""
        count = self._failures.get(name, 0) + 1
        if at_once:
            count = max(count, self._free + 1)
        self._failures[name] = count
        doublings = count - self._free - 1
        pause = 0.0 if doublings < 0 else min(FIRST_PAUSE_S * 2.0 ** min(doublings, 30), LONGEST_PAUSE_S)
        self._until[name] = time.monotonic() + pause
        return pause

    def succeeded(self, name: WorkName) -> None:
        """Reset the failures."""
        self._failures.pop(name, None)
        self._until.pop(name, None)
