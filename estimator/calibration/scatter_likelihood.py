"""Slope of the part of a calibration's likelihood that tells how large differences between mountings may appear.

At given coordinates the phasors of a mounting are Gaussian: their covariance is that of noise with what differences of the
discs do through the train and the chains. Its determinant grows with gains and receptances. χ² alone is least where gains are
too large: differences then count for less, and trial weights seem smaller than they are. That is inverse regression, whose
gains err by the square of the ratio of differences to weights (Fuller, Measurement Error Models, 1987, sec. 1.1). The
likelihood of the mixed model has the logarithm of the determinant beside χ² (Harville, J. Am. Stat. Assoc. 72 (1977) 320,
doi:10.1080/01621459.1977.10480998). What differences do says nothing of a factor on all gains, either: their sizes are free.
"""

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.calibration.determinant_bound import DeterminantBound
from estimator.calibration.like_sizes import STATED_WEIGHT
from estimator.calibration.mounted_problem import MountedProblem
from estimator.fit.problem.phasor_jacobian import phasor_jacobian
from estimator.rotor.response import sensitivity


def with_scatter_bound(problem: MountedProblem, theta: Floats, *, stated_square: float) -> MountedProblem:
    """Return a problem whose χ² has the determinant's logarithm beside it, as a bound that touches it at θ.

    The sizes of scatter rest on as much of the differences as the coordinates leave over (restricted likelihood). The
    determinant counts by the same part: so receptances and sizes that change together leave the likelihood as it is. What the
    stated eccentricity adds to the size is taken off: a guess of how much mountings differ tells nothing of gains.

    Source: Harville, J. Am. Stat. Assoc. 72 (1977) 320, doi:10.1080/01621459.1977.10480998.

    Args:
        problem: The problem.
        theta: Fit coordinates θ (n,) [-].
        stated_square: Square of the eccentricity stated beforehand over that of the problem [-].

    Returns:
        The problem; where its descent ends at θ, the likelihood has its maximum there.
    """
    part = _part_shown(problem, theta, stated_square)
    slope = part * scatter_slope(problem, theta)
    return replace(problem, bound=DeterminantBound.through(theta, slope, problem.coordinates.channels))


def scatter_slope(problem: MountedProblem, theta: Floats) -> Floats:
    """Compute the derivative of the logarithm of the covariance's determinant, summed over the mountings.

    Source: derivative of a determinant (Jacobi); Harville, J. Am. Stat. Assoc. 72 (1977) 320,
    doi:10.1080/01621459.1977.10480998.

    Args:
        problem: The problem.
        theta: Fit coordinates θ (n,) [-].

    Returns:
        Derivative (n,) by the coordinates [-].
    """
    weight = np.where(problem.used, problem.weight(np.abs(problem.measurement.phasor), 0.0), 0.0)
    here = problem.linearisation(theta, weight)
    solved = np.empty_like(here.own)
    for one, inverse in enumerate(here.inverse):
        which = here.mounting == one
        solved[:, which] = inverse @ here.own[:, which]
    parts = solved.reshape(len(solved), *weight.shape, 2)
    slope = np.zeros(theta.size)
    for row in range(2 * problem.planes):
        slope += _slope_of_difference(problem, theta, row, (parts[row, ..., 0] + 1j * parts[row, ..., 1]) * weight)
    slope[_added_places(problem)] = 0.0
    return 2.0 * slope


def information_of_means(problem: MountedProblem, theta: Floats) -> Floats:
    """Compute the information of the coordinates, without that of the differences that are likely there.

    The curvature of χ² counts differences as if they were known unbalances. But larger gains with smaller differences, or
    turned ones with differences turned back, leave the likelihood of these as it is: only the means tell such gains.

    Source: expected information of the mean's parameters, Mardia and Marshall, Biometrika 71 (1984) 135,
    doi:10.1093/biomet/71.1.135.

    Args:
        problem: The problem, with sizes of scatter that were estimated.
        theta: Fit coordinates θ (n,) [-].

    Returns:
        Information (n, n) of the phasors [-].
    """
    weight = np.where(problem.used, problem.weight(np.abs(problem.measurement.phasor), 0.0), 0.0)
    found = problem.linearisation(theta, weight)
    means = [one.weighted(problem.measurement.phasor, weight)[0] for one in problem.linear_phasors(theta)]
    rows = np.concatenate(means, axis=-1)
    information = rows @ rows.T
    for one, inverse in enumerate(found.inverse):
        which = found.mounting == one
        mixed = rows[:, which] @ found.own[:, which].T
        information -= mixed @ inverse @ mixed.T
    return np.asarray(information)


def _slope_of_difference(problem: MountedProblem, theta: Floats, row: int, onto: Complexes) -> Floats:
    """Return the derivative (n,) of what a part of one disc's difference does, projected onto phasors (S, m) [1/m]."""
    train, coefficients = problem.scaled_train(theta), problem.coordinates.coefficients(theta)
    unit = np.zeros(len(train.unknowns.excitations), dtype=complex)
    disc, imaginary = divmod(row, 2)
    unit[disc] = problem.spread[disc] / np.sqrt(2.0) * (1j if imaginary else 1.0)
    slope = np.zeros(theta.size)
    for block in train.blocks():
        found = sensitivity(
            train.pick(block),
            coefficients=coefficients if coefficients.ndim == 1 else coefficients[block],
            excitations=unit,
        )
        direction = problem.measurement.direction[block]
        by = phasor_jacobian(problem.coordinates, theta, found, coefficients=coefficients, direction=direction, block=block)
        slope += np.einsum("nsm,sm->n", by.real, onto[block].real) + np.einsum("nsm,sm->n", by.imag, onto[block].imag)
    return slope


def _added_places(problem: MountedProblem) -> NDArray[np.intp]:
    """Return the coordinates that add to phasors: what differences do does not depend on them."""
    coordinates = problem.coordinates
    first = np.concatenate([coordinates.excitation_place, coordinates.channels.run_out])
    first = first[first >= 0]
    return np.concatenate([first, first + 1])


def _part_shown(problem: MountedProblem, theta: Floats, stated_square: float) -> float:
    """Return the part of what phasors tell of the discs' differences that these show in squares of their size [-].

    It is what the coordinates have not used up, with what the stated size counts for taken off.
    """
    found = problem.linearisation(theta, problem.weight(np.abs(problem.measurement.phasor), 0.0))
    covariance = np.linalg.inv(found.rows @ found.rows.T - found.explained() + problem.coordinates.prior.precision)
    across = np.einsum("mqp,mnp->mqn", found.inverse, found.mixed)
    discs = slice(0, 2 * problem.planes)
    told = np.sum(1.0 - np.einsum("mqq->mq", found.inverse)[:, discs])
    used = np.sum(np.einsum("mqn,nk,mqk->mq", across, covariance, across, optimize=True)[:, discs])
    of_stated = 2.0 * STATED_WEIGHT * (stated_square - 1.0)
    return float(np.clip(1.0 - (used + of_stated) / told, 0.0, 1.0)) if told > 0.0 else 0.0
