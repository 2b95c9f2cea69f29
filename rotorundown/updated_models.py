"""Makes the model of a result or of a document."""

from estimator.machine.document import Machine
from estimator.updated_model.model import documented_model
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
        WrongMachine: The machine is a copy that contradicts itself.
        ValueError: The document does not say enough to expect anything.
    """
    if isinstance(source, Machine):
        return Model(documented_model(checked_machine(source)))
    require_result(source, "the source")
    return source.model
