"""Speeds that a result is asked for at: one, or several, in r/min."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from estimator.arrays import Floats
from estimator.errors import Invalid

SpeedsRpm = float | Iterable[float] | Floats
"""A speed, or several [r/min]."""
MOST_SHOWN = 40
"""Most characters of a wrong speed that an error shows."""


class WrongSpeed(Invalid):
    """Raised for what is no speed, or none at which a result can be computed; the message says what is right."""


def speeds_in_rpm(given: SpeedsRpm, what: str, *, standstill: bool = False) -> Floats:
    """Return speeds (S,) as numbers.

    Args:
        given: A speed, or several [r/min].
        what: What is computed at them, for the error.
        standstill: Whether a speed may be zero.

    Returns:
        The speeds (S,), at least one [r/min].

    Raises:
        WrongSpeed: A speed is no finite number, is negative, or is zero where it may not be; or none is given.
    """
    needed = f"{what} need speeds {'from 0 up' if standstill else 'above 0'} in r/min, such as 2980.0 or [1500.0, 2980.0]"
    several = list(given) if _are_several(given) else [given]  # type: ignore[arg-type]
    if not several:
        raise WrongSpeed(f"{needed}; none is given")
    numbers = [_number(one) for one in several]
    for one, number in zip(several, numbers, strict=True):
        if not (number >= 0.0 if standstill else number > 0.0) or number == np.inf:
            raise WrongSpeed(f"{needed}, not {' '.join(_shown(one).split()):.{MOST_SHOWN}}")
    return np.array(numbers)


def _are_several(given: Any) -> bool:
    """Return whether what is given holds numbers, as lists, arrays and series do."""
    return isinstance(given, Iterable) and not isinstance(given, str | bytes | Mapping) and getattr(given, "ndim", 1) > 0


def _number(one: Any) -> float:
    """Return a number as it is meant; NaN for text, truth values and whatever else is none."""
    if isinstance(one, bool | np.bool_ | str | bytes) or getattr(one, "ndim", 0) > 0 or np.iscomplexobj(one):
        return np.nan
    try:
        return float(one)
    except (TypeError, ValueError):
        return np.nan


def _shown(one: Any) -> str:
    return str(one) if isinstance(one, int | float | np.number) else repr(one)
