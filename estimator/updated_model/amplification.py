"""Amplification factors and separation margins of the response peaks (API RP 684, SP6.8.2; API 617, 8th edition).

AF = Nc / (N2 - N1), Nc the speed of a peak and N1, N2 the speeds below and above it at 0.707 of its amplitude. AF below 2.5:
critically damped, no margin required. Required margin, in per cent: 17 (1 - 1/(AF - 1.5)), at most 16, of the minimum speed
for a peak below it; 10 + 17 (1 - 1/(AF - 1.5)), at most 26, of the maximum continuous speed for a peak above it. The
standards themselves were not at hand; ROSS's API report and two other public programs carry these formulas and caps.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy

from estimator.arrays import Complexes, Floats
from estimator.machine.parts import Probe
from estimator.modes.critical_speed import critical_speed_table
from estimator.rotor.assembly import assemble_rotor
from estimator.updated_model.forced_response import ForcedResponse, forced_response
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.monotone_segments import TurningCurve
from estimator.updated_model.station_response import displacement_row
from estimator.updated_model.uncertainty import standard_errors

CRITICALLY_DAMPED = 2.5
"""Amplification factor below which no margin is required."""
LARGEST_MARGIN_BELOW, LARGEST_MARGIN_ABOVE = 16.0, 26.0
HALF_POWER = 1 / math.sqrt(2.0)
EVEN_SPEEDS = 300
"""Number of evenly spaced speeds of the response curve, in addition to those around critical speeds."""
CROWD = np.linspace(-6.0, 6.0, 49)
"""Speeds of the response curve around each critical speed, in units of its half bandwidth ζΩ."""
FEWER_EVEN_SPEEDS, NARROW_CROWD = 100, np.linspace(-3.0, 3.0, 25)
"""Even speeds, and speeds around each critical speed, of the curve whose slopes are computed as well, after every
identification.
"""

SpeedPosition = Literal["below", "within", "above"]


@dataclass(frozen=True)
class Peak:
    """A response peak.

    Attributes:
        speed: Speed at the top [unit of the curve's speeds].
        amplitude: Amplitude at the top [unit of the curve].
        lower: Speed below the top at 0.707 of its amplitude [unit of the curve's speeds]; None where the curve does not fall
            so far before it ends or rises above this peak.
        upper: The same above the top [unit of the curve's speeds].
    """

    speed: float
    amplitude: float
    lower: float | None
    upper: float | None

    @property
    def amplification_factor(self) -> float | None:
        """Return AF = Nc / (N2 - N1) [-]; from twice one side where the other is missing, None where both are."""
        if self.lower is not None and self.upper is not None:
            return self.speed / (self.upper - self.lower)
        if self.lower is not None:
            return self.speed / (2 * (self.speed - self.lower))
        if self.upper is not None:
            return self.speed / (2 * (self.upper - self.speed))
        return None

    @property
    def one_sided(self) -> bool:
        """Return whether only one of the two half-power speeds was found."""
        return (self.lower is None) != (self.upper is None)


@dataclass(frozen=True)
class SeparationMargin:
    """Distance of a peak from the operating speeds.

    Attributes:
        peak: The peak.
        position: Position of the peak relative to the operating speeds.
        actual: Distance [%] from the nearer operating speed, as a part of that speed; 0 within the operating speeds.
        required: Distance asked for [%]; None where the standard asks for none, and within the operating speeds, where a peak
            may only be critically damped.
    """

    peak: Peak
    position: SpeedPosition
    actual: float
    required: float | None

    @property
    def met(self) -> bool | None:
        """Return whether the peak is where the standard wants it; None where its amplification factor is not known."""
        factor = self.peak.amplification_factor
        if factor is None:
            return None
        if factor < CRITICALLY_DAMPED:
            return True
        return self.required is not None and self.actual >= self.required


def required_margin(amplification_factor: float, *, position: SpeedPosition) -> float | None:
    """Return the separation margin that API RP 684 and API 617 require; formulas and caps in the module's docstring.

    Args:
        amplification_factor: AF of the peak [-].
        position: Position of the peak relative to the operating speeds.

    Returns:
        Required margin [%]; None where none is required: critically damped, or within the operating speeds.
    """
    if amplification_factor < CRITICALLY_DAMPED or position == "within":
        return None
    margin = 17.0 * (1.0 - 1.0 / (amplification_factor - 1.5))
    return min(margin, LARGEST_MARGIN_BELOW) if position == "below" else min(10.0 + margin, LARGEST_MARGIN_ABOVE)


def separation_margin(peak: Peak, *, minimum_speed: float, maximum_continuous_speed: float) -> SeparationMargin:
    """Compute the margin of one peak to the operating speeds.

    All speeds are in one unit, that of the peak.

    Args:
        peak: The peak.
        minimum_speed: Lowest operating speed [rad/s], or the unit of the peak.
        maximum_continuous_speed: Highest continuous operating speed [rad/s], or the unit of the peak.

    Returns:
        Actual and required margin [%].
    """
    if peak.speed < minimum_speed:
        position: SpeedPosition = "below"
        actual = 100.0 * (minimum_speed - peak.speed) / minimum_speed
    elif peak.speed > maximum_continuous_speed:
        position = "above"
        actual = 100.0 * (peak.speed - maximum_continuous_speed) / maximum_continuous_speed
    else:
        position, actual = "within", 0.0
    factor = peak.amplification_factor
    required = None if factor is None else required_margin(factor, position=position)
    return SeparationMargin(peak=peak, position=position, actual=actual, required=required)


@dataclass(frozen=True)
class UncertainPeak:
    """A response peak with the standard error of its amplification factor.

    Attributes:
        peak: The peak.
        factor_error: Standard error of AF [-], right within some per cent; None where AF is None.
    """

    peak: Peak
    factor_error: float | None


def response_peaks(speed: Floats, amplitude: Floats) -> tuple[Peak, ...]:
    """Find the peaks of a response curve, from a cubic spline through it.

    Args:
        speed: Speeds (S,) [rad/s], ascending, or any other unit; five or more must lie within the half-power width of the
            narrowest peak.
        amplitude: Amplitude (S,) at each speed [m], or any other unit.

    Returns:
        Peaks in order of speed, in the units of the arguments.
    """
    curve = TurningCurve.through(speed, amplitude)
    peaks = []
    for top in curve.tops.tolist():
        height = float(curve.spline(top))
        # What lies beyond a higher part of the curve belongs to another peak.
        lower, upper = (
            curve.first_below(HALF_POWER * height, start=top, highest=height * (1 + 1e-9), upwards=upwards)
            for upwards in (False, True)
        )
        peaks.append(Peak(speed=top, amplitude=height, lower=lower, upper=upper))
    return tuple(peaks)


def amplification(
    model: UpdatedModel,
    *,
    places: Sequence[Probe],
    lowest: float,
    highest: float,
    minimum_speed: float,
    maximum_continuous_speed: float,
    crossings: Complexes | None = None,
) -> tuple[tuple[SeparationMargin, ...], ...]:
    """Find the response peaks between two speeds at places of a train, and their margins to the operating speeds.

    The response is that to the identified unbalances. Source: API RP 684 and API 617 (module docstring).

    Args:
        model: The identified model.
        places: Places of the train: the machine's probes or any others, m of them.
        lowest: Lowest speed of the curve [rad/s].
        highest: Highest speed of the curve [rad/s].
        minimum_speed: Lowest operating speed [rad/s].
        maximum_continuous_speed: Highest continuous operating speed [rad/s].
        crossings: Eigenvalues (c,) at the model's critical speeds up to `highest` [rad/s]; None to compute them.

    Returns:
        For each of the m places its peaks in order of speed, with margins [%] and speeds [rad/s].

    Raises:
        ValueError: The speeds are not positive, lowest is not below highest, or minimum_speed is above
            maximum_continuous_speed.
    """
    if not (0 < lowest < highest and 0 < minimum_speed <= maximum_continuous_speed):
        raise ValueError("speeds must be positive, lowest below highest, minimum_speed not above maximum_continuous_speed")
    if crossings is None:
        table = critical_speed_table(model.scaled_machine, highest=highest, coefficients=model.coefficients)
        crossings = np.array([one.eigenvalue for one in table], dtype=complex)
    speed = _speeds(crossings, lowest, highest)
    amplitude = np.abs(_response(model, speed, places).phasor)
    return tuple(
        tuple(
            separation_margin(peak, minimum_speed=minimum_speed, maximum_continuous_speed=maximum_continuous_speed)
            for peak in response_peaks(speed, curve)
        )
        for curve in amplitude.T
    )


def peaks_with_errors(
    model: UpdatedModel, *, places: Sequence[Probe], crossings: Complexes, lowest: float, highest: float
) -> tuple[tuple[UncertainPeak, ...], ...]:
    """Find the response peaks between two speeds at places of a train, with the standard errors of their factors.

    Source: API RP 684, SP6.8.2, as public programs carry it (module's docstring).

    Args:
        model: The identified model.
        places: Places of the train, m of them.
        crossings: Eigenvalues (c,) at the model's critical speeds [rad/s].
        lowest: Lowest speed of the curve [rad/s].
        highest: Highest speed of the curve [rad/s].

    Returns:
        For each of the m places its peaks, with speeds [rad/s] and errors of AF [-].
    """
    speed = _speeds(crossings, lowest, highest, even=FEWER_EVEN_SPEEDS, crowd=NARROW_CROWD)
    found = _response(model, speed, places)
    return tuple(
        tuple(_with_errors(speed, found.phasor[:, place], found.slope[:, place], model.covariance))
        for place in range(len(places))
    )


def _with_errors(speed: Floats, phasor: Complexes, slope: Complexes, covariance: Floats) -> Iterator[UncertainPeak]:
    """Compute the peaks of one curve (S,) with slopes (S, n).

    With u = |X|⁻², which is as smooth over a resonance as |X| is steep: a half-power speed N, u(N) = 2 u(Nc), moves by dN = (2
    ∂u/∂p(Nc) - ∂u/∂p(N)) dp / u'(N); the peak's own speed by dNc = -∂u'/∂p dp / u''.
    """
    amplitude = np.maximum(np.abs(phasor), np.finfo(float).tiny ** 0.25)
    curve = scipy.interpolate.CubicSpline(speed, amplitude**-2)
    slopes = scipy.interpolate.CubicSpline(speed, -2 * (np.conj(phasor)[:, None] * slope).real / amplitude[:, None] ** 4)
    for peak in response_peaks(speed, np.abs(phasor)):
        factor = peak.amplification_factor
        if factor is None:
            yield UncertainPeak(peak, None)
            continue
        top = -slopes(peak.speed, 1) / float(curve(peak.speed, 2))
        level = 2.0 * slopes(peak.speed)
        sides = [top if at is None else (level - slopes(at)) / float(curve(at, 1)) for at in (peak.lower, peak.upper)]
        width, times = sides[1] - sides[0], 2.0 if peak.one_sided else 1.0
        # AF = Nc / width, the width doubled where one side is missing.
        change = (top - factor * times * width) * factor / peak.speed
        yield UncertainPeak(peak, float(standard_errors(change, covariance)))


def _response(model: UpdatedModel, speed: Floats, places: Sequence[Probe]) -> ForcedResponse:
    rotor = assemble_rotor(model.machine)
    rows = np.array([displacement_row(model.machine, rotor, place) for place in places])
    return forced_response(model, speed=speed, output=rows)


def _speeds(crossings: Complexes, lowest: float, highest: float, *, even: int = EVEN_SPEEDS, crowd: Floats = CROWD) -> Floats:
    """Choose speeds close enough to each other around every critical speed, from the eigenvalues of the crossings."""
    damping = np.maximum(np.abs(crossings.real / np.abs(crossings)), 1e-4)
    crowds = crossings.imag[:, None] * (1.0 + damping[:, None] * crowd)
    whole = np.unique(np.concatenate([np.linspace(lowest, highest, even), crowds.reshape(-1)]))
    whole = whole[(whole >= lowest) & (whole <= highest)]
    # Speeds that nearly coincide would make the spline's slope out of rounding errors.
    return np.asarray(whole[np.concatenate([[True], np.diff(whole) > 1e-9 * highest])])
