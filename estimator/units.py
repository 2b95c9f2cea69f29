"""Units: SI and rad/s inside, other units outside; every conversion factor stands here."""

import math
from typing import Literal

SpeedUnit = Literal["rpm", "rad/s", "Hz"]
AmplitudeUnit = Literal["m", "mm", "um", "mil"]
AmplitudeKind = Literal["peak", "peak-to-peak"]
PhaseConvention = Literal["lead", "lag"]
PhaseUnit = Literal["deg", "rad"]
WeightUnit = Literal["kg m", "kg mm", "g mm", "g in", "oz in", "kg", "g", "oz"]
"""An unbalance, or a mass that needs its radius."""
RadiusUnit = Literal["m", "mm", "in"]

RAD_PER_S: dict[SpeedUnit, float] = {"rpm": math.pi / 30.0, "rad/s": 1.0, "Hz": 2.0 * math.pi}
"""Factor from a declared speed unit to rad/s."""

METRES: dict[AmplitudeUnit, float] = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "mil": 2.54e-5}
"""Factor from a declared length unit to metres. Volts need the probe's sensitivity and are not in this table."""

PEAK: dict[AmplitudeKind, float] = {"peak": 1.0, "peak-to-peak": 0.5}
"""Factor from a declared amplitude to 0-to-peak."""

LEAD: dict[PhaseConvention, float] = {"lead": 1.0, "lag": -1.0}
"""Sign that makes a declared phase a lead, the phase of X in x(t) = Re(X e^{jωt})."""

RADIANS: dict[PhaseUnit, float] = {"deg": math.pi / 180.0, "rad": 1.0}
"""Factor from a declared phase unit to radians."""

KILOGRAMS: dict[str, float] = {"kg": 1.0, "g": 1e-3, "oz": 0.028349523125}
"""Factor from a declared mass unit to kilograms."""

RADII: dict[str, float] = {"m": 1.0, "mm": 1e-3, "in": 0.0254}
"""Factor from a declared unit of a radius to metres."""

KILOGRAM_METRES: dict[str, float] = {
    "kg m": 1.0,
    "kg mm": 1e-3,
    "g mm": 1e-6,
    "g in": KILOGRAMS["g"] * RADII["in"],
    "oz in": KILOGRAMS["oz"] * RADII["in"],
}
"""Factor from a declared unit of an unbalance to kg m."""


GRAVITY = 9.81
"""Acceleration of free fall [m/s²]."""


def rpm_to_rad_per_s(rpm: float) -> float:
    """Convert a speed from r/min to rad/s.

    Args:
        rpm: Speed [r/min].

    Returns:
        Speed [rad/s].
    """
    return rpm * RAD_PER_S["rpm"]


def rad_per_s_to_rpm(rad_per_s: float) -> float:
    """Convert a speed from rad/s to r/min.

    Args:
        rad_per_s: Speed [rad/s].

    Returns:
        Speed [r/min].
    """
    return rad_per_s / RAD_PER_S["rpm"]
