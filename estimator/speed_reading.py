"""Speed readings as they come: one wrong one does nothing, and how noisy they are is known.

A reading is believed as the median of itself and its two neighbours, which leaves every steady change as it is; so the newest
one waits for the next. The noise comes from how far readings lie off the straight line between their neighbours, which no
steady acceleration changes.
"""

import math

import msgspec

RISE, FALL = 16, 96
"""Readings over which the noise is averaged: it rises sooner than it falls."""
HEAD_START = 8
"""Readings that are taken to have been quiet before the first one, so that one jump at the start is no noise."""
LARGEST_SURPRISE, SURPRISE_FLOOR = 4.0, 0.1
"""A deviation counts for at most this many times the mean one and this part of the speed: wrong readings are no noise."""
MEAN_DEVIATION = 1.27
"""What rising six times as fast as falling leads to with normal errors of standard deviation 1: an expectile of theirs."""


class SpeedReadings(msgspec.Struct, frozen=True):
    """The last two readings, times [ns] and speeds [rad/s], and the noise so far.

    deviation: typical distance of readings from the line between their neighbours, as of single readings [rad/s].
    count: how many it comes from.
    """

    before_time: int | None = None
    before_speed: float = 0.0
    last_time: int | None = None
    last_speed: float = 0.0
    deviation: float = 0.0
    count: int = HEAD_START

    @property
    def noise(self) -> float:
        """Standard deviation of a reading [rad/s]; 0 as long as nothing is known."""
        return self.deviation / MEAN_DEVIATION

    def forgotten(self) -> "SpeedReadings":
        """Only the noise is remembered: what comes next does not follow these readings."""
        return SpeedReadings(deviation=self.deviation, count=self.count)


NO_READINGS = SpeedReadings()
"""Before the first one."""


def take(readings: SpeedReadings, *, time: int, speed: float) -> tuple[SpeedReadings, tuple[int, float] | None]:
    """Take a reading, later than all before it; what is believed now: the first one at once, then always the one before."""
    before, last = readings.before_time, readings.last_time
    if last is None:
        first = SpeedReadings(None, 0.0, time, speed, readings.deviation, readings.count)
        return first, (time, speed)
    if before is None:
        return SpeedReadings(last, readings.last_speed, time, speed, readings.deviation, readings.count), None
    _, middle, high = sorted((readings.before_speed, readings.last_speed, speed))
    part = (last - before) / (time - before)
    off = abs(readings.last_speed - ((1.0 - part) * readings.before_speed + part * speed))
    off /= math.sqrt(1.0 + part**2 + (1.0 - part) ** 2)
    off = min(off, LARGEST_SURPRISE * readings.deviation + SURPRISE_FLOOR * high)
    count = min(readings.count + 1, FALL)
    weight = 1.0 / min(count, RISE if off > readings.deviation else FALL)
    deviation = readings.deviation + (off - readings.deviation) * weight
    return SpeedReadings(last, readings.last_speed, time, speed, deviation, count), (last, middle)
