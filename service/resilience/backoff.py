"""Exponential backoff: what failed for a reason of its own is retried later, after twice the pause each time."""

import time
from typing import Generic, TypeVar

from service.resilience.bounded_dict import BoundedDict

FIRST_PAUSE_S = 10.0
LONGEST_PAUSE_S = 3600.0

Name = TypeVar("Name")


class Backoff(Generic[Name]):
    """Say which of many, by name, may be tried now. free: so many failures in a row cost no pause."""

    def __init__(self, *, free: int = 0) -> None:
        self._free = free
        self._failures: BoundedDict[Name, int] = BoundedDict()  # in a row
        self._until: BoundedDict[Name, float] = BoundedDict()

    def __len__(self) -> int:
        """Return how many failed when they were last tried."""
        return len(self._failures)

    def failures(self, name: Name) -> int:
        """Return how often in a row one failed."""
        return self._failures.get(name, 0)

    def is_due(self, name: Name) -> bool:
        """Return whether one may be tried now."""
        return self._until.get(name, 0.0) <= time.monotonic()

    def failed(self, name: Name, *, at_once: bool = False) -> float:
        """Count a failure; return the pause before the next try [s]. at_once: pause also where the failure would be free."""
        count = self._failures.get(name, 0) + 1
        if at_once:
            count = max(count, self._free + 1)
        self._failures[name] = count
        doublings = count - self._free - 1
        pause = 0.0 if doublings < 0 else min(FIRST_PAUSE_S * 2.0 ** min(doublings, 30), LONGEST_PAUSE_S)
        self._until[name] = time.monotonic() + pause
        return pause

    def succeeded(self, name: Name) -> None:
        """Forget the failures of one."""
        self._failures.pop(name, None)
        self._until.pop(name, None)
