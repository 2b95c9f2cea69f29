"""Says what a model's values come from, as each of its results prints it."""

import numpy as np

from estimator.updated_model.model import UpdatedModel

NOMINAL = "Nominal: as the document alone expects, without intervals"
UNMOVED = "Without any unbalance, which the document does not state: identify a run first"


def origin_notes(model: UpdatedModel, *, forced: bool = False) -> tuple[str, ...]:
    """Return notes on a model that nothing was measured of. forced: whether the result follows from unbalances."""
    nominal = (NOMINAL,) if is_nominal(model) else ()
    return (*nominal, UNMOVED) if forced and not np.any(model.excitations) else nominal


def is_nominal(model: UpdatedModel) -> bool:
    """Return whether nothing of a model is identified or calibrated, so that it has no intervals."""
    return not np.any(model.covariance)
