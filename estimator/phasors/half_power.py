"""Half-power points of a resonance, from an amplitude over speed or frequency.

They are where the amplitude has fallen to 1/√2 of its peak. The thesis measures outside of them, where the amplitude is
neither transient nor large enough for non-linearity (§2.3). Between samples 1/X² is taken as a parabola over ω² (constant
force) or 1/ω² (unbalance), which is exact for a single degree of freedom with viscous damping.
"""

import math
from collections.abc import Sequence
from typing import Literal

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from estimator.arrays import Floats

ExcitationKind = Literal["unbalance", "constant force"]


class HalfPowerNotReached(ValueError):
    """Raised when the curve does not fall to the half-power level on one side of the peak."""


class HalfPowerPoints(Struct, frozen=True):
    """A resonance between its half-power points.

    Attributes:
        peak: Speed or frequency of the peak [unit of the curve].
        amplitude: Amplitude at the peak [unit of the curve].
        lower: Lower half-power point [unit of the curve].
        upper: Upper half-power point [unit of the curve].
        damping_ratio: Damping ratio, exact for a single degree of freedom; (upper - lower) / (2 peak) where damping is small
            [-].
    """

    peak: float
    amplitude: float
    lower: float
    upper: float
    damping_ratio: float


def half_power_points(
    speed: Floats, amplitude: Floats, *, excitation: ExcitationKind, near: float | None = None
) -> HalfPowerPoints:
    """Find the half-power points of the largest peak, or of the peak nearest to a speed (thesis §2.3).

    Two resonances between which the curve stays above the half-power level count as one.

    Args:
        speed: Speeds or frequencies (S,), ascending and positive [rad/s, Hz or r/min].
        amplitude: Amplitudes (S,), positive [any unit].
        excitation: Kind of the excitation, which decides how the curve is interpolated.
        near: Speed whose nearest peak is taken [unit of speed]; None for the largest peak.

    Returns:
        The half-power points in the units of the arguments, and the damping ratio [-].

    Raises:
        ValueError: The curve has no peak inside it, or values that are not positive and finite.
        HalfPowerNotReached: The curve ends, or rises above the peak, before it has fallen to the half-power level.
    """
    speed, amplitude = np.asarray(speed, dtype=float), np.asarray(amplitude, dtype=float)
    _require_curve(speed, amplitude)
    peaks = peak_samples(amplitude)
    if peaks.size == 0:
        raise ValueError(f"the amplitude has no peak between {speed[0]:.6g} and {speed[-1]:.6g}: widen the range")
    index = int(peaks[np.argmax(amplitude[peaks])] if near is None else peaks[np.argmin(np.abs(speed[peaks] - near))])
    # In this coordinate the inverse square of the amplitude of a single degree of freedom is a parabola.
    place = speed**2 if excitation == "constant force" else speed**-2
    inverse = amplitude**-2
    top, smallest = _vertex(place[index - 1 : index + 2], inverse[index - 1 : index + 2])
    level = 2.0 * smallest
    first, last = (_crossing(speed, place, inverse, index, level, step) for step in (-1, 1))
    power = 0.5 if excitation == "constant force" else -0.5
    return HalfPowerPoints(
        peak=top**power,
        amplitude=smallest**-0.5,
        lower=first**power,
        upper=last**power,
        # Half-power points lie at place = top (1 ± tan 2α) with ζ = sin α, whatever ζ below 1/√2 is.
        damping_ratio=math.sin(0.5 * math.atan(abs(last - first) / (2.0 * top))),
    )


def peak_samples(amplitude: Floats) -> NDArray[np.intp]:
    """Find the local maxima inside a curve; of equal samples side by side, the first.

    Args:
        amplitude: Amplitudes (S,) [any unit].

    Returns:
        Indices (k,) of the maxima.
    """
    inner = amplitude[1:-1]
    return np.flatnonzero((inner > amplitude[:-2]) & (inner >= amplitude[2:])) + 1


def outside(speed: Floats, resonances: Sequence[HalfPowerPoints]) -> NDArray[np.bool_]:
    """Mark the speeds that lie outside the half-power points of all resonances.

    Args:
        speed: Speeds (S,) [unit of the resonances].
        resonances: The resonances.

    Returns:
        True for speeds outside (S,).
    """
    inside = np.zeros(np.shape(speed), dtype=bool)
    for one in resonances:
        inside |= (one.lower <= speed) & (speed <= one.upper)
    return ~inside


def _require_curve(speed: Floats, amplitude: Floats) -> None:
    if speed.ndim != 1 or speed.shape != amplitude.shape or speed.size < 3:
        raise ValueError(f"speed {speed.shape} and amplitude {amplitude.shape} must be equally long, three samples at least")
    if not np.all(np.isfinite(speed) & (speed > 0.0)) or np.any(np.diff(speed) <= 0.0):
        raise ValueError("speed must be positive, finite and ascending")
    if not np.all(np.isfinite(amplitude) & (amplitude > 0.0)):
        raise ValueError("amplitude must be positive and finite")


def _vertex(place: Floats, inverse: Floats) -> tuple[float, float]:
    """Find the minimum of the parabola through three samples: its place and its value."""
    centre = place[1]
    a, b, c = np.polyfit((place - centre) / centre, inverse / inverse[1], 2)
    at = -b / (2.0 * a)
    value = c + b * at / 2.0
    if value <= 0.0:
        raise HalfPowerNotReached("the peak is narrower than three samples: sample more densely")
    return float(centre * (1.0 + at)), float(inverse[1] * value)


def _crossing(speed: Floats, place: Floats, inverse: Floats, peak: int, level: float, step: int) -> float:
    """Find the place, going from the peak in one direction, where 1/X² first reaches the level."""
    side = "below" if step < 0 else "above"
    if inverse[peak] >= level:
        raise HalfPowerNotReached(f"the peak near {speed[peak]:.6g} is narrower than three samples: sample more densely")
    index = peak
    while inverse[index] < level:
        index += step
        if not 0 <= index < speed.size:
            raise HalfPowerNotReached(
                f"{side} the peak at {speed[peak]:.6g} the curve ends at {speed[index - step]:.6g} "
                "before it has fallen to 1/√2 of the peak: widen the range"
            )
        if inverse[index] < inverse[peak]:
            raise HalfPowerNotReached(
                f"{side} the peak at {speed[peak]:.6g} the curve rises to a larger one before it has fallen to 1/√2 of it"
            )
    near, far = index - step, index
    three = [near - step, near, far]
    return _root(place[three], inverse[three] / level - 1.0)


def _root(place: Floats, height: Floats) -> float:
    """Find the zero of the parabola through three samples between the last two, whose heights have opposite signs."""
    width = place[2] - place[1]
    a, b, c = np.polyfit((place - place[1]) / width, height, 2)
    slope = math.sqrt(b * b - 4.0 * a * c)
    # c < 0 <= a + b + c: the root on the rising branch is the only one between 0 and 1.
    at = 2.0 * -c / (b + slope) if b + slope > 0.0 else -c / height[2]
    return float(place[1] + min(max(at, 0.0), 1.0) * width)
