"""Influence coefficients as a machine's channels measure them: those of its model, through the channels' gains."""

from estimator.arrays import Complexes, Floats
from estimator.balancing.field_balancing import ModelInfluence
from estimator.balancing.model_balancing import influence_coefficients
from estimator.machine.document import Machine
from estimator.updated_model.fitted_response import fitted_gains
from estimator.updated_model.model import UpdatedModel


def measured_model_influence(
    model: UpdatedModel, machine: Machine, coordinates: tuple[str, ...], point: Floats
) -> ModelInfluence:
    """Build the function that gives what an identification's model makes the channels show per unbalance.

    The model is of the shaft's motion; trial runs show it through gains, those identified or those of the calibration.

    Args:
        model: The model.
        machine: The machine that was identified, with its probes.
        coordinates: Names of the identification's n coordinates.
        point: Values (n,) over the coordinates [SI, logarithms of direct terms].

    Returns:
        The function.

    Raises:
        ValueError: The identification is of another machine.
    """
    gains = fitted_gains(machine, coordinates, point)

    def influence(planes: tuple[str, ...], speed: Floats) -> Complexes:
        return influence_coefficients(model, planes=planes, speed=speed) * gains[None, :, None]

    return influence
