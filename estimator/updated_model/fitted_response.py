"""Response that an identification predicts for each channel: the updated model's, through gains and with run-out."""

import numpy as np

from estimator.arrays import Floats
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.phasor_jacobian import phasor_jacobian
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from estimator.rotor.condensation import condense
from estimator.rotor.response import sensitivity
from estimator.updated_model.uncertainty import PhasorBand, phasor_band


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
    own = Coordinates.of(train, unbalance_scale=1.0)
    missing = [name for name in own.names if name not in coordinates and describe(name).element_kind != "probe"]
    if missing:
        raise ValueError(f"the identification is not of machine '{machine.id}': it lacks {', '.join(missing)}")
    known = np.array([name in coordinates for name in own.names], dtype=bool)
    rows = [coordinates.index(name) for name in own.names if name in coordinates]
    theta = np.zeros(own.size)
    values = own.origin.copy()
    values[known] = point[rows]
    theta[known] = own.theta(values)[known]
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
