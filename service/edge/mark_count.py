"""With several marks per turn: the count of the marks, which says from which of them the phase is counted."""

import math
from dataclasses import replace

import numpy as np

from estimator.signal.keyphasor import ShaftAngle

Mark = tuple[float, int]
"""Instant [s] and number in the turn of a mark."""

SAME_MARK = 0.2
"""How far from its time a mark is still the same [part of the interval between marks]."""
ROUNDING = 1e-9
"""Of instants [s]."""


def counted_from(angle: ShaftAngle, mark: Mark, *, per_turn: int) -> ShaftAngle | None:
    """Return the angle counted from the same mark as before; None where that mark is not found again."""
    time, number = mark
    nearest = int(np.argmin(np.abs(angle.edge_time - time)))
    spacing = 2.0 * math.pi / per_turn
    interval = spacing / float(angle.speed(angle.edge_time[nearest]))
    if abs(float(angle.edge_time[nearest]) - time) > SAME_MARK * interval:
        return None
    ahead = number - round(float(angle.edge_angle[nearest]) / spacing)
    return replace(angle, edge_angle=angle.edge_angle + spacing * ahead)


def last_mark(angle: ShaftAngle, before: float, *, per_turn: int) -> Mark | None:
    """Return the last mark up to an instant [s]; None where there is none, or only one per turn."""
    known = np.flatnonzero(angle.edge_time <= before + ROUNDING)
    if per_turn == 1 or not known.size:
        return None
    number = round(float(angle.edge_angle[known[-1]]) * per_turn / (2.0 * math.pi))
    return float(angle.edge_time[known[-1]]), number % per_turn
