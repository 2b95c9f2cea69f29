"""Aggregates over intervals of a trend: average, minimum, maximum and count of the values of runs.

Source: OPC 10000-11, 6.5.4 (ReadProcessedDetails); OPC 10000-13, 5.4.3 (Average, Minimum, Maximum, Count, and the status of
aggregates that are not based on time). Raw values are one a run; nothing is interpolated between them.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from asyncua import ua

from storage.clock import to_datetime

AVERAGE, MINIMUM = ua.ObjectIds.AggregateFunction_Average, ua.ObjectIds.AggregateFunction_Minimum
MAXIMUM, COUNT = ua.ObjectIds.AggregateFunction_Maximum, ua.ObjectIds.AggregateFunction_Count
FUNCTIONS = (AVERAGE, MINIMUM, MAXIMUM, COUNT)
"""Aggregates that are computed."""
HISTORIAN, CALCULATED, PARTIAL, MULTIPLE = 0x400, 0x01, 0x04, 0x10
"""Bits of a status code that say how a historian came by a value (OPC 10000-4, 7.39.1)."""
WHOLE_PERCENT = 100
LONGEST_NS = 2**62


class AggregateRefused(Exception):
    """A read of aggregates is refused with a status code."""

    def __init__(self, code: int) -> None:
        super().__init__(code)
        self.code = code


@dataclass(frozen=True)
class TrendValue:
    """A raw value at a time [ns]. good: whether its fit was accepted; value: None where a run does not determine it."""

    time: int
    value: float | None
    good: bool


@dataclass(frozen=True)
class Intervals:
    """Intervals of a width [ns] from `begin` towards `end` [ns], which may be earlier; the last one may be shorter.

    percent_good, percent_bad: shares of values from which on an aggregate is good or bad.
    """

    function: int
    begin: int
    end: int
    width: int
    uncertain_is_bad: bool = True
    percent_good: int = WHOLE_PERCENT
    percent_bad: int = WHOLE_PERCENT

    @classmethod
    def of_request(
        cls, function: ua.NodeId, begin: int | None, end: int | None, details: ua.ReadProcessedDetails
    ) -> "Intervals":
        """Return the intervals of a request. Raises AggregateRefused."""
        if function.NamespaceIndex != 0 or function.Identifier not in FUNCTIONS:
            raise AggregateRefused(ua.StatusCodes.BadAggregateNotSupported)
        if begin is None or end is None or begin == end:
            raise AggregateRefused(ua.StatusCodes.BadHistoryOperationInvalid)
        asked = details.ProcessingInterval
        if not math.isfinite(asked) or asked < 0.0:
            raise AggregateRefused(ua.StatusCodes.BadAggregateInvalidInputs)
        span = abs(end - begin)
        width = span if asked == 0.0 else max(1, round(min(asked * 1e6, LONGEST_NS)))
        rules = details.AggregateConfiguration
        if rules is None or rules.UseServerCapabilitiesDefaults:
            return cls(function.Identifier, begin, end, width)
        if max(rules.PercentDataGood, rules.PercentDataBad) > WHOLE_PERCENT:
            raise AggregateRefused(ua.StatusCodes.BadAggregateConfigurationRejected)
        shares = rules.PercentDataGood, rules.PercentDataBad
        return cls(function.Identifier, begin, end, width, rules.TreatUncertainAsBad, *shares)

    @property
    def backwards(self) -> bool:
        """Return whether the newest interval comes first."""
        return self.begin > self.end

    @property
    def count(self) -> int:
        """Count the intervals."""
        return -(-abs(self.end - self.begin) // self.width)

    def start(self, number: int) -> int:
        """Return where an interval begins [ns]; that moment belongs to it, its end does not."""
        return self.begin - number * self.width if self.backwards else self.begin + number * self.width

    def number(self, time: int) -> int:
        """Return the interval of a time [ns]."""
        return abs(time - self.begin) // self.width

    def cut(self, number: int) -> bool:
        """Return whether an interval is shorter than the others."""
        return (number + 1) * self.width > abs(self.end - self.begin)


@dataclass
class _Held:
    """The values of one interval so far."""

    counted: list[TrendValue] = field(default_factory=list)
    bad: int = 0


def aggregates(intervals: Intervals, first: int, values: Iterable[TrendValue], *, most: int) -> Iterator[ua.DataValue]:
    """Yield the aggregates of at most `most` intervals, beginning with `first`. values: in the intervals' order, from there
    on."""
    held: dict[int, _Held] = {}
    last = min(first + most, intervals.count)
    for one in values:
        number = intervals.number(one.time)
        if number >= last:
            break
        place = held.setdefault(number, _Held())
        if one.value is None or (not one.good and intervals.uncertain_is_bad):
            place.bad += 1
        else:
            place.counted.append(one)
    for number in range(first, last):
        yield _aggregate(intervals, number, held.get(number, _Held()))


def _aggregate(intervals: Intervals, number: int, held: _Held) -> ua.DataValue:
    start = intervals.start(number)
    bits = HISTORIAN | (PARTIAL if intervals.cut(number) else 0)
    code, value = _status(intervals, held), None
    if intervals.function == COUNT:
        value, bits = float(len(held.counted)), bits | CALCULATED
    elif held.counted:
        value, more = _extreme_or_average(intervals, start, held.counted)
        bits |= more
    kind = ua.VariantType.Int32 if intervals.function == COUNT else ua.VariantType.Double
    variant = ua.Variant(None, ua.VariantType.Null)
    if value is not None and not ua.StatusCode(code).is_bad():
        variant = ua.Variant(int(value) if intervals.function == COUNT else value, kind)
    at = to_datetime(start)
    return ua.DataValue(variant, ua.StatusCode(code | bits), SourceTimestamp=at, ServerTimestamp=at)


def _extreme_or_average(intervals: Intervals, start: int, counted: list[TrendValue]) -> tuple[float, int]:
    """Return the value, and the bits that say how it came about: an extreme at the interval's start is a raw value."""
    numbers = [one.value for one in counted if one.value is not None]
    if intervals.function == AVERAGE:
        return math.fsum(numbers) / len(numbers), CALCULATED
    value = min(numbers) if intervals.function == MINIMUM else max(numbers)
    times = {one.time for one in counted if one.value == value}
    return value, (0 if start in times else CALCULATED) | (MULTIPLE if len(times) > 1 else 0)


def _status(intervals: Intervals, held: _Held) -> int:
    """Return the status by the shares of good and bad values."""
    good, whole = len(held.counted), len(held.counted) + held.bad
    if good == 0 and intervals.function == COUNT:  # the count is then zero
        return int(ua.StatusCodes.UncertainDataSubNormal if whole else ua.StatusCodes.Good)
    if good == 0:
        return int(ua.StatusCodes.BadNoData)
    if WHOLE_PERCENT * good >= intervals.percent_good * whole:
        return int(ua.StatusCodes.Good)
    bad = WHOLE_PERCENT * held.bad >= intervals.percent_bad * whole
    return int(ua.StatusCodes.Bad if bad else ua.StatusCodes.UncertainDataSubNormal)
