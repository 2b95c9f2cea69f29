"""Makes the model of a result or of a document."""

import cmath
import math

from msgspec.structs import replace

from estimator.machine.document import Machine
from estimator.updated_model.model import UpdatedModel, documented_model
from rotorundown.machine_files import checked_machine
from rotorundown.machine_model import Model
from rotorundown.result import Result, require_result


def model(source: Result | Machine) -> Model:
    """Return the model of a result, or the one that a document tells: calibrated, or expected before anything is measured.

    Args:
        source: The result of an identification, or a machine.

    Returns:
        The model.

    Raises:
        NotIdentified: The source is neither.
        NotAccepted: The fit is not accepted.
        WrongMachine: The machine is a copy that contradicts itself.
        ValueError: The document does not say enough to expect anything.
    """
    if isinstance(source, Machine):
        return Model(_with_stated_unbalances(documented_model(checked_machine(source))))
    require_result(source, "the source")
    return source.model


def _with_stated_unbalances(model: UpdatedModel) -> UpdatedModel:
    """Return a document's model with the residual unbalances that it states, where no calibration has found them."""
    machine, values = model.machine, model.values.copy()
    found = () if machine.calibration is None else machine.calibration.parameters
    for disc in machine.discs:
        if disc.unbalance is not None:
            vector = cmath.rect(disc.unbalance.magnitude, math.radians(disc.unbalance.angle_deg))
            for part, value in (("real", vector.real), ("imaginary", vector.imag)):
                name = f"disc.{disc.id}.unbalance.{part}"
                if name not in found:
                    values[model.coordinates.index(name)] = value
    return replace(model, values=values)
