"""Variation of a healthy machine's parameters from run to run, and over the seasons.

Load and temperature are never quite the same, so that a deviation must be judged against more than the fit's own error. The
variation of each parameter by itself from run to run is taken from the baseline (`between_run_scatter`). A baseline of a few
weeks cannot show slow changes: those that all terms of an element share (a bearing's oil, a coupling's temperature), and those
that all stiffnesses of the machine share (the season).
"""

from collections.abc import Sequence

import numpy as np

from estimator.arrays import Floats
from estimator.diagnosis.observation import Observation
from estimator.machine.parameter_description import SCALE_FACTORS, describe
from estimator.quantities import Quantity
from estimator.rotor.parameters import Coefficient, Unknowns
from estimator.trends.between_run_scatter import between_run_scatter

SHARED: dict[Quantity, float] = {
    "stiffness": 0.012,
    "angular stiffness": 0.012,
    "coupled stiffness": 0.012,
    "damping": 0.03,
    "angular damping": 0.03,
}
"""Standard deviation of the relative change that the terms of one element share, between any two times of the year [-]."""
SEASON = 0.02
"""Standard deviation of the relative change that all stiffnesses of the machine share [-]."""
SCALE_FACTOR = 5e-4
"""Run-to-run standard deviation of the scale factors of E and density [-]: the steel stays the same."""
GAIN = 0.005
"""Run-to-run standard deviation of a channel's gain [-]."""
ROTATING_VARIATION = {"rotating_offset": 2e-7, "rotating_angle": 2e-6}
"""Run-to-run standard deviations of a coupling's run-outs of bore and face [m, rad]: nobody opens it between runs."""
RUN_OUT = 0.005
"""Run-to-run standard deviation of a run-out, as a part of the channel's median amplitude [-]."""


def run_variation(baseline: Sequence[Observation]) -> Floats:
    """Compute the run-to-run standard deviations of the quantities of a baseline, each by itself.

    Args:
        baseline: Observations of the baseline's runs, with N quantities each.

    Returns:
        Standard deviations (N,) [unit of the quantity, 1 for logarithms].
    """
    points = [one.point for one in baseline]
    unit = np.array([channel_variation(name, baseline) for name in baseline[0].names])
    own = np.sqrt(between_run_scatter(points).variance)
    steel = [describe(name).quantity in SCALE_FACTORS for name in points[0].names]
    unit[: own.size] = np.where(steel, SCALE_FACTOR, own)
    return unit


def slow_variation(unknowns: Unknowns, names: Sequence[str], typical: Floats) -> Floats:
    """Compute the covariance of changes between two times of the year, which are alike in runs that follow each other.

    A cross-coupled term changes in proportion to its size, as a film's whole stiffness matrix does with its temperature.

    Args:
        unknowns: Unknowns of the machine.
        names: Names of the N quantities.
        typical: Values (N,) of the healthy machine [SI].

    Returns:
        Covariance (N, N) [SI², 1 for logarithms].
    """
    by_name = {one.name: one for one in unknowns.coefficients}
    known = [by_name.get(describe(name).coefficient) for name in names]
    growth = np.array([_growth(one, float(value)) for one, value in zip(known, typical, strict=True)])
    shared = growth * np.array([0.0 if one is None else SHARED.get(one.quantity, 0.0) for one in known])
    groups = [None if one is None else (one.element, one.order == 1) for one in known]
    stiff = SEASON * growth * np.array([one is not None and one.order == 0 for one in known])
    covariance = np.outer(stiff, stiff)
    for group in dict.fromkeys(one for one in groups if one is not None):
        column = shared * np.array([one == group for one in groups])
        covariance += np.outer(column, column)
    return np.asarray(covariance)


def _growth(coefficient: Coefficient | None, typical: float) -> float:
    """Return the change of a quantity that grows in proportion: of a logarithm 1, of a cross-coupled term its own value."""
    if coefficient is None:
        return 0.0
    return 1.0 if coefficient.direct else typical


def typical_amplitude(channel: str, baseline: Sequence[Observation]) -> float:
    """Compute the median amplitude of a channel in a baseline; that of the largest channel where it had no phasors.

    Args:
        channel: Id of the channel.
        baseline: Observations of the baseline's runs.

    Returns:
        Amplitude [m].
    """
    own = float(np.median([one.amplitude.get(channel, 0.0) for one in baseline]))
    return own or max((size for one in baseline for size in one.amplitude.values()), default=0.0) or 1e-6


def channel_variation(name: str, baseline: Sequence[Observation]) -> float:
    """Return the run-to-run standard deviation of an error of a channel or a coupling.

    Args:
        name: Name of the quantity.
        baseline: Observations of the baseline's runs.

    Returns:
        Standard deviation [unit of the quantity]; 0 for everything that is no such error.
    """
    said = describe(name)
    if said.quantity in ROTATING_VARIATION:
        return ROTATING_VARIATION[said.quantity]
    if said.element_kind != "probe":
        return 0.0
    return GAIN if said.quantity == "gain" else RUN_OUT * typical_amplitude(said.element_id, baseline)
