"""Unbalances that a run's vectors show, and how far they err: by what the same method makes of the runs that are known.

Generalised least squares with correlations that few runs have shown. What such weights leave over is larger than their own
correlations say, and what their regularisation adds is not there: so each run is left out of the correlations in turn, and
what the weights of the others make of its scatter is an error (cross-validation: Stone, J. R. Stat. Soc. B 36 (1974) 111,
doi:10.1111/j.2517-6161.1974.tb00994.x).
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.balancing.measured_influence import MeasuredInfluence

LEAST_ALONE = 0.02
"""Least variance of a point that no other shares, as a part of its own [-]: no points err in perfect unison."""
FEWEST_RUNS = 3
"""Fewest runs that show all points from which they are left out in turn."""


def equivalent_unbalance(
    influence: MeasuredInfluence, vector: Complexes, *, beside_offset: bool = False
) -> tuple[Complexes, Complexes]:
    """Estimate the unbalances in the planes that would cause a run's vectors.

    Generalised least squares (Aitken, Proc. R. Soc. Edinb. 55 (1935) 42, doi:10.1017/S0370164600014346) with the scatter of
    the runs: what all points show together in each run by itself is the rotor's settling, what one shows alone is noise.

    Args:
        influence: Influence coefficients.
        vector: Vectors (K,) of a run; NaN where it shows none [m].
        beside_offset: Estimate what was added to the state without trial weights, instead of all that makes the vibration.

    Returns:
        Unbalances (Q,) [kg m] and their covariance (Q, Q), E[e eᴴ] [kg² m²].
    """
    shown = np.isfinite(vector)
    own = np.real(np.diag(influence.scatter))[shown]
    correlation = _regularised(influence.correlation()[np.ix_(shown, shown)], freedom=influence.freedom / 2.0)
    inverse = _weighted_inverse(influence.influence[shown], correlation, np.sqrt(own))
    found = inverse @ (vector - influence.offset if beside_offset else vector)[shown]
    # The error of the coefficients acts with the unbalance; that of the offset only where it was subtracted.
    unknowns = np.concatenate([[1.0 if beside_offset else 0.0], found])
    variance = np.real(np.einsum("i,kij,j->k", unknowns, influence.spread[shown], np.conj(unknowns)))
    size = np.sqrt(np.maximum(variance, 0.0) + own)
    expected = np.asarray(inverse @ (correlation * np.outer(size, size)) @ np.conj(inverse).T)
    grown = np.divide(size, np.sqrt(own), out=np.ones_like(size), where=own > 0.0)
    return found, _shown_by_runs(influence, shown, grown, expected)


def _shown_by_runs(influence: MeasuredInfluence, shown: NDArray[np.bool_], grown: Floats, expected: Complexes) -> Complexes:
    """Return the covariance (Q, Q) that the runs show, with the expected one for as many more of them as there are planes.

    grown: errors of coefficients and scatter together over the scatter (k,) at the points shown [-].
    """
    shares = influence.shares
    whole = np.zeros(0, dtype=np.intp) if shares is None else np.flatnonzero(np.isfinite(shares[:, shown]).all(axis=1))
    known_scatter = np.real(np.diag(influence.scatter))[shown]
    if shares is None or len(whole) < FEWEST_RUNS or not np.all(known_scatter > 0.0):
        return expected
    known = np.where(np.isfinite(shares), shares, 0.0)
    errors = np.array([inverse @ (known[run, shown] * grown) for run, inverse in _left_out(influence, known, shown, whole)])
    # Runs that do not show all of the points have as much of the scatter as the others.
    seen = len(known) / len(whole) * errors.T @ np.conj(errors)
    freedom, planes = influence.freedom / 2.0, len(influence.planes)
    return np.asarray((freedom * seen + planes * expected) / (freedom + planes))


def _left_out(
    influence: MeasuredInfluence, shares: Complexes, shown: NDArray[np.bool_], whole: NDArray[np.intp]
) -> Iterator[tuple[int, Complexes]]:
    """Yield each run that shows all points, and the weights (Q, k) that follow from the scatter of the others."""
    freedom = influence.freedom / 2.0 - 1.0
    alone = np.real(np.diag(influence.scatter))[shown]
    every = shares[:, shown].T @ np.conj(shares[:, shown])
    # What single vectors are known to err beyond the runs' scatter.
    rest = np.diag(np.maximum(alone - np.real(np.diag(every)), 0.0))
    for run in whole.tolist():
        own = shares[run, shown]
        scatter = every - np.outer(own, np.conj(own)) + rest
        size = np.sqrt(np.maximum(np.real(np.diag(scatter)), 1e-3 * alone))
        yield (
            run,
            _weighted_inverse(influence.influence[shown], _regularised(scatter / np.outer(size, size), freedom=freedom), size),
        )


def _regularised(correlation: Complexes, *, freedom: float) -> Complexes:
    """Return correlations between points that few runs have shown, fit to weight by.

    The part λ that Schäfer and Strimmer (Stat. Appl. Genet. Mol. Biol. 4 (2005) 32, doi:10.2202/1544-6115.1175) shrink by is
    Σ Var(r) / Σ |r|², with Var(r) = (1 - |r|²)² / ν. Here correlations shrink by λ² only and each point gets λ of its own
    beside them, a little more variance in all: weights chosen by estimated correlations err more than these say.
    """
    square = np.minimum(np.abs(correlation) ** 2, 1.0)[~np.eye(len(correlation), dtype=bool)]
    total = float(np.sum(square))
    if freedom <= 0.0:
        return np.eye(len(correlation), dtype=complex)
    part = float(np.sum((1.0 - square) ** 2)) / freedom / total if total > 0.0 and np.isfinite(freedom) else 0.0
    part = min(max(part, LEAST_ALONE), 1.0)
    return np.asarray((1.0 - part**2) * correlation + part * np.eye(len(correlation)))


def _weighted_inverse(matrix: Complexes, correlation: Complexes, size: Floats) -> Complexes:
    """Return (AᴴΣ⁻¹A)⁻¹AᴴΣ⁻¹; without weights where nothing is known of the scatter."""
    if not np.all(size > 0.0):
        return np.asarray(np.linalg.pinv(matrix))
    whitened = np.linalg.solve(np.linalg.cholesky(correlation), np.diag(1.0 / size).astype(complex))
    return np.asarray(np.linalg.pinv(whitened @ matrix) @ whitened)
