"""Growths of elements: by what factor an element's stiffnesses and dampings have changed together.

Where a cause changes all coefficients of an element in one proportion, that is one figure and no more: its twelve coefficients
have not been seen to change one by one, and some of them the data may not determine at all.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from estimator.arrays import Floats
from estimator.diagnosis.change_columns import TERM_ORDER
from estimator.diagnosis.finding_kind import Cause, SizePart
from estimator.fit.estimates import CONFIDENCE_95
from estimator.machine.parameter_description import describe
from estimator.trends.deviations import element_of

TOGETHER = 1e-3
"""Largest difference of two growths, and standard error of it, of logarithms, at which they are one [-]."""


@dataclass(frozen=True)
class Growth:
    """Mean growth of an element's direct stiffnesses, of its direct dampings, or of all its coefficients together.

    Attributes:
        element: Name of the element.
        term: Kind of the terms.
        change: Change of the logarithm [-].
        error: Its standard error [-].
        members: Names of the direct terms.
    """

    element: str
    term: Literal["stiffness", "damping", "coefficients"]
    change: float
    error: float
    members: tuple[str, ...]

    @property
    def name(self) -> str:
        """Return the name of what has grown, such as `coupling.C1.stiffness`."""
        return f"{self.element}.{self.term}"

    @property
    def per_cent(self) -> float:
        """Return the growth [%]."""
        return 100.0 * math.expm1(self.change)

    @property
    def sigma(self) -> float:
        """Return the growth in its standard errors [-], never negative."""
        return abs(self.change) / max(self.error, 1e-12)


def growths(cause: Cause) -> list[Growth]:
    """Return the growths of each element that a cause changes.

    Args:
        cause: The cause.

    Returns:
        One growth of an element whose coefficients change in proportion, else one of its stiffness and one of its damping;
        none of what has no direct terms.
    """
    found: list[Growth] = []
    for element in dict.fromkeys(element_of(name) for name in cause.names):
        found += _of_element(cause, element)
    return found


def growth_quantities(found: Sequence[Growth]) -> dict[str, float]:
    """Return growths by name with the unit at its end.

    Args:
        found: The growths.

    Returns:
        Growths [%], that of all coefficients under the name of the stiffness.
    """
    return {f"{one.element}.{'damping' if one.term == 'damping' else 'stiffness'}_per_cent": one.per_cent for one in found}


def growth_parts(found: Sequence[Growth], *, first: str) -> tuple[SizePart, ...]:
    """Return growths as figures with their 95 % intervals.

    Args:
        found: The growths.
        first: Name of the growth, or of the element, that is named first.

    Returns:
        The figures.
    """
    order = sorted(found, key=lambda one: first not in (one.name, one.element))
    return tuple(
        SizePart(
            name=one.name,
            unit="%",
            value=one.per_cent,
            lower=100.0 * math.expm1(one.change - CONFIDENCE_95 * one.error),
            upper=100.0 * math.expm1(one.change + CONFIDENCE_95 * one.error),
            sigma=math.copysign(one.sigma, one.change),
            members=one.members,
        )
        for one in order
    )


def _of_element(cause: Cause, element: str) -> list[Growth]:
    terms = [own.term if (own := describe(name)).element == element else None for name in cause.names]
    weights: dict[Literal["stiffness", "damping"], Floats] = {}
    for kind, order in TERM_ORDER.items():
        chosen = np.array([term is not None and term.direct and term.order == order for term in terms], dtype=float)
        if chosen.any():
            weights[kind] = chosen / chosen.sum()
    both = tuple(weights.values())
    if len(both) > 1 and _are_one(cause, both[0] - both[1]):
        whole = (both[0] + both[1]) / 2.0
        return [Growth(element, "coefficients", *_mean(cause, whole), _members(cause, whole))]
    return [Growth(element, kind, *_mean(cause, which), _members(cause, which)) for kind, which in weights.items()]


def _are_one(cause: Cause, difference: Floats) -> bool:
    return max(abs(part) for part in _mean(cause, difference)) < TOGETHER


def _mean(cause: Cause, which: Floats) -> tuple[float, float]:
    """Return a mean change of logarithms and its standard error [-]."""
    return float(which @ cause.change), math.sqrt(max(0.0, float(which @ cause.covariance @ which)))


def _members(cause: Cause, which: Floats) -> tuple[str, ...]:
    return tuple(name for name, weight in zip(cause.names, which, strict=True) if weight)
