"""Slow-roll vectors: what the probes show of the shaft's surface and shape where nothing yet makes the shaft move.

At slow roll a probe sees mechanical and electrical run-out and the bow of the shaft; both are there at every speed and are
subtracted as vectors (Bently & Hatch, Fundamentals of Rotating Machinery Diagnostics, 2002). Vibration by unbalance grows with
the speed squared, so a mean over a band in which the vectors grow is no slow roll.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from estimator.condensation import Complexes, Floats
from estimator.errors import Invalid
from estimator.machine import Machine, Noise
from estimator.measurement import Measurement
from estimator.noise import error_size
from estimator.units import rad_per_s_to_rpm

FEWEST_SAMPLES = 5
"""Good samples of a channel that a vector needs."""
LARGEST_SCATTER = 0.3
"""Samples that scatter by more than this part of their mean, and by more than the noise explains, show no vector."""
BEYOND_NOISE = 3.0
"""Scatter above this multiple of the stated noise is more than noise."""
LARGEST_GROWTH = 0.25
"""A mean that grows over the band by more than this part of itself is vibration."""
CLEAR_GROWTH = 3.0
"""Growth of this many standard errors is clear: more than that of a band may grow is then no slow roll."""
WIDE_ENOUGH = 0.1
"""Part of its mean that the square of the speed must vary by for growth to be looked for."""
LARGEST_ALIKENESS = 0.9
"""Correlation of neighbouring samples from which on a larger one widens the error no more."""


class NotSlowRoll(Invalid):
    """No channel shows a slow-roll vector in the speed band. `reasons` says per channel why."""

    def __init__(self, reasons: dict[str, str]) -> None:
        self.reasons = reasons
        super().__init__("; ".join(f"{channel}: {reason}" for channel, reason in reasons.items()))

    @property
    def detail(self) -> str:
        """Say of which channels nothing can be captured, and why."""
        return f"no slow roll: {self}"


@dataclass(frozen=True)
class SlowRoll:
    """Slow-roll vectors of a machine's m channels, for rotation in one sense.

    direction: +1 or -1. vector: (m,) complex 0-to-peak [m], NaN where there is none. standard_error: (m,) rms of the vector's
    complex error [m].
    """

    direction: int
    vector: Complexes
    standard_error: Floats

    @property
    def known(self) -> NDArray[np.bool_]:
        """(m,) channels that have a vector."""
        return np.isfinite(self.vector)

    def turned(self, direction: Floats) -> Complexes:
        """Vectors (S, m) for samples in the senses of rotation (S,), zero where there is none.

        The surface is a pattern r(γ) = Re(c e^{jγ}) of the angle γ on the shaft from the keyphasor's mark. A probe at β sees
        γ = β - Ωt, with t from the mark's passing at angle 0. So for Ω = +ω it shows Re(c e^{jβ} e^{-jωt}), whose phasor is
        conj(c e^{jβ}), and for Ω = -ω Re(c e^{jβ} e^{jωt}), the phasor c e^{jβ}: each is the other's complex conjugate. A
        keyphasor elsewhere changes β in both by the same angle.
        """
        vector = np.where(self.known, self.vector, 0.0)
        return np.where((direction * self.direction > 0)[:, None], vector, np.conj(vector))


@dataclass(frozen=True)
class Capture:
    """Vectors captured from samples, and why channels have none. samples: in the band; speeds: of these [rad/s]."""

    slow_roll: SlowRoll
    reasons: dict[str, str]
    samples: int
    speed_minimum: float
    speed_maximum: float


def capture(machine: Machine, measurement: Measurement, *, lowest: float, highest: float) -> Capture:
    """Slow-roll vectors of the channels, from all samples between two speeds [rad/s], in the machine's sense of rotation.

    Each vector is the mean of the channel's usable phasors. Its error is that of the mean, neighbouring samples counted for
    less the more they are alike, together with the response that remains in it if the growth that the band shows, or
    leaves possible, goes on down to standstill. Raises NotSlowRoll when no channel shows a vector, ValueError for a band that
    is none.
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
    """The measurement without the slow-roll vectors; channels that have none stay as they are."""
    return replace(measurement, phasor=measurement.phasor - slow_roll.turned(measurement.direction))


def corrected(machine: Machine, measurement: Measurement, slow_roll: SlowRoll) -> tuple[Machine, Measurement]:
    """What an identification with slow-roll vectors is fed with: the document and the measurement without run-out.

    The error of a vector is common to all samples of its channel, so it is no noise: it leaves a run-out of that spread, an
    unknown of the fit with that prior. It takes the place of the spread that the document gives for a run-out that was not
    subtracted. The noise stays a part of what the probe saw, run-out and all: where the source gave no scatter and the
    document states the noise, it is written down before the run-out is gone.
    """
    scatter = measurement.scatter
    if not machine.noise.estimated:
        stated = error_size(machine.noise, np.abs(np.where(measurement.usable, measurement.phasor, 0.0)), scatter)
        scatter = np.where(slow_roll.known, stated, scatter)
    probes = tuple(
        probe.model_copy(update={"run_out_spread": float(error)}) if known else probe
        for probe, known, error in zip(machine.probes, slow_roll.known, slow_roll.standard_error, strict=True)
    )
    without = replace(subtracted(measurement, slow_roll), scatter=scatter)
    return machine.model_copy(update={"probes": probes}), without


def _vector(noise: Noise, speed: Floats, phasor: Complexes, scatter: Floats) -> tuple[complex, float] | str:
    """The vector and its standard error, or why there is none."""
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
        band = f"{rad_per_s_to_rpm(float(speed.min())):.0f} to {rad_per_s_to_rpm(float(speed.max())):.0f} rpm"
        return f"the vectors grow by {1e6 * grown:.3g} µm from {band}, at a mean of {1e6 * size:.3g} µm: this is vibration"
    # Growth that is not clear may be there all the same, as large as the noise lets it be.
    possible = max(abs(slope), slope_error) if math.isfinite(slope_error) else 0.0
    left = possible * float(np.mean(speed**2))
    return mean, math.hypot(spread / math.sqrt(_independent(residual)), left)


def _growth(speed: Floats, phasor: Complexes) -> tuple[complex, float, Complexes]:
    """Slope of the phasors over the speed squared, its standard error, and the phasors without mean and slope."""
    square = speed**2 - np.mean(speed**2)
    about = phasor - np.mean(phasor)
    total = float(square @ square)
    if math.sqrt(total / speed.size) < WIDE_ENOUGH * float(np.mean(speed**2)):
        return 0j, math.inf, about
    slope = complex(square @ about) / total
    residual = about - slope * square
    return slope, math.sqrt(float(np.sum(np.abs(residual) ** 2)) / (speed.size - 2) / total), residual


def _independent(residual: Complexes) -> float:
    """How many independent samples the residuals are worth."""
    power = float(np.sum(np.abs(residual) ** 2))
    alike = float(np.real(np.vdot(residual[:-1], residual[1:]))) / power if power > 0.0 else 0.0
    alike = min(max(alike, 0.0), LARGEST_ALIKENESS)
    return residual.size * (1.0 - alike) / (1.0 + alike)
