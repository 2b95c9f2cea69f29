"""Words for a single estimate: its value and standard error in the units of the trade, or the reason why there is none."""

import cmath
import math

from estimator.fit.estimates import Estimate

GRAM_MILLIMETRES = 1e6
"""g mm per kg m."""
MICROMETRES = 1e6
"""µm per m."""


def estimate_words(estimate: Estimate) -> str:
    """Return the value of an estimate ± its standard error, or the reason why there is none."""
    if estimate.value is None or estimate.standard_error is None:
        return f"not estimable: {estimate.reason}" if estimate.sought else str(estimate.reason)
    if estimate.imaginary is not None and estimate.imaginary_standard_error is not None:
        if estimate.quantity == "unbalance":
            return _unbalance(complex(estimate.value, estimate.imaginary), estimate)
        return (
            f"{estimate.value:+.4e} ± {estimate.standard_error:.1e}  "
            f"{estimate.imaginary:+.4e}j ± {estimate.imaginary_standard_error:.1e} {estimate.unit}"
        )
    if estimate.quantity == "elevation":  # may be zero, so that a part of it says nothing
        return f"{MICROMETRES * estimate.value:+.3g} ± {MICROMETRES * estimate.standard_error:.2g} µm"
    percent = _per_cent(estimate.standard_error, estimate.value)
    if estimate.quantity == "clearance":
        value, error = MICROMETRES * estimate.value, MICROMETRES * estimate.standard_error
        return f"{value:.4g} ± {error:.2g} µm ({percent})"
    unit = "" if estimate.unit == "1" else f" {estimate.unit}"
    return f"{estimate.value:+.4e} ± {estimate.standard_error:.1e}{unit} ({percent})"


def _per_cent(error: float, value: float) -> str:
    """Return an error in per cent of its value, without a power of ten."""
    if error >= 10.0 * abs(value):
        return "over 1000 %"
    percent = 100.0 * error / abs(value)
    return f"{percent:.0f} %" if percent >= 99.5 else f"{percent:.2g} %"


def _unbalance(value: complex, estimate: Estimate) -> str:
    """Return an unbalance in g mm at degrees from the keyphasor mark, +x to +y, with the larger error of its two parts."""
    error = max(estimate.standard_error or 0.0, estimate.imaginary_standard_error or 0.0)
    open_angle = math.degrees(math.asin(min(error / abs(value), 1.0))) if value else 180.0
    size, half = GRAM_MILLIMETRES * abs(value), GRAM_MILLIMETRES * error
    angle = math.degrees(cmath.phase(value)) % 360.0
    return f"{size:.4g} ± {half:.2g} g mm at {angle:.1f} ± {angle_half_words(open_angle)}°"


def angle_half_words(half: float) -> str:
    """Return the half width of an angle's interval [°], rounded up to the tenths that angles are given in: never zero."""
    return f"{max(math.ceil(10.0 * half) / 10.0, 0.1):.1f}"
