"""Reads single numbers of ROSS's elements, and says which element they are missing from."""

from collections.abc import Mapping
from typing import Any


class NotInROSS(ValueError):
    """Raised for an element that a machine document cannot describe; the message names it."""


def float_of(name: str, element: Mapping[str, Any], term: str) -> float:
    """Return a number of an element. Raises NotInROSS."""
    value = element.get(term)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise NotInROSS(f"'{name}' has no number {term}")
    return float(value)


def number_of(name: str, element: Mapping[str, Any], term: str) -> int:
    """Return a node of an element. Raises NotInROSS."""
    value = element.get(term)
    if isinstance(value, bool) or not isinstance(value, int):
        raise NotInROSS(f"'{name}' has no node {term}")
    return value


def require_zero(name: str, element: Mapping[str, Any], term: str, why: str) -> None:
    """Require that a number, or each of a list, is zero or left out. Raises NotInROSS."""
    value = element.get(term) or 0.0
    if any(value if isinstance(value, list) else [value]):
        raise NotInROSS(f"'{name}' has {term} = {value}, which cannot be described here: {why}")
