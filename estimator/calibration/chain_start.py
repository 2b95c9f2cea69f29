"""Gains and run-outs from which a calibration starts: those that known unbalances show at given coefficients.

A reading is V = g (H w + H u) + r, with known weights w, the machine's own unbalance u, the model's response H, gain g and
run-out r: separable (Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973) 413, doi:10.1137/0710036). With g u in place of u as
unknowns, each channel by itself is linear in them: one regression, without which a fit begins at a gain of one and follows a
curved valley to where it is.
"""

import numpy as np
from msgspec.structs import replace

from estimator.arrays import Complexes, Floats
from estimator.fit.problem.fit_problem import FitProblem, best_excitations
from estimator.rotor.response import excitation_responses

SMALLEST, LARGEST = 0.02, 50.0
"""Gains between which one is believed [-]: others come from coefficients that are far off."""
SAME = 1e-3
"""Singular value over the largest beneath which unknowns are one [-], such as run-outs and unbalance at one speed."""
LEAST_SEEN = 1e-6
"""Part of a column that the others must leave over for its unknown to be seen [-]."""


def best_chains(problem: FitProblem, theta: Floats, weight: Floats) -> Floats:
    """Estimate the gains and run-outs that runs with known unbalances show at given coefficients, and the excitations.

    Source: Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973) 413, doi:10.1137/0710036.

    Args:
        problem: The problem.
        theta: Fit coordinates θ (n,) [-].
        weight: Weights (S, m) [1/m].

    Returns:
        θ (n,) with them; channels that do not show them keep theirs [-].
    """
    return best_excitations(problem, _with_chains(problem, theta, weight), weight)


def _with_chains(problem: FitProblem, theta: Floats, weight: Floats) -> Floats:
    added, channels = problem.measurement.added, problem.coordinates.channels
    if added is None:
        return theta
    bare = replace(problem, measurement=replace(problem.measurement, added=None))
    train = problem.scaled_train(theta)
    each = excitation_responses(train, coefficients=problem.coordinates.coefficients(theta))
    known = problem.excitations(theta) - bare.excitations(theta)
    by_weight = np.einsum("esm,se->sm", each, np.stack([known.real, known.imag], axis=-1).reshape(len(known), -1))
    own = each[: 2 * added.shape[1]]
    turned = np.where(problem.measurement.direction > 0, 1.0, 0.0)
    found, weight = theta.copy(), np.where(problem.used, weight, 0.0)
    for channel in np.flatnonzero((channels.gain >= 0) & (channels.run_out >= 0)):
        shown: Complexes = np.column_stack([by_weight[:, channel], turned, 1.0 - turned, own[:, :, channel].T]).astype(complex)
        by = weight[:, channel]
        seen = _regression(np.asarray(shown * by[:, None]), np.asarray(problem.measurement.phasor[:, channel] * by))
        if seen is None or not SMALLEST <= abs(seen[0]) <= LARGEST:
            continue
        run_out = seen[1] if turned.any() else np.conj(seen[2])
        for first, value in ((channels.gain[channel], seen[0] - 1.0), (channels.run_out[channel], run_out)):
            found[first], found[first + 1] = value.real / channels.unit[first], value.imag / channels.unit[first]
    return found


def _regression(columns: Complexes, seen: Complexes) -> Complexes | None:
    """Return the unknowns (k,) of a linear regression; None where the first cannot be separated from the others."""
    size = np.linalg.norm(columns, axis=0)
    size[size == 0.0] = 1.0
    scaled = columns / size
    others = scaled[:, 1:] @ np.linalg.lstsq(scaled[:, 1:], scaled[:, 0], rcond=1e-9)[0]
    if np.linalg.norm(scaled[:, 0] - others) ** 2 <= LEAST_SEEN:
        return None
    return np.asarray(np.linalg.lstsq(scaled, seen, rcond=SAME)[0] / size)
