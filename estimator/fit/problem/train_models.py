"""Models of a train's coefficients: those of its elements one by one, and that of all its oil films together."""

from estimator.rotor.coefficient_models import GoverningModel, governing_models
from estimator.rotor.condensation import CondensedTrain


def train_models(train: CondensedTrain) -> tuple[GoverningModel, ...]:
    """Return the models of all coefficients that are neither fixed nor tied.

    Args:
        train: The condensed train.

    Returns:
        The models, in the order of the first coefficient that each gives.
    """
    coefficients = train.unknowns.coefficients
    found = governing_models(coefficients)
    if train.machine is None or not any(one.form.of_whole_train for one in coefficients):
        return found
    from estimator.statics.film_model import film_model  # films take as long to load as all of a fit without them

    index = {one.name: k for k, one in enumerate(coefficients)}
    model = film_model(train.machine)
    films = GoverningModel(model, tuple(index[name] for name in model.coefficients))
    return tuple(sorted((*found, films), key=lambda one: min(one.coefficients)))
