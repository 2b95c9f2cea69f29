"""Counting marks, with several per turn: the count determines the mark from which the phase is measured."""

import math
from dataclasses import replace

import numpy as np

from estimator.signal.keyphasor import ShaftAngle

Mark = tuple[float, int]
"""Time [s] and number within the turn of a mark."""

SAME_MARK = 0.2
"""Largest deviation in time of a recognised mark [part of the interval between marks]."""
ROUNDING = 1e-9
"""Rounding tolerance of times [s]."""


def counted_from(angle: ShaftAngle, mark: Mark, *, per_turn: int) -> ShaftAngle | None:
    """Return the angle counted from the same mark as before; None when that mark is not found again."""
    time, number = mark
    nearest = int(np.argmin(np.abs(angle.edge_time - time)))
    spacing = 2.0 * math.pi / per_turn
    interval = spacing / float(angle.speed(angle.edge_time[nearest]))
    if abs(float(angle.edge_time[nearest]) - time) > SAME_MARK * interval:
        return None
    ahead = number - round(float(angle.edge_angle[nearest]) / spacing)
    return replace(angle, edge_angle=angle.edge_angle + spacing * ahead)


def last_mark(angle: ShaftAngle, before: float, *, per_turn: int) -> Mark | None:
    """Return the last mark up to a time [s]; None when there is none, or only one per turn."""
    known = np.flatnonzero(angle.edge_time <= before + ROUNDING)
    if per_turn == 1 or not known.size:
        return None
    number = round(float(angle.edge_angle[known[-1]]) * per_turn / (2.0 * math.pi))
    return float(angle.edge_time[known[-1]]), number % per_turn
