"""Reads of ten years: in pages, each bounded, whatever a client asks for."""

import asyncio
from datetime import UTC, datetime
from typing import Any

import pytest
from asyncua import ua
from asyncua.common.utils import ServiceError

from service.opcua import trend_history
from service.opcua.trend_history import TrendHistory
from storage.clock import to_datetime
from storage.database.engine import Database
from storage.machines import machines
from tests.plant import KEY, SECOND, START, identification, machine, store_identification

NODE = ua.NodeId(f"{KEY.plant}/{KEY.machine}/Parameters/coupling.C1.kxx", 2)
RUNS = 25
TEN_YEARS = datetime(2020, 1, 1, tzinfo=UTC), datetime(2030, 1, 1, tzinfo=UTC)


@pytest.fixture
def trends(database: Database) -> TrendHistory:
    with database.transaction() as session:
        machines.create(session, machine())
        for number in range(RUNS):
            outcome = identification({"coupling.C1.kxx": 1.0 + number})
            store_identification(session, outcome, run_id=number + 1, measured_at=START + number // 2 * SECOND)
    return TrendHistory(database)


def read(trends: TrendHistory, *, nodes: int = 1, continuation: Any = None, release: bool = False, **details: Any) -> Any:
    params = ua.HistoryReadParameters()
    params.HistoryReadDetails = ua.ReadRawModifiedDetails(
        StartTime=details.get("begin", TEN_YEARS[0]),
        EndTime=details.get("end", TEN_YEARS[1]),
        NumValuesPerNode=details.get("count", 0),
        IsReadModified=details.get("modified", False),
        ReturnBounds=details.get("bounds", False),
    )
    params.ReleaseContinuationPoints = release
    params.NodesToRead = [ua.HistoryReadValueId(NodeId=NODE, ContinuationPoint=continuation) for _ in range(nodes)]
    return asyncio.run(trends.read(params, lambda _: True))


def pages(trends: TrendHistory, **details: Any) -> list[list[float]]:
    found, continuation = [], None
    while True:
        (one,) = read(trends, continuation=continuation, **details)
        assert one.StatusCode.is_good()
        found.append([value.Value.Value for value in one.HistoryData.DataValues])
        continuation = one.ContinuationPoint
        if not continuation:
            return found


@pytest.mark.parametrize("backwards", [False, True])
def test_every_value_comes_once_over_pages(trends: TrendHistory, monkeypatch: pytest.MonkeyPatch, backwards: bool) -> None:
    """Two runs at a time have the same time: a page that ended between them must not lose or repeat one."""
    monkeypatch.setattr(trend_history, "PAGE", 7)
    begin, end = TEN_YEARS[::-1] if backwards else TEN_YEARS
    found = pages(trends, begin=begin, end=end)
    assert [len(one) for one in found] == [7, 7, 7, 4]
    values = [value for one in found for value in one]
    assert values == pytest.approx([2e6 * (1 + n) for n in range(RUNS)][:: -1 if backwards else 1])


def test_a_number_of_values_ends_over_pages_as_well(trends: TrendHistory, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trend_history, "PAGE", 7)
    assert [len(one) for one in pages(trends, count=10)] == [7, 3]
    assert [len(one) for one in pages(trends, end=None, count=3)] == [3]
    (last,) = pages(trends, begin=None, count=1)
    assert last == pytest.approx([2e6 * RUNS])


def at(number: int) -> datetime:
    """Time of the runs 2·number and 2·number + 1."""
    return to_datetime(START + number * SECOND)


def told(one: Any) -> list[float | str]:
    """The values of an answer in 2 MN/m, its status codes where there are none."""
    found = one.HistoryData.DataValues
    return [value.StatusCode.name if value.Value.Value is None else round(value.Value.Value / 2e6) for value in found]


@pytest.mark.parametrize(
    ("begin", "end", "values", "bounded"),
    [
        (2, 4, [5, 6, 7, 8], [5, 6, 7, 8, 9]),
        (4, 2, [10, 9, 8, 7], [10, 9, 8, 7, 6]),
        (-5, 1, [1, 2], ["BadBoundNotFound", 1, 2, 3]),
        (12, 99, [25], [25, "BadBoundNotFound"]),
        (99, 12, [], ["BadBoundNotFound", 25]),
        (50, 60, [], [25, "BadBoundNotFound"]),
        (3, 3, [7, 8], [7, 8]),
    ],
)
def test_the_end_does_not_belong_to_a_read_and_bounds_are_told_when_asked(
    trends: TrendHistory, begin: int, end: int, values: list[float | str], bounded: list[float | str]
) -> None:
    """Reading stretch after stretch gives everything once, as OPC 10000-11, 3.1.9, asks."""
    asked: dict[str, Any] = {"begin": at(begin), "end": at(end)}
    assert told(read(trends, **asked)[0]) == values
    assert told(read(trends, bounds=True, **asked)[0]) == bounded


def test_a_read_from_the_end_of_all_time_has_pages_as_well(trends: TrendHistory, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trend_history, "PAGE", 10)
    last, first = datetime(9999, 12, 31, tzinfo=UTC), datetime(1970, 1, 1, tzinfo=UTC)
    for begin, end in ((last, first), (first, last)):
        assert [len(one) for one in pages(trends, begin=begin, end=end)] == [10, 10, 5]
    assert [len(one) for one in pages(trends, begin=None, end=last, count=12)] == [10, 2]


def test_bounds_come_once_over_pages(trends: TrendHistory, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trend_history, "PAGE", 2)
    asked: dict[str, Any] = {"begin": at(2), "end": at(5), "bounds": True}
    continuation: Any = None
    found: list[list[float | str]] = []
    while continuation is not None or not found:
        (one,) = read(trends, continuation=continuation, **asked)
        found.append(told(one))
        continuation = one.ContinuationPoint or None
    assert found == [[5, 6], [7, 8], [9, 10], [11]]


@pytest.mark.parametrize("backwards", [False, True])
def test_no_answer_holds_more_with_bounds_than_clients_are_told(
    trends: TrendHistory, monkeypatch: pytest.MonkeyPatch, backwards: bool
) -> None:
    """Bounds count among a page's values, and among those that a client asks for."""
    monkeypatch.setattr(trend_history, "PAGE", 3)
    begin, end = (at(5), at(-1)) if backwards else (at(-1), at(5))
    asked: dict[str, Any] = {"begin": begin, "end": end, "bounds": True}
    point: Any = None
    found: list[list[float | str]] = []
    while point is not None or not found:
        (one,) = read(trends, continuation=point, **asked)
        found.append(told(one))
        point = one.ContinuationPoint or None
    assert {len(one) for one in found[:-1]} == {3}
    assert len(found[-1]) <= 3
    values = [value for one in found for value in one]
    assert values == ([*range(12, 0, -1), "BadBoundNotFound"] if backwards else ["BadBoundNotFound", *range(1, 12)])
    for count in (1, 2, 3, 4, 5):
        point, values = None, []
        while point is not None or not values:
            (one,) = read(trends, count=count, continuation=point, **asked)
            assert len(told(one)) <= 3
            values += told(one)
            point = one.ContinuationPoint or None
        assert len(values) == count


def test_many_nodes_share_what_one_answer_may_hold(trends: TrendHistory, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trend_history, "MOST_VALUES", 30)
    found = read(trends, nodes=10)
    assert [len(one.HistoryData.DataValues) for one in found] == [3] * 10
    assert all(one.ContinuationPoint for one in found)
    with pytest.raises(ServiceError) as error:
        read(trends, nodes=101)
    assert error.value.code == ua.StatusCodes.BadTooManyOperations


@pytest.mark.parametrize(
    ("asked", "status"),
    [
        ({"modified": True}, "BadHistoryOperationUnsupported"),
        ({"begin": None, "end": None, "count": 5}, "BadHistoryOperationInvalid"),
        ({"end": None}, "BadHistoryOperationInvalid"),
        ({"continuation": b"forged"}, "BadContinuationPointInvalid"),
        ({"continuation": b"\x01" + b"\xff" * 38}, "BadContinuationPointInvalid"),
        ({"release": True}, "Good"),
    ],
)
def test_what_cannot_be_answered_is_said(trends: TrendHistory, asked: dict[str, Any], status: str) -> None:
    (found,) = read(trends, **asked)
    assert found.StatusCode.name == status
