"""Derivatives of a train's phasors by the coordinates of a fit."""

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.fit.problem.coordinates import Coordinates
from estimator.rotor.response import Sensitivity


def phasor_jacobian(
    coordinates: Coordinates, theta: Floats, found: Sensitivity, *, coefficients: Floats, direction: Floats, block: slice
) -> Complexes:
    """Compute ∂ phasor/∂θ at some of the speeds, from the derivatives by physical parameters there.

    Args:
        coordinates: Coordinates of the fit.
        theta: Fit coordinates θ (n,) [-].
        found: Phasors and their derivatives at the S speeds of the block.
        coefficients: Coefficients at θ, (K,) or at all speeds of the train (all, K) [SI].
        direction: Sense of rotation (S,), +1 or -1 [-].
        block: The speeds, among all of the train.

    Returns:
        Derivatives (n, S, m) [m].
    """
    whole = np.zeros((coordinates.size, *found.phasor.shape), dtype=complex)
    _add_coefficients(whole, coordinates, theta, found, coefficients, block)
    for column in np.flatnonzero(coordinates.excitation_place >= 0):
        first = coordinates.excitation_place[column]
        whole[first : first + 2] = coordinates.excitation_scale[column] * found.by_excitation[2 * column : 2 * column + 2]
    whole[coordinates.scale_place] = found.by_scale
    gains = coordinates.channels.gains(theta)
    if not np.all(gains == 1.0):
        whole *= gains
    coordinates.channels.add_derivatives(whole, found.phasor, direction)
    return whole


def _add_coefficients(
    whole: Complexes, coordinates: Coordinates, theta: Floats, found: Sensitivity, coefficients: Floats, block: slice
) -> None:
    slope = np.where(coordinates.logarithmic, coefficients, coordinates.scale)
    slope = slope[:, None, None] if slope.ndim == 1 else slope[block].T[:, :, None]
    by_coefficient = found.by_coefficient * slope
    for k in np.flatnonzero(coordinates.place >= 0).tolist():
        whole[coordinates.place[k]] += by_coefficient[k]  # tied coefficients share a coordinate
    coordinates.following.add_derivatives(whole, theta, block, found.by_coefficient)
