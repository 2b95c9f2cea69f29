"""Makes the model of a result or of a document."""

from estimator.machine.document import Machine
from estimator.updated_model.model import expected_model
from rotorundown.machine_model import Model
from rotorundown.result import Result


def model(source: Result | Machine) -> Model:
    """Return the model of a result, or the one that a document expects before anything is measured."""
    return source.model if isinstance(source, Result) else Model(expected_model(source))
