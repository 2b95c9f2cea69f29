"""Units of the speed that may have been taken for each other, told by whether the speeds lie in the document's speed range."""

import itertools

import numpy as np
from msgspec import Struct

from estimator.arrays import Floats
from estimator.machine.rules import SpeedRange
from estimator.units import RAD_PER_S, SpeedUnit, rad_per_s_to_rpm, rpm_to_rad_per_s

NAMES: dict[SpeedUnit, str] = {"rpm": "r/min", "rad/s": "rad/s", "Hz": "Hz"}
OVERSPEED = 1.05
"""Highest speed of a run, as a multiple of the speed range's end [-], that speaks for a unit of the speed."""
LEAST_IN_RANGE = 0.5
"""Least part of the samples within the speed range for a unit of the speed to be possible [-]."""
LEAST_COVERED = 0.5
"""Part of the speed range, and of its end, that a machine may be expected to reach in time [-]."""


class TakenUnit(Struct, frozen=True):
    """A unit of the speed that was taken for another.

    Attributes:
        words: Which for which.
        factor: Factor that makes the speeds right [-].
    """

    words: str
    factor: float


def speed_units(speed_range: SpeedRange, speed: Floats) -> list[TakenUnit]:
    """List the units of the speed that bring a run into the speed range.

    Args:
        speed_range: Speed range of the machine.
        speed: Speeds of its run (S,) [rad/s].

    Returns:
        The units.
    """
    lowest, highest = rpm_to_rad_per_s(speed_range.minimum_rpm), OVERSPEED * rpm_to_rad_per_s(speed_range.maximum_rpm)
    found = []
    for sent, declared in itertools.permutations(RAD_PER_S, 2):
        factor = RAD_PER_S[sent] / RAD_PER_S[declared]
        right = factor * speed
        if speed.size and right.max() <= highest and np.mean(right >= lowest) >= LEAST_IN_RANGE:
            found.append(TakenUnit(f"speeds in {NAMES[sent]} that were sent as {NAMES[declared]}", factor))
    return found


def outside_speed_range(speed_range: SpeedRange, speed: Floats) -> str:
    """Describe a run that never enters the speed range of its document, with the units of the speed that would explain it.

    Args:
        speed_range: Speed range of the machine.
        speed: Speeds of the run (S,) [rad/s].

    Returns:
        What is wrong, in words; empty where a sample lies in the range, or nothing turns.
    """
    turning = speed[speed > 0.0]
    if not turning.size:
        return ""
    slowest, fastest = rad_per_s_to_rpm(float(turning.min())), rad_per_s_to_rpm(float(turning.max()))
    if fastest >= speed_range.minimum_rpm and slowest <= speed_range.maximum_rpm:
        return ""
    limits = f"{speed_range.minimum_rpm:g} to {speed_range.maximum_rpm:g} r/min"
    units = speed_units(speed_range, turning)
    meaning = f" {' or '.join(one.words for one in units)}?" if units else " is the unit of the speeds right?"
    return f"it turns at {slowest:.4g} to {fastest:.4g} r/min and never enters the document's speed range, {limits}:{meaning}"


def short_of_speed_range(speed_range: SpeedRange, speed: Floats) -> str:
    """Describe a machine that covers a small part of its document's speed range, with the units that would explain it.

    Args:
        speed_range: Speed range of the machine.
        speed: Speeds that it had (S,) [rad/s].

    Returns:
        What it covered, in words; empty where that is a good part of the range, or nothing turns.
    """
    turning = rad_per_s_to_rpm(1.0) * speed[speed > 0.0]
    if not turning.size:
        return ""
    slowest, fastest = float(turning.min()), float(turning.max())
    low, high = speed_range.minimum_rpm, speed_range.maximum_rpm
    part = max(0.0, min(fastest, high) - max(slowest, low)) / (high - low)
    if part >= LEAST_COVERED:
        return ""
    # Units that make speeds larger are thought of only where these are too small.
    units = [one.words for one in speed_units(speed_range, speed[speed > 0.0]) if one.factor > 1.0]
    meaning = f": {' or '.join(units)}?" if units and fastest < LEAST_COVERED * high else "; a run sweeps through it"
    return f"it turned at {slowest:.4g} to {fastest:.4g} r/min, {100 * part:.0f} % of {low:g} to {high:g} r/min{meaning}"
