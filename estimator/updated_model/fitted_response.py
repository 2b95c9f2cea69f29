"""Response that an identification predicts for each channel: the updated model's, through gains and with run-out."""

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.fit.problem.channel_errors import UNIT_SPREAD, with_channel_errors
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.phasor_jacobian import phasor_jacobian
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from estimator.rotor.condensation import CondensedTrain, condense
from estimator.rotor.response import sensitivity
from estimator.updated_model.uncertainty import PhasorBand, phasor_band


def fitted_gains(machine: Machine, coordinates: tuple[str, ...], point: Floats) -> Complexes:
    """Compute the gains of the channels of a fit, measured over true.

    Source: own derivation: a gain is 1 plus the fit's coordinates of it.

    Args:
        machine: The machine, with m probes.
        coordinates: Names of the identification's n coordinates.
        point: Values (n,) over the coordinates, as in `Identification` [SI, logarithms of direct terms].

    Returns:
        Gains (m,) [-]; 1 for a channel of which the identification has none.

    Raises:
        ValueError: The identification is of another machine.
    """
    own = _of(condense(machine, speed=np.ones(1), direction=np.ones(1)), coordinates)
    return own.channels.gains(_theta(machine, own, coordinates, point))


def fitted_response(
    machine: Machine, coordinates: tuple[str, ...], point: Floats, covariance: Floats, *, speed: Floats, direction: Floats
) -> PhasorBand:
    """Compute the phasors of a fit with their 95 % bands.

    A channel of which the identification has no gain or run-out is taken as exact.

    Args:
        machine: The machine, with m probes.
        coordinates: Names of the identification's n coordinates.
        point: Values (n,) over the coordinates, as in `Identification` [SI, logarithms of direct terms].
        covariance: Covariance (n, n) of the coordinates [SI²].
        speed: Speeds (S,) [rad/s].
        direction: Sense of rotation (S,), +1 or -1 [-].

    Returns:
        Phasors (S, m) [m].

    Raises:
        ValueError: The identification is of another machine.
    """
    train = condense(machine, speed=speed, direction=direction)
    own = _of(train, coordinates)
    theta = _theta(machine, own, coordinates, point)
    known, rows = _known(own, coordinates)
    coefficients, direction = own.coefficients(theta), np.asarray(direction, dtype=float)
    run_out, inner = own.channels.run_outs(theta), covariance[np.ix_(rows, rows)]
    scaled = train.scaled(own.scales(theta))

    def band(block: slice) -> PhasorBand:
        here = coefficients if coefficients.ndim == 1 else coefficients[block]
        found = sensitivity(scaled.pick(block), coefficients=here, excitations=own.excitations(theta))
        by_theta = phasor_jacobian(own, theta, found, coefficients=coefficients, direction=direction[block], block=block)
        turned = np.where(direction[block, None] > 0, run_out, np.conj(run_out))
        slope = np.moveaxis(by_theta[known] / own.unit[known, None, None], 0, -1)
        return phasor_band(own.channels.gains(theta) * found.phasor + turned, slope, inner)

    return PhasorBand.joined([band(block) for block in train.blocks()])


def _of(train: CondensedTrain, coordinates: tuple[str, ...]) -> Coordinates:
    """Return the coordinates of a train, with those errors of its channels behind them that an identification has besides."""
    own = Coordinates.of(train, unbalance_scale=1.0)
    besides = {describe(name).whole for name in coordinates if name not in own.names}
    errors = [
        (quantity, place)
        for place, channel in enumerate(train.channels)
        for quantity in UNIT_SPREAD
        if f"probe.{channel}.{quantity}" in besides
    ]
    return with_channel_errors(own, train.channels, errors, spread=UNIT_SPREAD) if errors else own


def _theta(machine: Machine, own: Coordinates, coordinates: tuple[str, ...], point: Floats) -> Floats:
    """Return the fit coordinates (N,) of a machine at an identification's values. Raises ValueError for another machine's."""
    missing = [name for name in own.names if name not in coordinates and describe(name).element_kind != "probe"]
    if missing:
        raise ValueError(f"the identification is not of machine '{machine.id}': it lacks {', '.join(missing)}")
    known, rows = _known(own, coordinates)
    theta = np.zeros(own.size)
    values = own.origin.copy()
    values[known] = point[rows]
    theta[known] = own.theta(values)[known]
    return theta


def _known(own: Coordinates, coordinates: tuple[str, ...]) -> tuple[NDArray[np.bool_], list[int]]:
    """Return which of a machine's coordinates (N,) an identification has, and their places in it."""
    known = np.array([name in coordinates for name in own.names], dtype=bool)
    return known, [coordinates.index(name) for name in own.names if name in coordinates]
