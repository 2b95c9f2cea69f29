"""How long something took at the longest, in the last minute or two: an average would hide what holds others up."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

PERIOD_S = 60.0


class RecentMaximum:
    """The longest of the durations [s] that were noted in this period and in the one before."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._began = time.monotonic()
        self._now = self._before = 0.0

    @property
    def seconds(self) -> float:
        """The longest so far [s]; 0 where nothing was noted."""
        with self._lock:
            self._turn()
            return max(self._now, self._before)

    def note(self, seconds: float) -> None:
        """Note a duration [s]."""
        with self._lock:
            self._turn()
            self._now = max(self._now, seconds)

    @contextmanager
    def measured(self) -> Iterator[None]:
        """Note how long what happens within takes."""
        began = time.monotonic()
        try:
            yield
        finally:
            self.note(time.monotonic() - began)

    def _turn(self) -> None:
        periods = int((time.monotonic() - self._began) / PERIOD_S)
        if periods > 0:
            self._before = self._now if periods == 1 else 0.0
            self._now = 0.0
            self._began += periods * PERIOD_S
