"""What failed for a reason of its own is tried again later, after twice the pause each time."""

import time

FIRST_PAUSE_S = 10.0
LONGEST_PAUSE_S = 3600.0


class PutOff:
    """Which of many, by name, must wait before they are tried again."""

    def __init__(self) -> None:
        self._waiting: dict[str, tuple[float, float]] = {}  # until when, and the pause before that

    def is_due(self, name: str) -> bool:
        """Whether it may be tried."""
        return name not in self._waiting or self._waiting[name][0] <= time.monotonic()

    def failed(self, name: str) -> float:
        """It waits. Returns how long [s]."""
        _, before = self._waiting.get(name, (0.0, FIRST_PAUSE_S / 2.0))
        pause = min(2.0 * before, LONGEST_PAUSE_S)
        self._waiting[name] = time.monotonic() + pause, pause
        return pause

    def succeeded(self, name: str) -> None:
        """It need not wait any more."""
        self._waiting.pop(name, None)
