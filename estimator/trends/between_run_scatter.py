"""Scatter of a machine's parameters from run to run while nothing happens to it, beyond the errors of the fits.

A baseline of a few runs says little about its own scatter. Each variance therefore has a prior, a scaled inverse χ² with
PRIOR_WEIGHT degrees of freedom around the usual value, to which the baseline's n runs add n - 1. This is the conjugate
analysis of a normal variance (Gelman et al., Bayesian Data Analysis, 3rd ed., §3.2), used to shrink the variances of many
genes (Smyth 2004, doi:10.2202/1544-6115.1027). A deviation over the root of the variance then follows Student's t. The part
that the fits' own errors explain is subtracted first; runs whose errors are large beside the scatter count for less.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.machine.parameter_description import COMPONENTS, describe
from estimator.trends.parameter_vector import Point

PRIOR_WEIGHT = 10.0
"""Degrees of freedom that the expected scatter counts for."""
STIFFNESS_SCATTER = 0.01
"""Expected run-to-run standard deviation of a stiffness, as a part of its own value or of the direct terms beside it, and of a
gain, as a part of 1 [-].
"""
DAMPING_SCATTER = 0.05
"""Expected run-to-run standard deviation of a damping, which depends on the oil's temperature, and of a seal's inertia, as a
part as for a stiffness [-].
"""
EXCITATION_SCATTER = 0.03
"""Expected run-to-run standard deviation of each component of an unbalance or another excitation, as a part of its magnitude
[-].
"""
LEAST_EXCITATION = 1.0 / 3.0
"""Part of the largest excitation's magnitude that a smaller one's scatter is measured by at least [-]: small unbalances take
up what the model lacks.
"""
GAIN = "gain"
"""Quantity of a channel's gain in its parameters' names."""


@dataclass(frozen=True)
class Scatter:
    """Run-to-run scatter of N parameters.

    Attributes:
        names: Names of the parameters.
        size: Measure (N,) of a change of each [unit of the parameter]: 1 for a logarithm, the direct terms beside a
            cross-coupled term, the magnitude of an unbalance.
        variance: Variance (N,) from run to run [unit of the parameter squared].
        degrees_of_freedom: Degrees of freedom (N,) with which each variance is known [-], PRIOR_WEIGHT to PRIOR_WEIGHT + n -
            1.
    """

    names: tuple[str, ...]
    size: Floats
    variance: Floats
    degrees_of_freedom: Floats


def between_run_scatter(baseline: Sequence[Point]) -> Scatter:
    """Estimate the run-to-run scatter of the parameters of a baseline, shrunk towards the usual one.

    Sources: module's docstring.

    Args:
        baseline: Points of n runs with the same N parameters in the same order.

    Returns:
        Scatter of the N parameters.

    Raises:
        ValueError: The baseline is empty, or its points have different parameters.
    """
    if not baseline:
        raise ValueError("a baseline needs at least one identification")
    names = baseline[0].names
    if any(point.names != names for point in baseline):
        raise ValueError("the points of a baseline must have the same parameters in the same order")
    values = np.array([point.value for point in baseline])
    centre = values.mean(axis=0)
    size = sizes(names, centre)
    own = np.mean([np.diag(point.covariance) for point in baseline], axis=0)
    freedom = len(baseline) - 1
    prior = (size * expected_scatter(names)) ** 2
    # A variance that is found as a difference is known as if there were fewer runs.
    weight = freedom * (prior / (prior + own)) ** 2
    seen = np.sum((values - centre) ** 2, axis=0) / max(1, freedom)
    variance = (PRIOR_WEIGHT * prior + weight * np.maximum(0.0, seen - own)) / (PRIOR_WEIGHT + weight)
    return Scatter(names, size, variance, PRIOR_WEIGHT + weight)


def expected_scatter(names: Sequence[str]) -> Floats:
    """Return the standard deviation that is expected from run to run.

    Args:
        names: Names of the N parameters.

    Returns:
        Standard deviation (N,) as a part of each parameter's size [-].
    """
    return np.array([_expected(name) for name in names])


def sizes(names: Sequence[str], centre: Floats) -> Floats:
    """Compute the measure of a change of each parameter.

    Args:
        names: Names of the N parameters.
        centre: Centre of the baseline (N,), in each parameter's unit [SI, logarithms of direct terms].

    Returns:
        Measure (N,) in each parameter's unit [SI, 1 for logarithms].
    """
    at = dict(zip(names, centre.tolist(), strict=True))
    complex_ones = {said.whole: said.quantity for said in map(describe, names) if said.component is not None}
    excitations = {one: math.hypot(*(at.get(f"{one}.{part}", 0.0) for part in COMPONENTS)) for one in complex_ones}
    largest: dict[str, float] = {}  # of each kind, such as unbalances, which share a unit
    for one, magnitude in excitations.items():
        largest[complex_ones[one]] = max(magnitude, largest.get(complex_ones[one], 0.0))

    def size(name: str) -> float:
        said = describe(name)
        if said.positive or said.quantity == GAIN:
            return 1.0
        if said.component is not None:
            return max(excitations[said.whole], LEAST_EXCITATION * largest[said.quantity])
        return _direct_term_scale(name, at)

    return np.array([size(name) for name in names])


def _expected(name: str) -> float:
    said = describe(name)
    if said.quantity == GAIN:
        return STIFFNESS_SCATTER
    if said.component is not None:
        return EXCITATION_SCATTER
    term = describe(said.coefficient).term
    return STIFFNESS_SCATTER if term is None or term.order == 0 else DAMPING_SCATTER


def _direct_term_scale(name: str, at: Mapping[str, float]) -> float:
    """Compute the geometric mean of the direct terms beside a cross-coupled one, as far as known; else its own magnitude."""
    said = describe(name)
    beside = () if said.term is None else tuple(map(said.of_term, said.term.beside))
    known = [at[one] for one in beside if one in at]
    return math.exp(sum(known) / len(known)) if known else abs(at[name]) or 1.0
