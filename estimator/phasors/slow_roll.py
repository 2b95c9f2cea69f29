"""Slow-roll vectors: the shaft's surface and shape as the probes see them where nothing yet makes the shaft move.

At slow roll a probe sees mechanical and electrical run-out and the bow of the shaft; both are there at every speed and are
subtracted as vectors (Bently & Hatch, Fundamentals of Rotating Machinery Diagnostics, 2002). Vibration by unbalance grows with
the speed squared, so a mean over a band in which the vectors grow is no slow roll.
"""

import math
from collections.abc import Sequence

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.errors import Invalid
from estimator.machine.calibration import Calibration
from estimator.machine.document import Machine
from estimator.machine.rules import Noise
from estimator.phasors.measurement import Measurement
from estimator.phasors.noise import error_size
from estimator.units import rad_per_s_to_rpm

FEWEST_SAMPLES = 5
"""Least number of good samples of a channel for a vector."""
LARGEST_SCATTER = 0.3
"""Scatter of the samples, as a part of their mean, above which they show no vector unless the noise explains it [-]."""
BEYOND_NOISE = 3.0
"""Multiple of the stated noise above which scatter is more than noise [-]."""
LARGEST_GROWTH = 0.25
"""Growth of a mean over the band, as a part of it, above which it is vibration [-]."""
CLEAR_GROWTH = 3.0
"""Standard errors from which on growth is clear [-]."""
WIDE_ENOUGH = 0.1
"""Least variation of the speed squared, as a part of its mean, for growth to be estimated [-]."""
LARGEST_ALIKENESS = 0.9
"""Correlation of neighbouring samples from which on a larger one widens the error no more [-]."""


class NotSlowRoll(Invalid):
    """Raised when no channel shows a slow-roll vector in the speed band.

    Attributes:
        reasons: Reason by channel, in words.
    """

    def __init__(self, reasons: dict[str, str]) -> None:
        self.reasons = reasons
        super().__init__("; ".join(f"{channel}: {reason}" for channel, reason in reasons.items()))

    @property
    def detail(self) -> str:
        """Describe of which channels nothing can be captured, and why."""
        return f"no slow roll: {self}"


class SlowRoll(Struct, frozen=True, eq=False):
    """Slow-roll vectors of a machine's m channels, for rotation in one sense.

    Attributes:
        direction: Sense of rotation, +1 or -1.
        vector: Complex vectors (m,), 0-to-peak [m]; NaN where there is none.
        standard_error: Rms of each vector's complex error (m,) [m].
    """

    direction: int
    vector: Complexes
    standard_error: Floats

    @property
    def known(self) -> NDArray[np.bool_]:
        """Return which channels have a vector (m,)."""
        return np.isfinite(self.vector)

    def turned(self, direction: Floats) -> Complexes:
        """Return the vectors for samples in given senses of rotation.

        The surface is a pattern r(γ) = Re(c e^{jγ}) of the angle γ on the shaft from the keyphasor's mark. A probe at β sees γ
        = β - Ωt, with t from the mark's passing at angle 0. So for Ω = +ω it shows Re(c e^{jβ} e^{-jωt}), whose phasor is
        conj(c e^{jβ}), and for Ω = -ω Re(c e^{jβ} e^{jωt}), the phasor c e^{jβ}: each is the other's complex conjugate. A
        keyphasor elsewhere changes β in both by the same angle.

        Args:
            direction: Senses of rotation (S,), +1 or -1 [-].

        Returns:
            Vectors (S, m), zero where there is none [m].
        """
        vector = np.where(self.known, self.vector, 0.0)
        return np.where((direction * self.direction > 0)[:, None], vector, np.conj(vector))


class Capture(Struct, frozen=True):
    """Vectors captured from samples.

    Attributes:
        slow_roll: The vectors.
        reasons: Reason why a channel has none, by channel.
        samples: Number of samples in the band.
        speed_minimum: Lowest speed of these [rad/s].
        speed_maximum: Highest speed of these [rad/s].
    """

    slow_roll: SlowRoll
    reasons: dict[str, str]
    samples: int
    speed_minimum: float
    speed_maximum: float


def capture(machine: Machine, measurement: Measurement, *, lowest: float, highest: float) -> Capture:
    """Capture the slow-roll vectors of the channels from all samples between two speeds, in the machine's sense of rotation.

    Each vector is the mean of the channel's usable phasors (Bently & Hatch 2002). Its error is that of the mean, neighbouring
    samples counted for less the more they are alike, together with the response that remains in it if the growth that the band
    shows, or leaves possible, goes on down to standstill.

    Args:
        machine: The machine.
        measurement: Samples of its channels.
        lowest: Lowest speed of the band [rad/s].
        highest: Highest speed of the band [rad/s].

    Returns:
        Vectors [m] and reasons.

    Raises:
        NotSlowRoll: No channel shows a vector.
        ValueError: The band's speeds are not positive and ascending.
    """
    if not 0.0 < lowest < highest:
        raise ValueError("a speed band needs two positive speeds, the lower one first")
    held = measurement.pick((measurement.speed >= lowest) & (measurement.speed <= highest))
    one_sense = np.where((held.direction * machine.direction > 0)[:, None], held.phasor, np.conj(held.phasor))
    vector = np.full(len(machine.probes), complex(np.nan, np.nan))
    error = np.full(len(machine.probes), np.nan)
    reasons: dict[str, str] = {}
    for column, channel in enumerate(machine.channels):
        good = held.usable[:, column]
        found = _vector(machine.noise, held.speed[good], one_sense[good, column], held.scatter[good, column])
        if isinstance(found, str):
            reasons[channel] = found
        else:
            vector[column], error[column] = found
    if len(reasons) == len(machine.probes):
        raise NotSlowRoll(reasons)
    slow_roll = SlowRoll(machine.direction, vector, error)
    return Capture(slow_roll, reasons, held.speed.size, float(held.speed.min()), float(held.speed.max()))


def subtracted(measurement: Measurement, slow_roll: SlowRoll) -> Measurement:
    """Subtract slow-roll vectors from a measurement; channels that have none stay as they are.

    Args:
        measurement: The measurement.
        slow_roll: The vectors.

    Returns:
        The measurement without them.
    """
    return replace(measurement, phasor=measurement.phasor - slow_roll.turned(measurement.direction))


def corrected(machine: Machine, measurement: Measurement, slow_roll: SlowRoll) -> tuple[Machine, Measurement]:
    """Prepare document and measurement for an identification with slow-roll vectors.

    The error of a vector is common to all samples of its channel, so it is no noise: it leaves a run-out of that spread, an
    unknown of the fit with that prior. It takes the place of the spread that the document gives for a run-out that was not
    subtracted. The noise stays a part of what the probe saw, run-out and all: where the source gave no scatter and the
    document states the noise, it is written down before the run-out is gone. A calibration has found run-outs as they were
    measured: they are moved by the vectors, exactly, and keep its covariance.

    Args:
        machine: The machine.
        measurement: The measurement.
        slow_roll: The vectors.

    Returns:
        Document and measurement without run-out.
    """
    scatter = measurement.scatter
    if not machine.noise.estimated and machine.calibration is None:  # which has found the scatter itself
        stated = error_size(machine.noise, np.abs(np.where(measurement.usable, measurement.phasor, 0.0)), scatter)
        scatter = np.where(slow_roll.known, stated, scatter)
    return without_run_outs(machine, slow_roll), replace(subtracted(measurement, slow_roll), scatter=scatter)


def without_run_outs(machine: Machine, slow_roll: SlowRoll) -> Machine:
    """Prepare a document alone for measurements from which slow-roll vectors were subtracted, as `corrected` does.

    Args:
        machine: The machine.
        slow_roll: The vectors.

    Returns:
        The document, a calibration's run-outs in it moved by the vectors.
    """
    held = () if machine.calibration is None else machine.calibration.parameters
    probes = tuple(
        probe.model_copy(update={"run_out_spread": float(error)})
        if known and f"probe.{channel}.run_out.real" not in held
        else probe
        for probe, channel, known, error in zip(
            machine.probes, machine.channels, slow_roll.known, slow_roll.standard_error, strict=True
        )
    )
    calibration = None if machine.calibration is None else _moved(machine.calibration, machine.channels, slow_roll)
    return machine.model_copy(update={"probes": probes, "calibration": calibration})


def _moved(calibration: Calibration, channels: Sequence[str], slow_roll: SlowRoll) -> Calibration:
    """Return a calibration whose run-outs are what remains of them without the vectors."""
    values = dict(zip(calibration.parameters, calibration.values, strict=True))
    turning_forward = slow_roll.turned(np.ones(1))[0]
    for channel, vector in zip(channels, turning_forward, strict=True):
        for part, moved in (("real", vector.real), ("imaginary", vector.imag)):
            name = f"probe.{channel}.run_out.{part}"
            if name in values:
                values[name] -= float(moved)
    return calibration.model_copy(update={"values": tuple(values.values())})


def _vector(noise: Noise, speed: Floats, phasor: Complexes, scatter: Floats) -> tuple[complex, float] | str:
    """Compute the vector and its standard error, or the reason why there is none."""
    count = phasor.size
    if count < FEWEST_SAMPLES:
        return f"{count} good samples in the band, {FEWEST_SAMPLES} are needed"
    mean = complex(np.mean(phasor))
    size = abs(mean)
    slope, slope_error, residual = _growth(speed, phasor)
    spread = math.sqrt(float(np.sum(np.abs(residual) ** 2)) / (count - 1))
    expected = float(np.sqrt(np.mean(error_size(noise, np.full(count, size), scatter) ** 2)))
    if spread > LARGEST_SCATTER * size and spread > BEYOND_NOISE * expected:
        return f"the vectors scatter by {1e6 * spread:.3g} µm about a mean of {1e6 * size:.3g} µm"
    grown = abs(slope) * float(np.ptp(speed**2))
    if abs(slope) > CLEAR_GROWTH * slope_error and grown > LARGEST_GROWTH * size:
        band = f"{rad_per_s_to_rpm(float(speed.min())):.0f} to {rad_per_s_to_rpm(float(speed.max())):.0f} r/min"
        return f"the vectors grow by {1e6 * grown:.3g} µm from {band}, at a mean of {1e6 * size:.3g} µm: this is vibration"
    # Growth that is not clear may be there all the same, as large as the noise lets it be.
    possible = max(abs(slope), slope_error) if math.isfinite(slope_error) else 0.0
    left = possible * float(np.mean(speed**2))
    return mean, math.hypot(spread / math.sqrt(_independent(residual)), left)


def _growth(speed: Floats, phasor: Complexes) -> tuple[complex, float, Complexes]:
    """Fit the slope of the phasors over the speed squared: slope, standard error, phasors without mean and slope."""
    square = speed**2 - np.mean(speed**2)
    about = phasor - np.mean(phasor)
    total = float(square @ square)
    if math.sqrt(total / speed.size) < WIDE_ENOUGH * float(np.mean(speed**2)):
        return 0j, math.inf, about
    slope = complex(square @ about) / total
    residual = about - slope * square
    return slope, math.sqrt(float(np.sum(np.abs(residual) ** 2)) / (speed.size - 2) / total), residual


def _independent(residual: Complexes) -> float:
    """Estimate the number of independent samples that the residuals are worth."""
    power = float(np.sum(np.abs(residual) ** 2))
    alike = float(np.real(np.vdot(residual[:-1], residual[1:]))) / power if power > 0.0 else 0.0
    alike = min(max(alike, 0.0), LARGEST_ALIKENESS)
    return residual.size * (1.0 - alike) / (1.0 + alike)
