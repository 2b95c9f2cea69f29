"""Bearing models of a train's coefficients, and what is believed of a coefficient before any measurement."""

from collections.abc import Sequence
from math import log

import numpy as np
from msgspec import Struct

from estimator.arrays import Floats
from estimator.bearings.model import CoefficientModel, ModelParameter
from estimator.rotor.parameters import Coefficient

KNOWN_SPREAD = log(10.0)
"""Prior standard deviation of the logarithm of a direct term whose nominal value the document gives [-]: a factor of 10."""
UNKNOWN_SPREAD = log(1000.0)
"""Prior standard deviation of the logarithm of a direct term whose nominal value no document gives [-]: a factor of 1000."""
CROSS_SPREAD = 10.0
"""Prior standard deviation of a cross-coupled term in units of its element's direct terms [-]."""


class GoverningModel(Struct, frozen=True):
    """A model with the coefficients of a train that it gives.

    Attributes:
        model: The model.
        coefficients: Indices of its C coefficients.
    """

    model: CoefficientModel
    coefficients: tuple[int, ...]


def governing_models(coefficients: Sequence[Coefficient]) -> tuple[GoverningModel, ...]:
    """Return the models of all coefficients that are neither fixed nor tied.

    Args:
        coefficients: The train's coefficients.

    Returns:
        The models, in the order of the first coefficient that each gives.
    """
    groups: dict[tuple[str, int], list[Coefficient]] = {}
    for one in coefficients:
        if not one.fixed and one.tied_to is None:
            groups.setdefault((one.element, id(one.form)), []).append(one)
    index = {one.name: k for k, one in enumerate(coefficients)}
    found = [
        GoverningModel(model, tuple(index[name] for name in model.coefficients))
        for group in groups.values()
        for model in group[0].form.models([prior_parameter(one) for one in group])
    ]
    return tuple(sorted(found, key=lambda one: min(one.coefficients)))


def prior_parameter(coefficient: Coefficient) -> ModelParameter:
    """Return a coefficient as a parameter of its own, with the prior on it.

    Args:
        coefficient: The coefficient.

    Returns:
        The parameter.
    """
    return ModelParameter(
        name=coefficient.name,
        quantity=coefficient.quantity,
        unit=coefficient.unit,
        positive=coefficient.direct,
        expected=coefficient.expected,
        scale=coefficient.scale,
        spread=_spread(coefficient),
        coefficient=coefficient.name,
    )


def expected_coefficients(coefficients: Sequence[Coefficient], speed: Floats) -> Floats:
    """Return what is expected of all coefficients of a train at some speeds before any measurement.

    Args:
        coefficients: The train's K coefficients.
        speed: Spin speeds (S,), without sign [rad/s].

    Returns:
        Coefficients (S, K) [SI].
    """
    found = np.tile([one.expected for one in coefficients], (speed.size, 1)).astype(float)
    for one in governing_models(coefficients):
        if expects_a_law(one.model):
            centre = np.array([parameter.centre for parameter in one.model.parameters])
            found[:, one.coefficients] = one.model.at(speed).values(centre)
    index = {one.name: k for k, one in enumerate(coefficients)}
    for k, tied in enumerate(coefficients):
        if tied.tied_to is not None:
            found[:, k] = found[:, index[tied.tied_to]]
    return found


def expects_a_law(model: CoefficientModel) -> bool:
    """Return whether a model expects its coefficients to follow the speed in a certain way before any measurement.

    A model whose parameters are coefficients' values expects the same everywhere.

    Args:
        model: The model.

    Returns:
        Whether it does.
    """
    return all(parameter.coefficient is None for parameter in model.parameters)


def _spread(coefficient: Coefficient) -> float:
    if coefficient.spread is not None:
        # A part of nothing is no spread: a cross-coupled term of zero is measured by the direct terms beside it.
        part = 1.0 if coefficient.direct else abs(coefficient.expected) / coefficient.scale or 1.0
        return coefficient.spread * part
    if not coefficient.direct:
        return CROSS_SPREAD
    return UNKNOWN_SPREAD if coefficient.nominal is None else KNOWN_SPREAD
