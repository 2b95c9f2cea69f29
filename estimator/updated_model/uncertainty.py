"""Error propagation: uncertainty of a prediction, from the covariance of the coordinates it was predicted with.

First order ("delta method"; JCGM 100:2008, 5.2), in the coordinates of the fit: direct terms as logarithms, so that an
uncertain stiffness stays positive.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
import scipy

from estimator.arrays import Complexes, Floats
from estimator.fit.estimates import CONFIDENCE_95

UPPER_97_5 = 0.975
"""Probability of the upper bound of a 95 % interval [-]."""


@dataclass(frozen=True)
class PhasorBand:
    """Phasors with their uncertainty, arrays of any one shape (...).

    Attributes:
        value: Complex estimates (...) [unit of the phasor].
        covariance: Covariance (..., 2, 2) of real and imaginary part [unit²].
        lower: Lower 95 % bound (...) of the true amplitude [unit of the phasor].
        upper: Upper 95 % bound (...) of the true amplitude [unit of the phasor]; above zero where the estimate is zero.
    """

    value: Complexes
    covariance: Floats
    lower: Floats
    upper: Floats

    @classmethod
    def joined(cls, bands: Sequence["PhasorBand"]) -> "PhasorBand":
        """Join several bands along their first axis.

        Args:
            bands: The bands.

        Returns:
            One band.
        """
        names = [one.name for one in fields(cls)]
        return cls(*(np.concatenate([getattr(band, name) for band in bands]) for name in names))

    @property
    def amplitude(self) -> Floats:
        """Return the amplitudes |value| (...) [unit of the phasor]."""
        return np.abs(self.value)

    @property
    def phase(self) -> Floats:
        """Return the phase leads (...) [rad]."""
        return np.angle(self.value)


def phasor_band(value: Complexes, slope: Complexes, covariance: Floats) -> PhasorBand:
    """Compute the band of phasors from their derivatives.

    Lower bound: 1.96 standard errors of the amplitude below it, not below zero. Upper bound: 97.5 % quantile of a gamma
    distribution with the mean and variance of the squared modulus of a normal variable (Patnaik, Biometrika 36 (1949) 202,
    doi:10.2307/2332542), which is 1.96 standard errors above a well known amplitude and right for one near zero, too.

    Args:
        value: Phasors (...) [any unit].
        slope: Derivatives (..., n) of the phasors by the coordinates [unit of the phasor per unit of the coordinate].
        covariance: Covariance (n, n) of the coordinates [unit²].

    Returns:
        Band (...) [unit of the phasor].
    """
    parts = np.stack([slope.real, slope.imag], axis=-2)
    spread = parts @ covariance @ np.swapaxes(parts, -1, -2)
    mean = np.stack([value.real, value.imag], axis=-1)[..., None]
    along = (np.swapaxes(mean, -1, -2) @ spread @ mean)[..., 0, 0]
    amplitude = np.abs(value)
    error = np.sqrt(np.divide(along, amplitude**2, out=np.zeros_like(along), where=amplitude > 0.0))
    square = amplitude**2 + np.trace(spread, axis1=-2, axis2=-1)
    variance = 2 * np.trace(spread @ spread, axis1=-2, axis2=-1) + 4 * along
    # Nothing uncertain: any shape does, the scale is zero.
    shape = np.divide(square**2, variance, out=np.ones_like(square), where=variance > 0.0)
    quantile = np.where(variance > 0.0, scipy.special.gammaincinv(shape, UPPER_97_5) * square / shape, square)
    return PhasorBand(
        value=np.asarray(value),
        covariance=np.asarray(spread),
        lower=np.maximum(amplitude - CONFIDENCE_95 * error, 0.0),
        upper=np.sqrt(quantile),
    )


def standard_errors(slope: Floats, covariance: Floats) -> Floats:
    """Compute the standard errors of real predictions (JCGM 100:2008, 5.2).

    Args:
        slope: Derivatives (..., n) of the predictions by the coordinates [unit of the prediction per unit of the coordinate].
        covariance: Covariance (n, n) of the coordinates [unit²].

    Returns:
        Standard errors (...) [unit of the prediction].
    """
    return np.asarray(np.sqrt(np.sum((slope @ covariance) * slope, axis=-1)))
