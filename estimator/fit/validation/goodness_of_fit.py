"""Verdict on a fit: whether it may be believed, and why."""

import math

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.fit.optimisation.nuisance_parameters import counted_by_effect, effective_count
from estimator.fit.optimisation.reweighting import with_fitted_noise
from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.calibration_conflict import SMALLEST_CHANCE, calibration_conflict

FAR_LESS_NOISE = 7.0
"""Factor by which noise is less than stated from which on the unit of amplitudes is doubted [-]: a mil is 25 µm."""
MOST_TIMES = 1000.0
"""Factor from which on its size says nothing more [-]."""
CHI_SQUARE_LIMIT = 5.0
"""Standard deviations √(2/dof) by which χ²/dof may exceed 1 for a fit with stated noise to be accepted [-]."""
LARGEST_OUTLIER_PART = 0.1
"""Largest part of the phasors that a fit may leave out [-]; beyond it the outliers may be the right ones."""
FEW_OUTLIERS = 5
"""Fewest outliers from which a single channel may be named."""
LARGEST_ESTIMATED_NOISE = 0.2
"""Relative noise [-]; an estimate above it means that the model does not fit."""
SMALLEST_ESTIMATED_NOISE = 1e-5
"""Relative noise below which an estimate is rounding: the data were computed [-]."""
LARGEST_SERIAL_CORRELATION = 0.1
"""Largest correlation of residuals of neighbouring speeds with estimated noise, plus five standard deviations [-]."""
LARGEST_ALIKENESS = 0.9
"""Correlation from which on a larger one widens intervals no more [-]."""
CONTRADICTS = (
    "the run contradicts the document's calibration: if something has changed since, calibrate again or take `calibration` out"
)
MUCH_NOISIER = 1.5
"""Noise of a channel over the noise model's from which on it is mentioned [-]."""


class Verdict(Struct, frozen=True):
    """Verdict on a fit.

    Attributes:
        accepted: Whether the fit may be used.
        words: The reason in words.
        degrees_of_freedom: Degrees of freedom of χ², at least 1.
    """

    accepted: bool
    words: str
    degrees_of_freedom: int

    def refused(self, reason: str) -> "Verdict":
        """Return the verdict that the fit may not be used although χ² allows it.

        Args:
            reason: The reason in words.

        Returns:
            The verdict.
        """
        beside = self.words.removeprefix("accepted").lstrip(":; ")
        return Verdict(False, f"{reason}; {beside}", self.degrees_of_freedom)


def accepted(chi_square: float, freedom: int) -> bool:
    """Check whether χ² is no larger than the noise explains.

    Args:
        chi_square: χ² [-].
        freedom: Degrees of freedom.

    Returns:
        Whether it is.
    """
    return chi_square / freedom <= 1.0 + CHI_SQUARE_LIMIT * math.sqrt(2.0 / freedom)


def judge(problem: FitProblem, found: FitResult) -> Verdict:
    """Judge a fit by its χ², its outliers and, where its noise is estimated, the order in its residuals.

    Args:
        problem: The fit's problem.
        found: The fit.

    Returns:
        The verdict.
    """
    usable = int(np.count_nonzero(problem.measurement.usable))
    left_out = int(np.count_nonzero(found.outlier))
    told = problem.coordinates.size - int(np.count_nonzero(counted_by_effect(problem.coordinates)))
    freedom = max(1, 2 * (usable - left_out) - told - round(effective_count(problem, found)))
    reduced, spread = found.chi_square / freedom, math.sqrt(2.0 / freedom)
    chi = f"χ²/dof {reduced:.3g}, expected 1 ± {spread:.2g}"
    if found.noise.estimated:
        chi = f"noise estimated as {100 * found.noise.relative:.2g} % and {found.noise.floor:.2g} m"
        chi += _noisy_channels(problem, found)
    outlying = f"; {left_out} of {usable} phasors left out as outliers{_worst_channel(problem, found)}" if left_out else ""
    if not found.converged:
        return Verdict(False, f"not converged, {chi}{outlying}", freedom)
    held = calibration_conflict(problem, found)
    against = "" if held is None else f"{CONTRADICTS} ({held.words})"
    if left_out > LARGEST_OUTLIER_PART * usable:
        return Verdict(False, f"{against or 'too much does not fit'}: {chi}{outlying}", freedom)
    if found.noise.estimated:
        return _judge_by_order(problem, found, f"{chi}{outlying}", freedom)
    explained = held is None or held.chance >= SMALLEST_CHANCE or accepted(held.chi_square, held.freedom)
    changed = held is not None and held.chain_changed
    if changed or not explained or not accepted(found.chi_square, freedom):
        where = _misfitting_channel(problem, found)
        return Verdict(False, f"{against or 'the model does not fit the data'}: {chi}{where}{outlying}", freedom)
    if reduced < 1.0 - CHI_SQUARE_LIMIT * spread:
        return Verdict(True, f"accepted; the stated noise is too large: {chi}{outlying}{_far_less_noise(reduced)}", freedom)
    return Verdict(True, f"accepted: {chi}{outlying}", freedom)


def _far_less_noise(reduced: float) -> str:
    """Return the doubt whether amplitudes are in the unit that is said: in a larger one their noise looks far too small."""
    if reduced > FAR_LESS_NOISE**-2:
        return ""
    factor = f"{reduced**-0.5:.0f} times" if reduced > MOST_TIMES**-2 else f"over {MOST_TIMES:.0f} times"
    return f"; phasors scatter {factor} less than stated: are the noise and the unit of amplitudes right?"


def is_unfinished(problem: FitProblem, found: FitResult) -> bool:
    """Return whether a fit has not converged and would be accepted if it had: in a long valley that the noise covers.

    Args:
        problem: The fit's problem.
        found: The fit.

    Returns:
        Whether it is so.
    """
    return not found.converged and judge(problem, replace(found, converged=True)).accepted


class VerdictRemark(Struct, frozen=True):
    """Remark on an accepted fit.

    Attributes:
        words: The remark.
        inflation: Factor on the fit's covariance [-].
        left_open: What its covariance (n, n) grows by beside [-]; None for nothing.
    """

    words: str = ""
    inflation: float = 1.0
    left_open: Floats | None = None


def remark(problem: FitProblem, found: FitResult) -> VerdictRemark:
    """Check an accepted fit for what χ² is not sharp enough for: a pattern over speed, and a calibration that holds it badly.

    Args:
        problem: The fit's problem.
        found: The fit.

    Returns:
        The remark, with words only where there is something.
    """
    alike, held = _alike(problem, found), calibration_conflict(problem, found)
    if held is None or (held.inflation == 1.0 and held.doubted is None):
        return alike
    words = f"; the run fits the document's calibration badly ({held.words}): intervals are widened"
    left_open = None if held.doubted is None else held.doubted.left_open
    return VerdictRemark(alike.words + words, alike.inflation * held.inflation, left_open)


def _alike(problem: FitProblem, found: FitResult) -> VerdictRemark:
    """Check whether the residuals show a pattern over speed.

    Not a reason to refuse: the errors of overlapping measurements are alike as well. Then there are fewer independent ones,
    and the covariance grows by (1 + r) / (1 - r), as for errors of a first-order autoregression (Bayley and Hammersley,
    Suppl. J. R. Stat. Soc. 8 (1946) 184, doi:10.2307/2983560).
    """
    usable = int(np.count_nonzero(problem.measurement.usable & ~found.outlier))
    if found.noise.relative <= SMALLEST_ESTIMATED_NOISE or found.chi_square < usable:
        return (
            VerdictRemark()
        )  # half of what the noise would leave, or less: the data were computed, and rounding has patterns
    correlation, pairs = serial_correlation(problem, found)
    alike = float(np.sum(correlation * pairs) / max(1, pairs.sum()))
    if alike <= CHI_SQUARE_LIMIT / math.sqrt(2.0 * max(1, pairs.sum())):
        return VerdictRemark()
    alike = min(alike, LARGEST_ALIKENESS)
    words = (
        f"; residuals of neighbouring speeds are alike (correlation {alike:.2g}): the model may be slightly wrong, or the "
        "samples overlap; intervals are widened"
    )
    return VerdictRemark(words, (1.0 + alike) / (1.0 - alike))


def _judge_by_order(problem: FitProblem, found: FitResult, words: str, freedom: int) -> Verdict:
    """Judge by the order of the residuals.

    With estimated noise χ² is as expected by construction; a model that does not fit leaves a pattern over speed.
    """
    if found.noise.relative <= SMALLEST_ESTIMATED_NOISE and found.noise.floor == 0.0:
        return Verdict(True, f"accepted; no noise to be seen: {words}", freedom)
    if found.noise.relative * float(np.max(found.channel_noise)) > LARGEST_ESTIMATED_NOISE:
        return Verdict(False, f"the model does not fit the data: {words}", freedom)
    correlation, pairs = serial_correlation(problem, found)
    whole = float(np.sum(correlation * pairs) / max(1, pairs.sum()))
    limit = LARGEST_SERIAL_CORRELATION + 5.0 / math.sqrt(2.0 * max(1, pairs.sum()))
    limits = LARGEST_SERIAL_CORRELATION + 5.0 / np.sqrt(2.0 * np.maximum(1, pairs))
    worst = int(np.argmax(correlation - limits))
    if whole <= limit and correlation[worst] <= limits[worst]:
        return Verdict(True, f"accepted: {words}", freedom)
    one = whole <= limit
    at, most = (float(correlation[worst]), float(limits[worst])) if one else (whole, limit)
    of = f"of {problem.train.channels[worst]} at" if one else "of"
    message = f"residuals {of} neighbouring speeds are alike, correlation {at:.2g}, at most {most:.2g} is noise"
    return Verdict(False, f"the model does not fit the data: {message}; {words}", freedom)


def serial_correlation(problem: FitProblem, found: FitResult) -> tuple[Floats, NDArray[np.intp]]:
    """Compute the correlation of weighted residuals between neighbouring speeds of each channel.

    Args:
        problem: The fit's problem, with m channels.
        found: The fit.

    Returns:
        Correlations (m,) [-] and numbers of pairs (m,).
    """
    final = with_fitted_noise(problem, found)
    model = final.model(found.theta)
    error = final.error(np.abs(model))
    used = final.used & (error > 0.0)
    size = np.divide(final.measurement.phasor - model, error, out=np.zeros_like(model), where=used)
    order = np.lexsort((final.measurement.speed, final.measurement.direction))
    size, used = size[order], used[order]
    both = used[1:] & used[:-1]
    first, second = np.where(both, size[1:], 0.0), np.where(both, size[:-1], 0.0)
    power = np.sum(np.abs(first) ** 2 + np.abs(second) ** 2, axis=0) / 2
    product = np.sum((first * second.conj()).real, axis=0)
    return np.divide(product, power, out=np.zeros_like(power), where=power > 0.0), np.count_nonzero(both, axis=0)


def _misfitting_channel(problem: FitProblem, found: FitResult) -> str:
    """Name the channel that holds more than half of the excess of χ²."""
    final = with_fitted_noise(problem, found)
    model = final.model(found.theta)
    error = final.error(np.abs(model))
    used = final.used & (error > 0.0)
    size = np.divide(final.measurement.phasor - model, error, out=np.zeros_like(model), where=used)
    excess = 2.0 * (np.sum(np.abs(size) ** 2, axis=0) - np.count_nonzero(used, axis=0))
    worst = int(np.argmax(excess))
    if excess.size < 2 or excess[worst] <= np.maximum(excess, 0.0).sum() / 2:
        return ""
    return f", most of it at {problem.train.channels[worst]}"


def _noisy_channels(problem: FitProblem, found: FitResult) -> str:
    noisy = [
        f"{channel} {times:.1f} times that"
        for channel, times in zip(
            problem.train.channels, np.broadcast_to(found.channel_noise, len(problem.train.channels)), strict=True
        )
        if times > MUCH_NOISIER
    ]
    return f", at {', '.join(noisy)}" if noisy else ""


def _worst_channel(problem: FitProblem, found: FitResult) -> str:
    """Name the channel with more than half of the outliers, if there is one."""
    counts = np.count_nonzero(found.outlier, axis=0)
    worst = int(np.argmax(counts))
    if len(counts) < 2 or counts.sum() < FEW_OUTLIERS or counts[worst] <= counts.sum() / 2:
        return ""
    return f", most of them of {problem.train.channels[worst]}"
