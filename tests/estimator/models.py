"""Updated models for tests: true values with a covariance as an identification might state it, and draws from it."""

import numpy as np
from numpy.typing import NDArray
from trains import truth

from estimator.condensation import condense
from estimator.machine import Machine
from estimator.updated_model import UpdatedModel

Floats = NDArray[np.float64]


def model_of(machine: Machine, *, error: float = 0.02, seed: int = 1) -> UpdatedModel:
    """The nominal machine with correlated errors: direct terms by `error`, everything else by that part of the largest."""
    coefficients, unbalances = truth(machine)
    unknown = condense(machine, speed=np.array([1.0]), direction=np.array([1.0])).unknowns
    largest: dict[str, float] = {}
    for value, one in zip(coefficients, unknown.coefficients, strict=True):
        largest[one.quantity] = max(largest.get(one.quantity, 0.0), abs(value))
    size = [1.0 if one.direct else largest[one.quantity] for one in unknown.coefficients]
    size += [float(np.abs(unbalances).max())] * (2 * unbalances.size)
    rng = np.random.default_rng(seed)
    mixture = rng.standard_normal((len(size), len(size)))
    correlation = np.eye(len(size)) + mixture @ mixture.T / len(size)
    correlation /= np.sqrt(np.outer(np.diag(correlation), np.diag(correlation)))
    scale = error * np.array(size)
    covariance = correlation * np.outer(scale, scale)
    return UpdatedModel.of(machine, coefficients=coefficients, unbalances=unbalances, covariance=covariance)


def draws(model: UpdatedModel, count: int, *, seed: int = 2) -> list[tuple[Floats, NDArray[np.complex128]]]:
    """Coefficients and unbalances drawn from the model's covariance: direct terms log-normal, everything else normal."""
    rng = np.random.default_rng(seed)
    root = np.linalg.cholesky(model.covariance)
    coordinates = model.coordinates_at(np.ones(1))
    result = []
    for _ in range(count):
        theta = (model.values + root @ rng.standard_normal(root.shape[0])) / coordinates.unit
        result.append((coordinates.coefficients(theta), coordinates.excitations(theta)))
    return result
