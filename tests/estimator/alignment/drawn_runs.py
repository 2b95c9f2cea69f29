"""Runs of a motor and compressor on oil films as a linear model draws them: each measures some numbers of the truth."""

import numpy as np
from msgspec.structs import replace

from estimator.alignment.healthy_films import coordinate_scales, machine_spread
from estimator.arrays import Floats
from estimator.machine.alignment_rules import HealthyVariation
from estimator.machine.parameter_description import describe
from estimator.updated_model.model import UpdatedModel, expected_model
from tests.estimator.updated_model.test_alignment_results import machine_of

MODEL = expected_model(machine_of())
COORDINATES = MODEL.coordinates_at(np.ones(1))
ROWS = 400
"""Numbers that each run measures."""
UNBALANCED = np.array([describe(name).quantity == "unbalance" for name in COORDINATES.names])
SCALE = np.where(UNBALANCED, 1e-5, COORDINATES.spread)
"""Sizes of the coordinates [-]."""


def drawn_machine(rng: np.random.Generator) -> Floats:
    """Coordinates of a machine, drawn as they are believed: without what varies from run to run."""
    return COORDINATES.centre + np.where(UNBALANCED, 1e-3, machine_spread(COORDINATES) * rng.standard_normal(SCALE.size))


def drawn_run(machine: Floats, variation: HealthyVariation, rng: np.random.Generator) -> Floats:
    """Coordinates of one run of it."""
    scales = coordinate_scales(COORDINATES, COORDINATES.point(machine))
    warmer = variation.oil * rng.standard_normal() * scales.oil
    return machine + warmer + scales.own(variation) * rng.standard_normal(machine.size)


def fitted(theta: Floats, rng: np.random.Generator, *, rows: int = ROWS, sharpness: float = 40.0) -> UpdatedModel:
    """The model that a run leads to which measures numbers of random directions with errors of one."""
    seen = sharpness * rng.standard_normal((rows, theta.size)) / SCALE / np.sqrt(theta.size)
    prior, away = np.diag(COORDINATES.spread**-2), theta - COORDINATES.centre
    covariance = np.linalg.inv(seen.T @ seen + prior)
    found = covariance @ seen.T @ (seen @ away + rng.standard_normal(rows))
    unit = COORDINATES.unit
    return replace(MODEL, values=COORDINATES.point(COORDINATES.centre + found), covariance=covariance * np.outer(unit, unit))


def place(name: str) -> int:
    """Place of a coordinate by its name."""
    return COORDINATES.names.index(name)
