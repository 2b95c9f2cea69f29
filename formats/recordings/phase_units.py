"""Tells degrees that are said to be radians, and radians that are said to be degrees, from a run's phases."""

import numpy as np

from estimator.arrays import Floats
from estimator.units import PhaseUnit

LARGEST_ANGLE_RAD = 4.0 * np.pi
"""Size of phases up to which they may be in radians [rad]: two turns."""
MOST_PHASES = 0.9
"""Part of the phases that is looked at: a few wrong values say nothing of the unit."""
FULL_TURN_RAD = 2.0 * np.pi
WIDEST_SMALL_PHASES = 3.0
"""Spread of phases within one turn in radians from which on they are not in degrees, in several channels."""
FEWEST_PHASES = 40
"""Number of phases from which on their spread says something about their unit."""


def contradicted_phase_unit(phase: Floats, unit: str) -> tuple[str, PhaseUnit] | None:
    """Return why phases contradict their unit, and the unit that they are in; None where they do not. phase: with NaN."""
    known = phase[np.isfinite(phase)]
    if known.size == 0:
        return None
    reach = float(np.quantile(np.abs(known), MOST_PHASES))
    if unit == "rad" and reach > LARGEST_ANGLE_RAD:
        return f"phases reach {reach:.0f} and more, which are degrees and not radians", "deg"
    if unit == "deg" and look_like_radians(known):
        return f"all phases lie within {np.max(np.abs(known)):.2f}, which looks like radians", "rad"
    return None


def is_possible_of_one_channel(phase: Floats, right: str) -> bool:
    """Check whether phases (S, m) may be in degrees though they look like radians: those of one channel may all be small."""
    return right == "rad" and phase.shape[1] == 1


def look_like_radians(phase: Floats) -> bool:
    """Check whether phases spread over about a turn in radians."""
    narrow = phase.size >= FEWEST_PHASES and np.max(np.abs(phase)) <= FULL_TURN_RAD
    return bool(narrow and np.ptp(phase) > WIDEST_SMALL_PHASES)
