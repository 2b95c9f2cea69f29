"""What failed for a reason of its own is tried again later, after twice the pause each time."""

import time
from typing import Generic, TypeVar

from service.bounded import Bounded

FIRST_PAUSE_S = 10.0
LONGEST_PAUSE_S = 3600.0

Name = TypeVar("Name")


class PutOff(Generic[Name]):
    """Which of many, by name, must wait before they are tried again. free: so many failures in a row cost no pause."""

    def __init__(self, *, free: int = 0) -> None:
        self._free = free
        self._failures: Bounded[Name, int] = Bounded()  # in a row
        self._until: Bounded[Name, float] = Bounded()

    def __len__(self) -> int:
        """How many failed when they were last tried."""
        return len(self._failures)

    def failures(self, name: Name) -> int:
        """How often in a row it failed."""
        return self._failures.get(name, 0)

    def is_due(self, name: Name) -> bool:
        """Whether it may be tried."""
        return self._until.get(name, 0.0) <= time.monotonic()

    def failed(self, name: Name, *, at_once: bool = False) -> float:
        """It waits; at once also where that failure would be free. Returns how long [s]."""
        count = self._failures.get(name, 0) + 1
        if at_once:
            count = max(count, self._free + 1)
        self._failures[name] = count
        doublings = count - self._free - 1
        pause = 0.0 if doublings < 0 else min(FIRST_PAUSE_S * 2.0 ** min(doublings, 30), LONGEST_PAUSE_S)
        self._until[name] = time.monotonic() + pause
        return pause

    def succeeded(self, name: Name) -> None:
        """It need not wait any more."""
        self._failures.pop(name, None)
        self._until.pop(name, None)
