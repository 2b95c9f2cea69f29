"""Says what a model's values come from, as each of its results prints it."""

import numpy as np

from estimator.errors import Invalid
from estimator.updated_model.model import UpdatedModel

NOMINAL = "Nominal: as the document alone expects, without intervals"


class UnbalanceUnknown(Invalid):
    """Raised for what follows from unbalances, where none is known."""


def origin_notes(model: UpdatedModel) -> tuple[str, ...]:
    """Return notes on a model that nothing was measured of."""
    return (NOMINAL,) if is_nominal(model) else ()


def require_unbalance(model: UpdatedModel) -> None:
    """Require that something moves the machine. Raises UnbalanceUnknown: no vibration would be told for one not known."""
    if not np.any(model.excitations):
        raise UnbalanceUnknown(
            f"of '{model.machine.id}' no unbalance is known: identify a run first, or state each disc's in the document"
        )


def is_nominal(model: UpdatedModel) -> bool:
    """Return whether nothing of a model is identified or calibrated, so that it has no intervals."""
    return not np.any(model.covariance)
