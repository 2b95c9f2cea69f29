"""Evaluates the where clauses of clients' event filters on conditions.

Source: OPC 10000-4, 7.7.3 (ContentFilter). The library's own evaluation knows no subtypes, which `OfType` asks for, and only
the first name of a path; what is compared with nothing here is not true, and never an error.
"""

import operator
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from asyncua import ua

from service.opcua.condition_state import ConditionEvent

ANCESTORS = {
    ua.NodeId(ua.ObjectIds.AlarmConditionType): (
        ua.ObjectIds.AlarmConditionType,
        ua.ObjectIds.AcknowledgeableConditionType,
        ua.ObjectIds.ConditionType,
        ua.ObjectIds.BaseEventType,
    ),
    ua.NodeId(ua.ObjectIds.RefreshStartEventType): (
        ua.ObjectIds.RefreshStartEventType,
        ua.ObjectIds.SystemEventType,
        ua.ObjectIds.BaseEventType,
    ),
    ua.NodeId(ua.ObjectIds.RefreshEndEventType): (
        ua.ObjectIds.RefreshEndEventType,
        ua.ObjectIds.SystemEventType,
        ua.ObjectIds.BaseEventType,
    ),
}
"""Each type of events that there is here, with the types above it."""
ALWAYS = frozenset({ua.NodeId(ua.ObjectIds.RefreshStartEventType), ua.NodeId(ua.ObjectIds.RefreshEndEventType)})
"""Types that pass every filter: OPC 10000-9, 4.5, asks for that, else a refresh could not be followed."""
MOST_ELEMENTS = 200

_COMPARISONS: Mapping[Any, Callable[[Any, Any], bool]] = {
    ua.FilterOperator.Equals: operator.eq,
    ua.FilterOperator.GreaterThan: operator.gt,
    ua.FilterOperator.LessThan: operator.lt,
    ua.FilterOperator.GreaterThanOrEqual: operator.ge,
    ua.FilterOperator.LessThanOrEqual: operator.le,
}
OPERANDS: Mapping[Any, int] = {
    **dict.fromkeys(_COMPARISONS, 2),
    ua.FilterOperator.IsNull: 1,
    ua.FilterOperator.Not: 1,
    ua.FilterOperator.Between: 3,
    ua.FilterOperator.InList: 2,
    ua.FilterOperator.And: 2,
    ua.FilterOperator.Or: 2,
    ua.FilterOperator.OfType: 1,
}
"""Fewest operands of each operator that is evaluated."""


class EventFilterWrong(ValueError):
    """A where clause holds what is not evaluated here."""


class ConditionFilter:
    """The where clause of one monitored item."""

    def __init__(self, clause: ua.ContentFilter | None) -> None:
        """Check a clause. Raises EventFilterWrong."""
        self._elements: Sequence[ua.ContentFilterElement] = [] if clause is None else clause.Elements or []
        if len(self._elements) > MOST_ELEMENTS:
            raise EventFilterWrong(f"a where clause has at most {MOST_ELEMENTS} elements")
        for number, element in enumerate(self._elements):
            operands = element.FilterOperands or []
            if len(operands) < OPERANDS.get(element.FilterOperator, len(operands) + 1):
                raise EventFilterWrong(f"{element.FilterOperator} with {len(operands)} operands is not evaluated")
            for operand in operands:
                # An element refers to later ones only: else it could go round in circles.
                if isinstance(operand, ua.ElementOperand) and not number < operand.Index < len(self._elements):
                    raise EventFilterWrong("an element refers to itself, to one before it, or to none")

    def eval(self, event: ConditionEvent) -> bool:
        """Return whether an event passes."""
        if not self._elements or event.value(("EventType",)) in ALWAYS:
            return True
        # From the last element on, as each refers to later ones only: none is evaluated twice.
        found: list[bool] = [False] * len(self._elements)
        for index in reversed(range(len(self._elements))):
            found[index] = self._element(self._elements[index], found, event)
        return found[0]

    def _element(self, element: ua.ContentFilterElement, found: Sequence[bool], event: ConditionEvent) -> bool:
        kind = element.FilterOperator
        values = [_value(one, found, event) for one in element.FilterOperands]
        if kind in (ua.FilterOperator.And, ua.FilterOperator.Or):
            return all(values[:2]) if kind == ua.FilterOperator.And else any(values[:2])
        if kind in _COMPARISONS:
            return _compared(_COMPARISONS[kind], values[0], values[1])
        if kind == ua.FilterOperator.Between:
            return _compared(operator.ge, values[0], values[1]) and _compared(operator.le, values[0], values[2])
        if kind == ua.FilterOperator.InList:
            return values[0] is not None and values[0] in values[1:]
        if kind == ua.FilterOperator.OfType:
            wanted = values[0]
            return any(wanted == ua.NodeId(one) for one in ANCESTORS.get(event.value(("EventType",)), ()))
        return values[0] is None if kind == ua.FilterOperator.IsNull else not values[0]


def _value(operand: Any, found: Sequence[bool], event: ConditionEvent) -> Any:
    """Return the value of an operand. found: results of the elements."""
    if isinstance(operand, ua.ElementOperand):
        return found[operand.Index]
    if isinstance(operand, ua.LiteralOperand):
        return None if operand.Value is None else operand.Value.Value
    if isinstance(operand, ua.SimpleAttributeOperand):
        return event.value([part.Name for part in operand.BrowsePath] or ["NodeId"])
    return None


def _compared(comparison: Callable[[Any, Any], bool], one: Any, other: Any) -> bool:
    if one is None or other is None:
        return False
    try:
        return bool(comparison(one, other))
    except TypeError:
        return False
