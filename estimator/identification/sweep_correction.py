"""Effect of a sweep's rate on the 1× phasors that an identified model predicts: what must not be blamed on the machine."""

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.phasors.sweep_transient import SweepTransient, SweptTrain, sweep_transient
from estimator.updated_model.model import UpdatedModel


def predicted_transient(model: UpdatedModel, *, time: Floats, speed: Floats, added: Complexes | None = None) -> SweepTransient:
    """Predict the deviations of phasors from the steady state for a sweep in the machine's sense of rotation.

    Args:
        model: The updated model.
        time: Times (S,), ascending [s].
        speed: Speeds (S,), as measured [rad/s].
        added: Known unbalances (P,) beside the model's own, such as a trial weight [kg m]; None for none.

    Returns:
        Deviations at S samples and m probes.
    """
    excitations = model.excitations.copy()
    if added is not None:
        excitations[: added.size] += added
    follows = bool(model.coordinates_at(speed).models)
    train = SweptTrain(model.scaled_machine, model.coefficients, follows, np.asarray(excitations))
    return sweep_transient(train, time=time, speed=speed)
