"""Part of the slow variation of a healthy train on oil films that lies between two times less than a season apart."""

import math

from estimator.machine.alignment_rules import HealthyVariation

WEEKS_A_YEAR = 365.25 / 7.0
SEASON = WEEKS_A_YEAR / 4.0
"""Time after which two moments are as different as any two of a year [weeks]."""
SLOW = ("slow_oil", "slow_viscosity", "slow_clearance", "slow_elevation")
"""Numbers of `HealthyVariation` that are stated for any two times of a year."""


def season_part(weeks: float) -> float:
    """Return the part of a season's variation that lies between two times (own derivation: a sine over the year).

    The difference of a sine between two times is 2 sin(π t/T) times a sine of the same length, and as large as that between
    any two times of the year after a quarter of it.

    Args:
        weeks: Time from one to the other [weeks].

    Returns:
        Ratio of the standard deviations [-].
    """
    return math.sqrt(2.0) * math.sin(math.pi * min(abs(weeks), SEASON) / WEEKS_A_YEAR)


def variation_within(variation: HealthyVariation, *, weeks: float) -> HealthyVariation:
    """Return how a healthy train varies between times that are so far apart; from run to run it varies as ever.

    Source: `season_part`.

    Args:
        variation: How it varies over a year.
        weeks: Time between the two [weeks].

    Returns:
        The variation.
    """
    part = season_part(weeks)
    return variation.model_copy(update={name: part * getattr(variation, name) for name in SLOW})
