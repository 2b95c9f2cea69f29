"""Size of the errors of measured phasors: as stated, or as the residuals of a fit show."""

from math import log

import numpy as np
import scipy
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.machine.rules import Noise

SMALLEST_RELATIVE, LARGEST_RELATIVE = 1e-6, 1.0
"""Bounds of an estimated relative error [-]."""
CHANNEL_PRIOR = 20.0
"""Number of samples that the expectation counts for that all channels are alike."""
CLEARLY_NOISIER = 4.0
"""Standard deviations by which a channel must differ from the others to be taken as noisier or less noisy [-]."""
OUTLIER_CHANCE = 0.01
"""Chance that among all phasors of a run one is called an outlier that is none [-]."""


def error_size(noise: Noise, amplitude: Floats, scatter: Floats) -> Floats:
    """Compute the rms of the complex error of each phasor: the source's own scatter where it gave one, else the noise model.

    Args:
        noise: Noise model.
        amplitude: |X| 0-to-peak, any shape (...) [m], best taken from the fitted response: weights from noisy amplitudes bias
            the fit.
        scatter: Rms error by the source (...) [m]; NaN where it gave none.

    Returns:
        Rms error (...) [m].
    """
    modelled = np.sqrt((noise.relative * amplitude) ** 2 + noise.floor**2)
    return np.where(scatter > 0.0, np.maximum(scatter, noise.floor), modelled)


def estimated_noise(start: Noise, *, amplitude: Floats, misfit: Floats, spent: float) -> Noise:
    """Estimate the noise model under which residuals are most likely.

    Errors are circular Gaussian with variance (relative·|X|)² + floor². Restricted maximum likelihood (Patterson and Thompson,
    Biometrika 58 (1971) 545, doi:10.1093/biomet/58.3.545) in its simplest form: residuals are scaled to the freedom left.

    Args:
        start: Noise model to start from.
        amplitude: Modelled |X| (N,) [m].
        misfit: Absolute residual (N,) [m].
        spent: Part of the data's freedom that the fit has used up, 0 to 1; residuals are that much smaller than errors [-].

    Returns:
        The noise model.
    """
    square = misfit**2 / max(1.0 - spent, 1e-3)
    typical = float(np.sqrt(np.mean(amplitude**2)))

    def deviance(theta: Floats) -> tuple[float, Floats]:
        relative, floor = np.exp(2 * theta) * np.array([1.0, typical**2])
        variance = relative * amplitude**2 + floor
        # d/dθ of ln v + e/v.
        slope = (1 - square / variance) / variance
        gradient = np.array([np.mean(slope * 2 * relative * amplitude**2), np.mean(slope * 2 * floor)])
        return float(np.mean(np.log(variance / typical**2) + square / variance)), gradient

    bounds = [(log(SMALLEST_RELATIVE), log(LARGEST_RELATIVE))] * 2
    rms = float(np.sqrt(np.mean(square))) / typical
    overall = log(min(max(rms, 2 * SMALLEST_RELATIVE), LARGEST_RELATIVE / 2))
    begin = [
        np.array([log(start.relative), log(min(max(start.floor / typical, SMALLEST_RELATIVE), 1.0))]),
        np.array([overall, overall]),
        np.array([overall, log(SMALLEST_RELATIVE)]),
    ]
    found = [scipy.optimize.minimize(deviance, x, jac=True, method="L-BFGS-B", bounds=bounds).x for x in begin]
    ends = np.array([deviance(theta)[0] for theta in found])
    relative, part = np.exp(np.asarray(found[int(np.argmin(ends))], dtype=float)).tolist()
    floor = 0.0 if part <= 1.01 * SMALLEST_RELATIVE else part * typical
    return start.model_copy(update={"relative": relative, "floor": floor})


def channel_noise(size: Floats, used: NDArray[np.bool_], *, spent: float) -> Floats:
    """Estimate the noise of each channel over that of the noise model.

    Args:
        size: Residual over the rms of its error (S, m) [-].
        used: True for the phasors that count (S, m).
        spent: Part of the data's freedom that the fit has used up, 0 to 1 [-].

    Returns:
        Factors (m,), 1 unless a channel clearly differs [-].
    """
    count = np.count_nonzero(used, axis=0)
    square = np.sum(np.where(used, size**2, 0.0), axis=0) / max(1.0 - spent, 1e-3)
    times = np.sqrt((CHANNEL_PRIOR + square) / (CHANNEL_PRIOR + count))
    # The mean of n squared circular errors scatters by 1/√n, its root by half of that.
    clear = np.abs(np.log(times)) > CLEARLY_NOISIER * 0.5 / np.sqrt(np.maximum(1, count))
    return np.asarray(np.where(clear, times, 1.0))


def outlier_limit(used: NDArray[np.bool_]) -> float:
    """Compute the largest squared size that circular Gaussian errors would show.

    Args:
        used: True for the errors that count (S, m).

    Returns:
        Square of the size over the rms error [-].
    """
    return log(max(1, int(np.count_nonzero(used))) / OUTLIER_CHANCE)


def outliers(size: Floats, used: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Mark the phasors that lie too far from the model to be noise.

    Sizes are scaled by their median first, so that a model that does not fit yet calls nothing an outlier.

    Args:
        size: Residual over the rms of its error (S, m) [-].
        used: True for the phasors that count (S, m).

    Returns:
        True for outliers (S, m).
    """
    if not np.any(used):
        return np.zeros_like(used)
    scale = max(1.0, float(np.median(size[used] ** 2)) / log(2.0))
    return used & (size**2 > scale * outlier_limit(used))
