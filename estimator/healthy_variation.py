"""How much a machine's parameters differ from run to run, and over the seasons, while nothing is wrong with it.

Load and temperature are never quite the same, so that a deviation must be judged against more than the fit's own error. The
variation is the sum of what is each coefficient's own, what all of an element share (a bearing's oil, a coupling's
temperature), and what all stiffnesses of the machine share (the season).
"""

from collections.abc import Sequence

import numpy as np

from estimator.condensation import Floats
from estimator.observation import Observation
from estimator.parameters import Coefficient, Quantity, Unknowns

OWN: dict[Quantity, float] = {
    "stiffness": 0.01,
    "angular stiffness": 0.01,
    "coupled stiffness": 0.01,
    "inertia": 0.01,
    "damping": 0.05,
    "angular damping": 0.05,
}
"""Run-to-run standard deviation of each coefficient, relative; of a cross-coupled one to its element's direct terms."""
SHARED: dict[Quantity, float] = {
    "stiffness": 0.02,
    "angular stiffness": 0.02,
    "coupled stiffness": 0.02,
    "damping": 0.03,
    "angular damping": 0.03,
}
"""Standard deviation of what the direct terms of one element share, between any two times of the year."""
SEASON = 0.02
"""Standard deviation of what all direct stiffnesses of the machine share."""
UNBALANCE = 0.03
"""Of an unbalance, relative to its size, each way …"""
UNBALANCE_FLOOR = 0.01
"""… and relative to the machine's largest."""
SCALE_FACTOR = 5e-4
"""Of E and density: the steel stays the same."""
GAIN = 0.005
"""Of a channel's gain."""
RUN_OUT = 0.005
"""Of a run-out, relative to the channel's median amplitude."""
OTHER = 0.05
"""Of bows, forces and moments, relative to their size."""


def run_variation(unknowns: Unknowns, names: Sequence[str], typical: Observation) -> Floats:
    """Run-to-run standard deviations (N,) of the quantities that `names` lists, each by itself.

    typical: an observation of the healthy machine, for the sizes of its unbalances and amplitudes.
    """
    return np.array([_own(unknowns, name, typical) for name in names])


def slow_variation(unknowns: Unknowns, names: Sequence[str]) -> Floats:
    """Covariance (N, N) of what differs between two times of the year, and is alike in runs that follow each other."""
    coefficients = {one.name: one for one in unknowns.coefficients if one.direct}
    direct = [coefficients.get(name.partition("@")[0]) for name in names]
    shared = np.array([0.0 if one is None else SHARED.get(one.quantity, 0.0) for one in direct])
    groups = [None if one is None else (one.element, "damping" in one.quantity) for one in direct]
    stiff = SEASON * np.array([one is not None and "stiffness" in one.quantity for one in direct])
    covariance = np.outer(stiff, stiff)
    for group in dict.fromkeys(one for one in groups if one is not None):
        column = shared * np.array([one == group for one in groups])
        covariance += np.outer(column, column)
    return np.asarray(covariance)


def _own(unknowns: Unknowns, name: str, typical: Observation) -> float:
    coefficient = next((one for one in unknowns.coefficients if one.name == name.partition("@")[0]), None)
    if coefficient is not None:
        return _of_coefficient(coefficient)
    whole, _, part = name.rpartition(".")
    if part not in ("real", "imaginary"):
        return SCALE_FACTOR
    kind, channel = whole.rpartition(".")[2], whole.split(".")[1]
    if kind == "gain":
        return GAIN
    if kind == "run_out":
        return RUN_OUT * typical.amplitude.get(channel, 0.0) or RUN_OUT * _largest_amplitude(typical)
    size = complex_size(typical, whole)
    if kind == "unbalance":
        planes = [complex_size(typical, one.name) for one in unknowns.unbalances]
        return UNBALANCE * size + UNBALANCE_FLOOR * max(planes)
    return OTHER * size or 1.0


def complex_size(typical: Observation, name: str) -> float:
    """Magnitude of a complex quantity."""
    real, imaginary = (typical.reference[typical.names.index(f"{name}.{part}")] for part in ("real", "imaginary"))
    return float(np.hypot(real, imaginary))


def _of_coefficient(one: Coefficient) -> float:
    return OWN[one.quantity] * (1.0 if one.direct else one.scale)


def _largest_amplitude(typical: Observation) -> float:
    return max(typical.amplitude.values(), default=0.0) or 1e-6
