"""Aggregates of trends: what a historian asks for, within bounds whatever a client asks for."""

import asyncio
from datetime import UTC, datetime, timedelta
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
BEGIN = datetime.fromtimestamp(START / SECOND, UTC)
VALUES = [1.0, 4.0, 2.0, None, 9.0, 3.0, 3.0]
"""One a second; the fourth run does not determine it, the fifth one's fit was not accepted."""
FUNCTIONS = {
    name: ua.NodeId(getattr(ua.ObjectIds, f"AggregateFunction_{name}"))
    for name in ("Average", "Minimum", "Maximum", "Count", "Interpolative")
}


@pytest.fixture
def trends(database: Database) -> TrendHistory:
    with database.transaction() as session:
        machines.create(session, machine())
        for number, value in enumerate(VALUES):
            known = {} if value is None else {"coupling.C1.kxx": value}
            unknown = ["coupling.C1.kxx"] if value is None else []
            outcome = identification(known, unknown=unknown, accepted=value != 9.0)
            store_identification(session, outcome, run_id=number + 1, measured_at=START + number * SECOND)
    return TrendHistory(database)


def read(trends: TrendHistory, name: str, *, nodes: int = 1, continuation: Any = None, **asked: Any) -> Any:
    rules = ua.AggregateConfiguration(UseServerCapabilitiesDefaults="rules" not in asked, **asked.get("rules", {}))
    params = ua.HistoryReadParameters()
    params.HistoryReadDetails = ua.ReadProcessedDetails(
        StartTime=asked.get("begin", BEGIN),
        EndTime=asked.get("end", BEGIN + timedelta(seconds=8)),
        ProcessingInterval=asked.get("interval", 4000.0),
        AggregateType=[FUNCTIONS[name]] * asked.get("functions", nodes),
        AggregateConfiguration=rules,
    )
    params.ReleaseContinuationPoints = False
    params.NodesToRead = [ua.HistoryReadValueId(NodeId=NODE, ContinuationPoint=continuation) for _ in range(nodes)]
    return asyncio.run(trends.read(params, lambda _: True))


def values(found: Any) -> list[Any]:
    assert found.StatusCode.is_good(), found.StatusCode
    return [
        None if one.Value.Value is None else one.Value.Value / (1.0 if one.Value.VariantType == ua.VariantType.Int32 else 2e6)
        for one in found.HistoryData.DataValues
    ]


def statuses(found: Any) -> list[int]:
    return [one.StatusCode.value for one in found.HistoryData.DataValues]


UNCERTAIN, CALCULATED = ua.StatusCodes.UncertainDataSubNormal, 0x401


@pytest.mark.parametrize(
    ("name", "expected", "bits"),
    [
        ("Average", [7.0 / 3.0, 3.0], [UNCERTAIN | CALCULATED, UNCERTAIN | CALCULATED]),
        ("Minimum", [1.0, 3.0], [UNCERTAIN | 0x400, UNCERTAIN | CALCULATED | 0x10]),
        ("Maximum", [4.0, 3.0], [UNCERTAIN | CALCULATED, UNCERTAIN | CALCULATED | 0x10]),
        ("Count", [3, 2], [UNCERTAIN | CALCULATED, UNCERTAIN | CALCULATED]),
    ],
)
def test_each_interval_has_its_aggregate(trends: TrendHistory, name: str, expected: list[float], bits: list[int]) -> None:
    """A value that a run does not determine, or that does not fit, is not counted, and makes an interval uncertain."""
    (found,) = read(trends, name)
    assert values(found) == pytest.approx(expected)
    assert statuses(found) == bits
    assert [one.SourceTimestamp for one in found.HistoryData.DataValues] == [BEGIN, BEGIN + timedelta(seconds=4)]


def test_what_counts_as_good_is_the_clients_to_say(trends: TrendHistory) -> None:
    rules: dict[str, Any] = {"TreatUncertainAsBad": False, "PercentDataGood": 70, "PercentDataBad": 100}
    (found,) = read(trends, "Maximum", rules=rules)
    assert values(found) == pytest.approx([4.0, 9.0])
    assert statuses(found) == [CALCULATED, 0x400], "the greatest is at the interval's start: raw"
    (found,) = read(trends, "Maximum", rules=rules | {"PercentDataGood": 101})
    assert found.StatusCode.name == "BadAggregateConfigurationRejected"


def test_backwards_the_newest_interval_comes_first_and_a_short_one_is_partial(trends: TrendHistory) -> None:
    (found,) = read(trends, "Count", begin=BEGIN + timedelta(seconds=6), end=BEGIN - timedelta(seconds=1), interval=4000.0)
    assert values(found) == [2, 3]
    assert [code & 0x04 for code in statuses(found)] == [0, 0x04]


def test_an_interval_without_values_says_so(trends: TrendHistory) -> None:
    empty: dict[str, Any] = {"begin": BEGIN + timedelta(days=1), "end": BEGIN + timedelta(days=2), "interval": 0.0}
    (found,) = read(trends, "Average", **empty)
    assert values(found) == [None]
    assert statuses(found) == [ua.StatusCodes.BadNoData | 0x400]
    (found,) = read(trends, "Count", **empty)
    assert values(found) == [0]


def test_ten_years_of_seconds_come_in_pages(trends: TrendHistory, monkeypatch: pytest.MonkeyPatch) -> None:
    decade: dict[str, Any] = {"begin": BEGIN, "end": BEGIN + timedelta(days=3652), "interval": 1000.0}
    (found,) = read(trends, "Count", **decade)
    assert (len(values(found)), sum(values(found))) == (1000, 5)
    (rest,) = read(trends, "Count", continuation=found.ContinuationPoint, **decade)
    assert (len(values(rest)), sum(values(rest))) == (1000, 0)
    monkeypatch.setattr(trend_history, "PAGE", 3)
    counts, point = [], None
    while True:
        (found,) = read(trends, "Count", interval=1000.0, continuation=point)
        counts += values(found)
        point = found.ContinuationPoint
        if not point:
            break
    assert counts == [1, 1, 1, 0, 0, 1, 1, 0]


def test_raw_values_behind_an_answer_are_bounded(trends: TrendHistory, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trend_history, "MOST_AGGREGATED", 5)
    (found,) = read(trends, "Count")
    assert values(found) == [3], "so many intervals as are whole"
    (rest,) = read(trends, "Count", continuation=found.ContinuationPoint)
    assert values(rest) == [2]
    monkeypatch.setattr(trend_history, "MOST_AGGREGATED", 3)
    (found,) = read(trends, "Count")
    assert found.StatusCode.name == "BadRequestTooLarge"


@pytest.mark.parametrize(
    ("asked", "status"),
    [
        ({"name": "Interpolative"}, "BadAggregateNotSupported"),
        ({"interval": -1.0}, "BadAggregateInvalidInputs"),
        ({"interval": float("nan")}, "BadAggregateInvalidInputs"),
        ({"end": BEGIN}, "BadHistoryOperationInvalid"),
        ({"end": None}, "BadHistoryOperationInvalid"),
        ({"continuation": b"forged"}, "BadContinuationPointInvalid"),
        ({"continuation": b"\x01" + b"\xff" * 8}, "BadContinuationPointInvalid"),
    ],
)
def test_what_cannot_be_answered_is_said(trends: TrendHistory, asked: dict[str, Any], status: str) -> None:
    (found,) = read(trends, asked.pop("name", "Count"), **asked)
    assert found.StatusCode.name == status


def test_each_node_needs_its_aggregate(trends: TrendHistory) -> None:
    with pytest.raises(ServiceError) as error:
        read(trends, "Count", nodes=2, functions=1)
    assert error.value.code == ua.StatusCodes.BadAggregateListMismatch
