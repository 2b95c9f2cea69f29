"""Rows of a table at standstill: they hold no vibration at the running speed, and are left out of a run."""

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Floats


def at_standstill(speed: Floats, taken: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return which rows that were taken are at standstill (S,). speed: (S,), in any unit."""
    return np.asarray(taken & (speed == 0.0))


def standstill_words(still: NDArray[np.bool_]) -> list[str]:
    """Return that rows (S,) at standstill are left out, in one line for all of them; nothing where there are none."""
    rows = np.flatnonzero(still) + 1
    if not rows.size:
        return []
    together = rows[-1] - rows[0] == rows.size - 1
    which = f"row {rows[0]}" if rows.size == 1 else f"rows {rows[0]} to {rows[-1]}"
    of_these = "" if together else f", {rows.size} of these,"
    return [f"{which}{of_these} left out: at standstill (0 r/min) there is no vibration at the running speed"]
