"""Response of the updated model to its excitations, at any linear combinations of its degrees of freedom, with slopes."""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.fit.problem.coordinates import Coordinates
from estimator.rotor.condensation import condense
from estimator.rotor.response import sensitivity
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.uncertainty import PhasorBand, phasor_band


@dataclass(frozen=True)
class ForcedResponse:
    """Phasors of m outputs at S speeds.

    Attributes:
        phasor: Phasors (S, m) [m].
        slope: Derivatives (S, m, n) of the phasors by the model's coordinates [m per unit of the coordinate].
        influence: Derivatives (S, m, 2E) by real and imaginary part of each excitation [m per unit of the excitation].
        coefficients: Coefficients (S, K) at these speeds [SI].
    """

    phasor: Complexes
    slope: Complexes
    influence: Complexes
    coefficients: Floats

    def band(self, model: UpdatedModel) -> PhasorBand:
        """Compute the uncertainty of the phasors.

        Args:
            model: The model that responded.

        Returns:
            Phasors with their bands (S, m) [m].
        """
        return phasor_band(self.phasor, self.slope, model.covariance)


def forced_response(
    model: UpdatedModel, *, speed: Floats, output: Floats | None = None, added: Complexes | None = None
) -> ForcedResponse:
    """Compute the response of a machine in its sense of rotation.

    Args:
        model: The updated model.
        speed: Speeds (S,) [rad/s], positive.
        output: Rows (m, N) over all degrees of freedom [-]; None for the probes.
        added: Excitations (E,) added to the identified ones, exactly known, such as correction masses [SI].

    Returns:
        The response.

    Raises:
        ValueError: A speed is not positive.
    """
    speed = np.asarray(speed, dtype=float)
    train = condense(model.machine, speed=speed, direction=np.full(speed.size, float(model.machine.direction)), output=output)
    coordinates = model.coordinates_at(speed)
    theta = coordinates.theta(model.values)
    coefficients = np.broadcast_to(coordinates.coefficients(theta), (speed.size, len(train.unknowns.coefficients)))
    excitations = coordinates.excitations(theta) + (0.0 if added is None else added)
    found = sensitivity(train.scaled(coordinates.scales(theta)), coefficients=coefficients, excitations=excitations)
    slope = np.zeros((coordinates.size, *found.phasor.shape), dtype=complex)
    # The probes' gains, which the coordinates' own slopes deal with, are none of the shaft's motion.
    for k, places in coefficient_slopes(coordinates, theta, coefficients).items():
        for place, by_coordinate in places.items():
            slope[place] += found.by_coefficient[k] * by_coordinate[:, None]
    for number, first in enumerate(coordinates.excitation_place):
        if first >= 0:
            slope[first : first + 2] = found.by_excitation[2 * number : 2 * number + 2]
    slope[coordinates.scale_place] = found.by_scale
    return ForcedResponse(
        phasor=found.phasor,
        slope=np.moveaxis(slope, 0, -1),
        influence=np.moveaxis(found.by_excitation, 0, -1),
        coefficients=coefficients,
    )


def coefficient_slopes(coordinates: Coordinates, theta: Floats, coefficients: Floats) -> dict[int, dict[int, Floats]]:
    """Compute the derivatives of the coefficients by the coordinates, as values in SI or logarithms.

    Args:
        coordinates: Coordinates of the fit.
        theta: Fit coordinates θ (n,) [-].
        coefficients: Coefficients (S, K) [SI].

    Returns:
        By index of coefficient and of coordinate, the derivative (S,) of the one by the other [SI].
    """
    slopes: dict[int, dict[int, Floats]] = {}
    for k, logarithmic in enumerate(coordinates.logarithmic):
        if coordinates.place[k] >= 0:
            slopes[k] = {int(coordinates.place[k]): coefficients[:, k] if logarithmic else np.ones(len(coefficients))}
    for one in coordinates.models:
        by_coordinate = one.derivatives(theta, slice(None)) / coordinates.unit[one.numbers]
        for c, k in enumerate(one.coefficients):
            slopes[k] = {place: by_coordinate[:, c, p] for p, place in enumerate(one.numbers.tolist())}
    return slopes
