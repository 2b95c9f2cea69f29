"""An identification of the machine of `tests.plant`, with values near its document's, as a stored model needs it."""

import math
from typing import Any

import numpy as np

from estimator.fit.problem.coordinates import Coordinates
from estimator.machine.rules import Noise
from estimator.rotor.condensation import condense
from estimator.units import rpm_to_rad_per_s
from tests.plant import identification, machine

NOISE = Noise(relative=0.02, floor=2e-7)
COUNT = 80
MAXIMUM_RPM = 4500.0
"""Critical speeds are looked for up to a quarter above it: there are some."""
MODEL = ("critical-speeds", "campbell", "modes", "misalignment-force", "balancing")
LEFT_OUT = (7, 2)
"""A sample and channel that the source calls bad."""


def values(*, stiffer: float = 1.0) -> tuple[tuple[str, ...], np.ndarray, np.ndarray]:
    """Coordinates of the machine, values near the document's, and a covariance; the coupling stiffer by a factor."""
    train = condense(machine(), speed=np.ones(1), direction=np.ones(1))
    coordinates = Coordinates.of(train, unbalance_scale=1.0)
    theta = np.zeros(coordinates.size)
    first = coordinates.names.index("disc.D1.unbalance.real")
    theta[first : first + 4] = (8e-4, 5e-4, -1e-3, 1.5e-3)
    theta[coordinates.names.index("coupling.C1.kxx")] = math.log(stiffer)
    size = np.where(np.char.find(coordinates.names, "unbalance") >= 0, 1e-5, 0.01 * coordinates.unit)
    half = np.diag(size) @ np.linalg.cholesky(0.9 * np.eye(coordinates.size) + 0.1)
    return coordinates.names, coordinates.point(theta), half @ half.T


def outcome(**how: Any) -> Any:
    names, point, covariance = values(**how)
    return identification(
        coordinates=names,
        point=point,
        covariance=covariance,
        noise=NOISE,
        speed_minimum=rpm_to_rad_per_s(400.0),
        speed_maximum=rpm_to_rad_per_s(2900.0),
    )
