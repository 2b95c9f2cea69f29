"""Tests the where clauses of event filters: what passes, what does not, and what is refused."""

from typing import Any

import pytest
from asyncua import ua

from service.opcua.condition_state import ConditionEvent, node
from service.opcua.event_filter import ConditionFilter, EventFilterWrong

EVENT = ConditionEvent(
    ua.NodeId(ua.ObjectIds.Server),
    {
        "EventType": node(ua.ObjectIds.AlarmConditionType),
        "Severity": ua.Variant(500, ua.VariantType.UInt16),
        "AckedState/Id": ua.Variant(False, ua.VariantType.Boolean),
    },
)


def literal(value: Any) -> ua.LiteralOperand:
    return ua.LiteralOperand(Value=ua.Variant(value))


def attribute(*names: str) -> ua.SimpleAttributeOperand:
    operand = ua.SimpleAttributeOperand()
    operand.BrowsePath = [ua.QualifiedName(name, 0) for name in names]
    operand.AttributeId = ua.AttributeIds.Value
    return operand


def clause(*elements: tuple[Any, list[Any]]) -> ua.ContentFilter:
    found = ua.ContentFilter()
    found.Elements = [ua.ContentFilterElement(FilterOperator=kind, FilterOperands=operands) for kind, operands in elements]
    return found


def of_type(number: int) -> tuple[Any, list[Any]]:
    return ua.FilterOperator.OfType, [literal(ua.NodeId(number))]


@pytest.mark.parametrize(
    ("elements", "passes"),
    [
        ([], True),
        ([of_type(ua.ObjectIds.BaseEventType)], True),
        ([of_type(ua.ObjectIds.AcknowledgeableConditionType)], True),
        ([of_type(ua.ObjectIds.LimitAlarmType)], False),
        ([(ua.FilterOperator.GreaterThanOrEqual, [attribute("Severity"), literal(500)])], True),
        ([(ua.FilterOperator.GreaterThan, [attribute("Severity"), literal(500)])], False),
        ([(ua.FilterOperator.GreaterThan, [attribute("Severity"), literal("text")])], False),
        ([(ua.FilterOperator.GreaterThan, [attribute("Nothing"), literal(1)])], False),
        ([(ua.FilterOperator.Equals, [attribute("AckedState", "Id"), literal(False)])], True),
        ([(ua.FilterOperator.Between, [attribute("Severity"), literal(400), literal(600)])], True),
        ([(ua.FilterOperator.InList, [attribute("Severity"), literal(1), literal(500)])], True),
        ([(ua.FilterOperator.IsNull, [attribute("Comment")])], True),
        (
            [
                (ua.FilterOperator.And, [ua.ElementOperand(1), ua.ElementOperand(2)]),
                of_type(ua.ObjectIds.ConditionType),
                (ua.FilterOperator.Not, [attribute("AckedState", "Id")]),
            ],
            True,
        ),
    ],
)
def test_what_passes(elements: list[tuple[Any, list[Any]]], passes: bool) -> None:
    assert ConditionFilter(clause(*elements)).eval(EVENT) is passes


@pytest.mark.parametrize(
    "elements",
    [
        [(ua.FilterOperator.Not, [ua.ElementOperand(0)])],
        [(ua.FilterOperator.Not, [ua.ElementOperand(9)])],
        [(ua.FilterOperator.Equals, [literal(1)])],
        [(ua.FilterOperator.Like, [attribute("Message"), literal("%a%")])],
        [(ua.FilterOperator.IsNull, [literal(1)])] * 201,
    ],
)
def test_what_is_not_evaluated_is_refused(elements: list[tuple[Any, list[Any]]]) -> None:
    with pytest.raises(EventFilterWrong):
        ConditionFilter(clause(*elements))


def test_a_clause_whose_elements_all_refer_to_the_next_twice_takes_no_time() -> None:
    chain = [(ua.FilterOperator.And, [ua.ElementOperand(n + 1), ua.ElementOperand(n + 1)]) for n in range(199)]
    assert ConditionFilter(clause(*chain, of_type(ua.ObjectIds.BaseEventType))).eval(EVENT)


def test_a_refresh_passes_every_filter() -> None:
    event = ConditionEvent(ua.NodeId(ua.ObjectIds.Server), {"EventType": node(ua.ObjectIds.RefreshEndEventType)})
    assert ConditionFilter(clause(of_type(ua.ObjectIds.LimitAlarmType))).eval(event)
