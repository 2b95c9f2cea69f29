"""Times of a table's rows: dates and times of ISO 8601 as moments, and times that no run has."""

from collections.abc import Sequence
from datetime import UTC, datetime

import numpy as np

from estimator.arrays import Floats

EXAMPLE = "2025-01-01 00:00:00"
"""A moment as ISO 8601 has it."""
LONGEST_LIKELY_S = 6.0 * 3600.0
"""Duration of a run-up or run-down from which on its unit is asked for [s]."""
SHORTEST_LIKELY_S = 1.0
"""Duration of a run up to which its unit is asked for [s]."""
LONGEST_STEP = 300.0
"""Time between two rows, as a multiple of the usual one, from which on it is doubted [-]."""
SET_BACK = "give the offset from UTC with each date where the clock was set back, "
"""Words on dates of a night in which summer time ends."""
ONE_WAY = 0.5
"""Least part of all changes of the speed that remains in a run-up or run-down, and not in a machine's speeds over days [-]."""


def moment_of(value: object) -> datetime | None:
    """Return the moment that a date and time, or its text in ISO 8601, stands for; None for anything else."""
    if isinstance(value, np.datetime64):
        value = value.astype("datetime64[us]").item()
    if isinstance(value, datetime):
        return value if value == value else None  # pandas' missing one is a datetime, too
    try:
        return datetime.fromisoformat(value.strip()) if isinstance(value, str) else None
    except ValueError:
        return None


def seconds_since_first(moments: Sequence[datetime | None]) -> list[float | None]:
    """Return the seconds from the first moment to each. Raises ValueError where only some have a time zone."""
    known = [one for one in moments if one is not None]
    zoned = [one.utcoffset() is not None for one in known]
    if any(zoned) and not all(zoned):
        with_zone, without = known[zoned.index(True)], known[zoned.index(False)]
        raise ValueError(f"'{with_zone}' has a time zone and '{without}' has none: write it in all rows or none")
    same = [None if one is None else (one.astimezone(UTC) if zoned[0] else one.replace(tzinfo=UTC)) for one in moments]
    first = next((one for one in same if one is not None), None)
    return [None if one is None or first is None else (one - first).total_seconds() for one in same]


def wrong_times(seconds: Floats, *, dated: bool = False) -> str:
    """Return why times (S,) [s] cannot be those of a run, and what would be right; empty where they can. dated: are dates."""
    if seconds.size < 2:
        return ""
    steps = np.diff(seconds)
    if not np.any(steps):
        return f"all times are the same, {seconds[0]:g} s: give those of the samples, or leave the column out"
    if seconds[-1] <= seconds[0] or np.mean(steps < 0.0) > np.mean(steps > 0.0):
        row = int(np.argmax(steps < 0.0))
        return (
            f"the times go backwards, as from {seconds[row]:g} s in row {row + 1} to {seconds[row + 1]:g} s in row {row + 2}: "
            f"put the rows in order of time, {SET_BACK if dated else ''}or leave the column out"
        )
    return ""


def doubted_times(seconds: Floats, speed: Floats, *, dated: bool = False) -> list[str]:
    """Return what is doubted of times (S,) [s] that can be those of a run, in words.

    speed: (S,), in any unit. dated: whether the times were given as dates, whose unit cannot be wrong.
    """
    doubts = []
    steps = np.diff(seconds)
    back = np.flatnonzero(steps < 0.0)
    if back.size:
        row = int(back[0])
        told = f"the times go back {back.size} time{'' if back.size == 1 else 's'}, first from row {row + 1} to row {row + 2}"
        right = f" Put them so, {SET_BACK.removesuffix(', ')}" if dated else ""
        doubts.append(f"{told}, from {seconds[row]:g} s to {seconds[row + 1]:g} s: are the rows in order of time?{right}")
    usual = float(np.median(steps[steps > 0.0])) if np.any(steps > 0.0) else 0.0
    if steps.size > 1 and steps.max() > LONGEST_STEP * usual:
        row = int(np.argmax(steps))
        told = f"row {row + 2} comes {steps[row]:.3g} s behind row {row + 1}, others {usual:.3g} s behind each other"
        doubts.append(f"{told}: are these one run, with times in seconds?")
    if dated:
        return doubts
    span = float(np.ptp(seconds)) if seconds.size else 0.0
    if 0.0 < span <= SHORTEST_LIKELY_S:
        doubts.append(f"the run lasts {span:.2g} s: are its times in days, hours or minutes? Write seconds")
    if span > LONGEST_LIKELY_S and abs(speed[-1] - speed[0]) > ONE_WAY * np.sum(np.abs(np.diff(speed))):
        doubts.append(f"the run lasts {span / 3600.0:.3g} h: are its times in milliseconds? Write seconds")
    return doubts
