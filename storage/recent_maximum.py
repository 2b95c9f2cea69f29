"""The longest recent duration: an average would hide what delays others."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

PERIOD_S = 60.0


class RecentMaximum:
    """The longest duration [s] noted in this period or the one before."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._began = time.monotonic()
        self._now = self._before = 0.0

    @property
    def seconds(self) -> float:
        """Return the longest duration [s]; 0 when none was noted."""
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
        """Note the duration of the block."""
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
