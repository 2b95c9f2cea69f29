"""Speed readings as they come, freed of single wrong ones, and the noise of the readings.

A reading is believed as the median of itself and its two neighbours (Tukey, Exploratory Data Analysis, 1977), which
leaves every steady change as it is; so the newest one waits for the next. The noise comes from how far readings lie off the
straight line between their neighbours, which no steady acceleration changes.
"""

import math

import msgspec

RISE, FALL = 16, 96
"""Number of readings over which the noise is averaged, when it rises and when it falls: it rises sooner."""
HEAD_START = 8
"""Number of readings taken to have been quiet before the first one, so that one jump at the start is no noise."""
LARGEST_SURPRISE, SURPRISE_FLOOR = 4.0, 0.1
"""Largest deviation that counts, in multiples of the mean one plus a part of the speed [-]: wrong readings are no noise."""
MEAN_DEVIATION = 1.27
"""Mean deviation that results for normal errors of standard deviation 1 when it rises six times as fast as it falls [-]: an
expectile of theirs.
"""


class SpeedReadings(msgspec.Struct, frozen=True):
    """The last two readings, and the noise so far.

    Attributes:
        before_time: Time of the last reading but one [ns].
        before_speed: Speed of the last reading but one [rad/s].
        last_time: Time of the last reading [ns].
        last_speed: Speed of the last reading [rad/s].
        deviation: Typical distance of readings from the line between their neighbours, as of single readings [rad/s].
        count: Number of readings it comes from.
    """

    before_time: int | None = None
    before_speed: float = 0.0
    last_time: int | None = None
    last_speed: float = 0.0
    deviation: float = 0.0
    count: int = HEAD_START

    @property
    def noise(self) -> float:
        """Return the standard deviation of a reading [rad/s]; 0 as long as nothing is known."""
        return self.deviation / MEAN_DEVIATION

    def restarted(self) -> "SpeedReadings":
        """Return the state with nothing but the noise: the next readings do not continue the present ones.

        Returns:
            The state without readings.
        """
        return SpeedReadings(deviation=self.deviation, count=self.count)


NO_READINGS = SpeedReadings()
"""State before the first reading."""


def add_reading(readings: SpeedReadings, *, time: int, speed: float) -> tuple[SpeedReadings, tuple[int, float] | None]:
    """Take a reading, later than all before it.

    The first reading counts at once; each later reading confirms the one before it.

    Args:
        readings: State so far.
        time: Time of the reading [ns].
        speed: Speed of the reading [rad/s].

    Returns:
        Next state, and time [ns] and speed [rad/s] of the reading that is believed now, if any.
    """
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
