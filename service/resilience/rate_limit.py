"""Rate limits by token buckets that fill at a steady rate."""

import time
from collections import OrderedDict
from collections.abc import Callable

MAXIMUM_BUCKETS = 10_000


class RateLimit:
    """Token buckets by name. per_s: tokens added each second; burst: capacity of a bucket."""

    def __init__(self, *, per_s: float, burst: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._per_s = per_s
        self._burst = burst
        self._clock = clock
        self._buckets: OrderedDict[str, tuple[float, float]] = OrderedDict()

    def take(self, name: str) -> float:
        """Take a token; return 0, or the wait until there is one [s]. Called on the event loop only."""
        now = self._clock()
        left, at = self._buckets.pop(name, (self._burst, now))
        left = min(self._burst, left + (now - at) * self._per_s)
        taken = left >= 1.0
        self._buckets[name] = (left - 1.0 if taken else left), now
        if len(self._buckets) > MAXIMUM_BUCKETS:
            self._buckets.popitem(last=False)  # the least recently used, which has filled up most
        return 0.0 if taken else (1.0 - left) / self._per_s
