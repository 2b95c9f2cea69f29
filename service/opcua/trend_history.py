"""History of parameters: the points of trends, in pages.

Source: OPC 10000-11, 6.5.3 (ReadRawModifiedDetails), 3.1.9 and 4.6 (time domain, bounding values). A continuation point holds
all that the rest of a read needs: nothing is kept for clients that never come back. Raw values, one a run, and aggregates of
them are read (`trend_aggregates.py`); modified and interpolated ones are not kept.
"""

import asyncio
import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime

from asyncua import ua
from asyncua.common.utils import ServiceError
from sqlalchemy.exc import DBAPIError

from service.opcua.machine_nodes import LOWER, STATUS, UPPER
from service.opcua.machine_reading import ACCEPTED, FOLDERS, NOT_ACCEPTED, NOT_ESTIMABLE, PARAMETERS
from service.opcua.names import SEPARATOR
from service.opcua.trend_aggregates import AggregateRefused, Intervals, TrendValue, aggregates
from storage.clock import from_datetime, to_datetime
from storage.database.engine import Database
from storage.findings import trends
from storage.findings.jobs import RUN
from storage.findings.trends import HistoryPoint

MOST_NODES = 100
"""Largest number of nodes in one request."""
PAGE, MOST_VALUES = 1_000, 10_000
"""Largest number of values of one node, and of all, in one answer, bounds among them; a continuation point leads to more."""
MOST_AGGREGATED = 100_000
"""Largest number of raw values that the aggregates of one answer are computed from."""
MOST_WAITING = 20
"""Largest number of waiting requests: one is answered at a time, so that no read slows the service."""
EARLIEST, LATEST = 0, 2**62
UNSET = datetime(1601, 1, 2, tzinfo=UTC)
"""Times before this are OPC UA's way of saying none."""
_CONTINUATION = struct.Struct(">B??qqIqq")
_INTERVAL = struct.Struct(">BQ")
"""Continuation point of aggregates: the next interval."""
VERSION = 1
MICROSECOND = 1_000
"""Resolution in which clients are told times [ns]: a value's time is at most so much later than they know."""


@dataclass(frozen=True)
class PageRequest:
    """The rest of a read: between two times [ns], newest first or not, behind a point, so many values; 0 for all.

    bounds: whether the values before and behind these times are asked for, too.
    """

    descending: bool
    first: int
    last: int
    left: int
    after: tuple[int, int] | None = None
    bounds: bool = False

    def continuation(self) -> bytes:
        """Return it as a continuation point."""
        time, number = self.after or (0, 0)
        return _CONTINUATION.pack(VERSION, self.descending, self.bounds, self.first, self.last, self.left, time, number)

    @classmethod
    def continued(cls, point: bytes) -> "PageRequest":
        """Return the rest behind a continuation point. Raises ValueError."""
        if len(point) != _CONTINUATION.size or point[0] != VERSION:
            raise ValueError("no continuation point of this server")
        _, descending, bounds, first, last, left, time, number = _CONTINUATION.unpack(point)
        if not EARLIEST <= first <= last <= LATEST:
            raise ValueError("no continuation point of this server")
        return cls(descending, first, last, left, (time, number), bounds)

    @classmethod
    def of_request(cls, details: ua.ReadRawModifiedDetails) -> "PageRequest":
        """Return the page that a request begins with. Raises ValueError unless two of begin, end and number are given.

        Of begin and end the begin belongs to it, the end does not (OPC 10000-11, 3.1.9), unless they are the same.
        """
        begin, end, count = _time(details.StartTime), _time(details.EndTime), details.NumValuesPerNode
        if begin is not None and end is not None:
            if begin == end:
                return cls(False, begin, _within(begin), count)
            if begin > end:
                return cls(True, end + MICROSECOND, _within(begin), count, bounds=details.ReturnBounds)
            return cls(False, begin, end - 1, count, bounds=details.ReturnBounds)
        if count == 0 or (begin is None and end is None):
            raise ValueError("two of begin, end and number are needed")
        if begin is not None:
            return cls(False, begin, LATEST, count)
        return cls(True, EARLIEST, _within(end or 0), count)

    @property
    def begin(self) -> int:
        """Return the time at which it begins [ns]."""
        return self.last - MICROSECOND + 1 if self.descending else self.first

    @property
    def end(self) -> int:
        """Return the time before which it ends [ns]."""
        return self.first - MICROSECOND if self.descending else self.last + 1

    def beyond(self, *, end: bool) -> "PageRequest":
        """Return the request of the next value beyond its begin or its end."""
        if end == self.descending:
            return PageRequest(True, EARLIEST, self.first - 1, 1)
        return PageRequest(False, self.last + 1, LATEST, 1)


class TrendHistory:
    """Answers reads of history from the store."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._turn = asyncio.Lock()
        self._waiting = 0

    async def read(self, params: ua.HistoryReadParameters, sees: Callable[[ua.NodeId], bool]) -> list[ua.HistoryReadResult]:
        """Read the history of some nodes. sees: whether the client may know of a node. Raises ServiceError."""
        nodes, details = params.NodesToRead, params.HistoryReadDetails
        if len(nodes) > MOST_NODES or self._waiting >= MOST_WAITING:
            raise ServiceError(ua.StatusCodes.BadTooManyOperations)
        if params.ReleaseContinuationPoints:
            return [ua.HistoryReadResult() for _ in nodes]
        functions: list[ua.NodeId | None] = [None] * len(nodes)
        if isinstance(details, ua.ReadProcessedDetails):
            functions = list(details.AggregateType)
            if len(functions) != len(nodes):
                raise ServiceError(ua.StatusCodes.BadAggregateListMismatch)
        elif not isinstance(details, ua.ReadRawModifiedDetails) or details.IsReadModified:
            return [_failed(ua.StatusCodes.BadHistoryOperationUnsupported) for _ in nodes]
        self._waiting += 1
        try:
            async with self._turn:
                return [
                    await self._of_node(one, details, function, len(nodes)) if sees(one.NodeId) else _unknown()
                    for one, function in zip(nodes, functions, strict=True)
                ]
        finally:
            self._waiting -= 1

    async def _of_node(
        self, asked: ua.HistoryReadValueId, details: ua.HistoryReadDetails, function: ua.NodeId | None, nodes: int
    ) -> ua.HistoryReadResult:
        """Read the history of one node. nodes: number of nodes in the request, which share the largest answer."""
        path = str(asked.NodeId.Identifier).split(SEPARATOR)
        if len(path) not in (4, 5) or path[2] not in FOLDERS or path[4:] not in ([], [LOWER], [UPPER]):
            return _failed(ua.StatusCodes.BadHistoryOperationUnsupported)
        page = min(PAGE, MOST_VALUES // max(1, nodes))
        try:
            if function is None:
                return await asyncio.to_thread(self._raw, path, asked.ContinuationPoint, details, page)
            most = MOST_AGGREGATED // max(1, nodes)
            return await asyncio.to_thread(self._processed, path, asked.ContinuationPoint, details, function, page, most)
        except DBAPIError:
            return _failed(ua.StatusCodes.BadResourceUnavailable)

    def _raw(
        self, path: list[str], given: bytes | None, details: ua.ReadRawModifiedDetails, page: int
    ) -> ua.HistoryReadResult:
        try:
            wanted = PageRequest.continued(given) if given else PageRequest.of_request(details)
        except ValueError:
            wrong = ua.StatusCodes.BadContinuationPointInvalid if given else ua.StatusCodes.BadHistoryOperationInvalid
            return _failed(wrong)
        size = min(page, wanted.left or page)
        points = self._points(path, wanted, size + 1)
        result, bound, values = ua.HistoryReadResult(), path[4] if path[4:] else "", []
        at_begin = bool(points) and points[0].measured_at // MICROSECOND == wanted.begin // MICROSECOND
        if wanted.bounds and not given and not at_begin:
            values.append(self._beyond(path, wanted, bound, end=False))
        shown = points[: size - len(values)]
        values += [_value(one, bound) for one in shown]
        is_all = len(shown) == len(points)
        if wanted.bounds and is_all and len(values) < size:
            values.append(self._beyond(path, wanted, bound, end=True))
        elif wanted.bounds or not is_all:
            left = wanted.left - len(values) if wanted.left else 0
            if left or not wanted.left:
                last = shown[-1]
                rest = replace(wanted, left=left, after=(last.measured_at, last.identification))
                result.ContinuationPoint = rest.continuation()
        result.HistoryData = ua.HistoryData(values)
        return result

    def _beyond(self, path: list[str], wanted: PageRequest, bound: str, *, end: bool) -> ua.DataValue:
        """Return the value at or beyond an end of a read, or that there is none there."""
        for one in self._points(path, wanted.beyond(end=end), 1):
            return _value(one, bound)
        at = to_datetime(wanted.end if end else wanted.begin)
        none = ua.Variant(None, ua.VariantType.Null)
        return ua.DataValue(none, ua.StatusCode(ua.StatusCodes.BadBoundNotFound), SourceTimestamp=at)

    def _processed(
        self,
        path: list[str],
        given: bytes | None,
        details: ua.ReadProcessedDetails,
        function: ua.NodeId,
        page: int,
        most: int,
    ) -> ua.HistoryReadResult:
        """Read aggregates of at most a page of intervals, from at most so many raw values."""
        try:
            intervals = Intervals.of_request(function, _time(details.StartTime), _time(details.EndTime), details)
            first = _INTERVAL.unpack(given)[1] if given else 0
        except AggregateRefused as refused:
            return _failed(refused.code)
        except struct.error:
            return _failed(ua.StatusCodes.BadContinuationPointInvalid)
        if given and (given[0] != VERSION or not first < intervals.count):
            return _failed(ua.StatusCodes.BadContinuationPointInvalid)
        last = min(first + page, intervals.count)
        # An interval's begin belongs to it, its end does not.
        step = -1 if intervals.backwards else 1
        begin = intervals.start(first)
        end = (intervals.end if last == intervals.count else intervals.start(last)) - step
        wanted = PageRequest(intervals.backwards, min(begin, end), max(begin, end), 0)
        points = self._points(path, wanted, most + 1) if wanted.first <= wanted.last else []
        if len(points) > most:  # so many intervals as are whole
            last = intervals.number(points[most].measured_at)
            if last == first:
                return _failed(ua.StatusCodes.BadRequestTooLarge)
        bound = path[4] if path[4:] else ""
        values = (TrendValue(one.measured_at, _number(one, bound), one.accepted) for one in points)
        result = ua.HistoryReadResult()
        result.HistoryData = ua.HistoryData(list(aggregates(intervals, first, values, most=last - first)))
        if last < intervals.count:
            result.ContinuationPoint = _INTERVAL.pack(VERSION, last)
        return result

    def _points(self, path: list[str], wanted: PageRequest, limit: int) -> Sequence[HistoryPoint]:
        with self._database.reading() as session:
            return trends.page(
                session,
                path[1],
                path[3],
                derived=path[2] != PARAMETERS,
                scope=RUN,
                first=wanted.first,
                last=wanted.last,
                after=wanted.after,
                descending=wanted.descending,
                limit=limit,
            )


def _within(time: int) -> int:
    """Return the last nanosecond of the microsecond that clients see [ns]."""
    return min(time + MICROSECOND - 1, LATEST)


def _value(point: HistoryPoint, bound: str) -> ua.DataValue:
    value = _number(point, bound)
    status = STATUS[NOT_ESTIMABLE if value is None else ACCEPTED if point.accepted else NOT_ACCEPTED]
    held = ua.Variant(None, ua.VariantType.Null) if value is None else ua.Variant(value, ua.VariantType.Double)
    at = to_datetime(point.measured_at)
    return ua.DataValue(held, ua.StatusCode(status), SourceTimestamp=at, ServerTimestamp=to_datetime(point.computed_at))


def _number(point: HistoryPoint, bound: str) -> float | None:
    return {LOWER: point.lower, UPPER: point.upper}.get(bound, point.value)


def _time(at: datetime | None) -> int | None:
    if at is None:
        return None
    aware = at if at.tzinfo else at.replace(tzinfo=UTC)
    return None if aware < UNSET else min(max(from_datetime(aware), EARLIEST), LATEST)


def _failed(code: int) -> ua.HistoryReadResult:
    return ua.HistoryReadResult(StatusCode=ua.StatusCode(code))


def _unknown() -> ua.HistoryReadResult:
    return _failed(ua.StatusCodes.BadNodeIdUnknown)
