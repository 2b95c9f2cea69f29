"""Reads of ten years: in pages, each bounded, whatever a client asks for."""

import asyncio
from datetime import UTC, datetime
from typing import Any

import pytest
from asyncua import ua
from asyncua.common.utils import ServiceError

from service.opcua import trend_history
from service.opcua.trend_history import TrendHistory
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
        ({"continuation": b"\x01" + b"\xff" * 37}, "BadContinuationPointInvalid"),
        ({"release": True}, "Good"),
    ],
)
def test_what_cannot_be_answered_is_said(trends: TrendHistory, asked: dict[str, Any], status: str) -> None:
    (found,) = read(trends, **asked)
    assert found.StatusCode.name == status
