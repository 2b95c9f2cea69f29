"""Conversions of single values between rows of the store and answers of the API."""

from datetime import datetime

import numpy as np
from numpy.typing import NDArray

from estimator.units import METRES, PEAK, rad_per_s_to_rpm
from storage.clock import to_datetime

MICROMETRES = METRES["um"] * PEAK["peak-to-peak"]
"""Size of one micrometre peak-to-peak as a 0-to-peak amplitude [m]."""


def direction(sign: int) -> str:
    """Name a sense of rotation: `positive` turns +x towards +y."""
    return "positive" if sign > 0 else "negative"


def time_or_none(nanoseconds: int | None) -> datetime | None:
    """Return a stored time, or None where there is none."""
    return None if nanoseconds is None else to_datetime(nanoseconds)


def rpm_or_none(speed: float | None) -> float | None:
    """Return a spin speed [rad/s] in r/min, or None where there is none."""
    return None if speed is None else rad_per_s_to_rpm(speed)


def rfc3339_texts(nanoseconds: NDArray[np.int64]) -> NDArray[np.object_]:
    """Write times [ns since 1970] as RFC 3339 in UTC, to the microsecond."""
    moments = (nanoseconds // 1000).astype("datetime64[us]")
    return np.datetime_as_string(moments, timezone="UTC").astype(np.object_)


def rfc3339_text(nanoseconds: int) -> str:
    """Write a time [ns since 1970] as RFC 3339 in UTC, to the microsecond."""
    return str(rfc3339_texts(np.array([nanoseconds]))[0])
