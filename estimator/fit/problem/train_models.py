"""Models of a train's coefficients: those of its elements one by one, and that of all its bearings together."""

from importlib import import_module
from typing import Any

from estimator.bearings.model import CoefficientModel, WholeTrain
from estimator.machine.document import Machine
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
    declared = next((one.form.whole_train for one in coefficients if one.form.whole_train is not None), None)
    if train.machine is None or declared is None:
        return found
    index = {one.name: k for k, one in enumerate(coefficients)}
    model = whole_train_model(train.machine, declared)
    of_bearings = GoverningModel(model, tuple(index[name] for name in model.coefficients))
    return tuple(sorted((*found, of_bearings), key=lambda one: min(one.coefficients)))


def whole_train_model(machine: Machine, declared: WholeTrain) -> CoefficientModel:
    """Make the one model of the coefficients of all bearings of a machine.

    Args:
        machine: The machine.
        declared: What the bearings' form declares.

    Returns:
        The model.
    """
    module, _, function = declared.model.partition(":")
    make: Any = getattr(import_module(module), function)
    model: CoefficientModel = make(machine)
    return model
