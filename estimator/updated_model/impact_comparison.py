"""Natural frequencies from an impact test beside those of the updated model at standstill (thesis §5.5, Table 5.6)."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy

from estimator.arrays import Floats
from estimator.machine.rules import ImpactTest
from estimator.modes.critical_speed import HEAVILY_DAMPED
from estimator.modes.eigenmodes import Modes
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.shaft_element import NODE_DOFS
from estimator.updated_model.modal_uncertainty import modes_at, natural_frequency_errors
from estimator.updated_model.model import UpdatedModel

LARGEST_DEVIATION = math.log(1.25)
"""Largest logarithm of the ratio of two frequencies that are taken for the same mode [-]: 25 %."""
LEAST_SHARE = 0.1
"""Least part of a mode's kinetic energy in the x-z plane for a hammer along x to show it [-]."""


@dataclass(frozen=True)
class MeasuredFrequency:
    """A peak of an impact test at standstill.

    Attributes:
        frequency: Natural frequency [Hz].
        standard_deviation: Its standard deviation [Hz]; None where not known.
        direction: Direction of hammer and sensor; None where not known.
    """

    frequency: float
    standard_deviation: float | None = None
    direction: Literal["x", "y"] | None = None

    def __post_init__(self) -> None:
        if not (math.isfinite(self.frequency) and self.frequency > 0):
            raise ValueError(f"a natural frequency must be positive, not {self.frequency} Hz")
        if self.standard_deviation is not None and not self.standard_deviation >= 0:
            raise ValueError(f"a standard deviation must not be negative: {self.standard_deviation} Hz")


@dataclass(frozen=True)
class ComparedFrequency:
    """A measured frequency and the mode of the model that it is taken for.

    Attributes:
        measured: The measured frequency.
        model: Damped natural frequency of the mode [Hz].
        model_error: Its standard error [Hz].
        deviation: Model over measured, minus 1 [-].
        standard_deviations: Difference in units of its own uncertainty [-]; None where there is none.
    """

    measured: MeasuredFrequency
    model: float
    model_error: float
    deviation: float
    standard_deviations: float | None


@dataclass(frozen=True)
class ImpactComparison:
    """An impact test beside the updated model, ascending.

    Attributes:
        compared: Measured frequencies with their modes.
        unmatched: Measured peaks without a mode near them, of the foundation, say.
        unseen: The model's frequencies up to the highest measured one that no peak was taken for [Hz].
    """

    compared: tuple[ComparedFrequency, ...]
    unmatched: tuple[MeasuredFrequency, ...]
    unseen: tuple[float, ...]


def measured_frequencies(test: ImpactTest) -> tuple[MeasuredFrequency, ...]:
    """Convert the impact test of a machine document.

    Args:
        test: Impact test of the document.

    Returns:
        Measured frequencies with their standard deviations [Hz].
    """
    return tuple(MeasuredFrequency(one, test.relative_error * one) for one in test.frequencies_hz)


def compare_impact_test(model: UpdatedModel, measured: Sequence[MeasuredFrequency]) -> ImpactComparison:
    """Pair measured natural frequencies with the modes of the updated model at standstill (thesis §5.5, Table 5.6).

    Pairs are those with the least sum of squared logarithms of the frequencies' ratio (Kuhn, Naval Res. Logist. Q. 2 (1955)
    83, doi:10.1002/nav.3800020109); leaving a peak alone costs as much as a deviation of 25 %. Coefficients that follow the
    speed are taken at zero speed; oil-film bearings are others at standstill anyway.

    Args:
        model: The updated model.
        measured: The measured frequencies.

    Returns:
        Pairs, and frequencies without a partner.
    """
    found = modes_at(model, speed=0.0)
    felt = np.flatnonzero(found.damping_ratio < HEAVILY_DAMPED)
    found = Modes(found.eigenvalue[felt], found.shape[:, felt], found.left[:, felt])
    frequency = found.eigenvalue.imag / (2 * math.pi)
    error = natural_frequency_errors(model, found, speed=0.0) / (2 * math.pi)
    cost = _costs(measured, frequency, share_along_x(found, model.basis.reduced(assemble_rotor(model.scaled_machine)).mass))
    rows, columns = scipy.optimize.linear_sum_assignment(cost)
    pairs = {int(i): int(j) for i, j in zip(rows, columns, strict=True) if j < frequency.size}
    order = sorted(range(len(measured)), key=lambda i: measured[i].frequency)
    highest = max((one.frequency for one in measured), default=0.0)
    return ImpactComparison(
        compared=tuple(_compared(measured[i], frequency[pairs[i]], error[pairs[i]]) for i in order if i in pairs),
        unmatched=tuple(measured[i] for i in order if i not in pairs),
        unseen=tuple(float(one) for j, one in enumerate(frequency) if one <= highest and j not in pairs.values()),
    )


def share_along_x(found: Modes, mass: Floats) -> Floats:
    """Compute the part of each mode's kinetic energy in the x-z plane.

    Args:
        found: k modes.
        mass: Mass matrix (N, N) [SI].

    Returns:
        Parts (k,), 0 to 1 [-].
    """
    along_x = np.zeros(mass.shape[0], dtype=bool)
    along_x[0::NODE_DOFS] = along_x[3::NODE_DOFS] = True
    shape = np.where(along_x[:, None], found.shape, 0.0)
    whole = np.sum(np.conj(found.shape) * (mass @ found.shape), axis=0).real
    return np.asarray(np.sum(np.conj(shape) * (mass @ shape), axis=0).real / whole)


def _costs(measured: Sequence[MeasuredFrequency], frequency: Floats, share: Floats) -> Floats:
    """Compute the costs (measured, modes + measured) of the pairs: each peak may also stay alone."""
    cost = np.full((len(measured), frequency.size + len(measured)), LARGEST_DEVIATION**2)
    for i, one in enumerate(measured):
        shows = {None: np.ones(share.size), "x": share, "y": 1.0 - share}[one.direction] >= LEAST_SHARE
        distance = np.log(frequency / one.frequency) ** 2
        cost[i, : frequency.size] = np.where(shows & (distance < LARGEST_DEVIATION**2), distance, 1e6)
    return cost


def _compared(measured: MeasuredFrequency, model: float, error: float) -> ComparedFrequency:
    spread = math.hypot(error, measured.standard_deviation or 0.0)
    return ComparedFrequency(
        measured=measured,
        model=float(model),
        model_error=float(error),
        deviation=float(model / measured.frequency - 1.0),
        standard_deviations=float((model - measured.frequency) / spread) if spread > 0.0 else None,
    )
