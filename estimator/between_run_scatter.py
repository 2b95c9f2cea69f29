"""How far a machine's parameters differ from run to run while nothing happens to it, beyond the errors of the fits.

A baseline of a few runs says little about its own scatter. So each variance begins as a belief, a scaled inverse χ² with
PRIOR_WEIGHT degrees of freedom around what is usual, and the baseline's n runs add n - 1 of their own: the conjugate analysis
of a normal variance (Gelman et al., Bayesian Data Analysis, 3rd ed., §3.2), as it shrinks the variances of many genes (Smyth
2004, doi:10.2202/1544-6115.1027). A deviation divided by its root then follows Student's t. What the fits' own errors explain
is taken off first; where these are large beside the scatter the runs say little about it and count for less.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.parameters import is_direct
from estimator.point import Point

PRIOR_WEIGHT = 10.0
"""Degrees of freedom that the expected scatter counts for."""
STIFFNESS_SCATTER = 0.01
"""Expected run-to-run standard deviation of a stiffness, part of its own value or of the direct terms beside it; and of a
gain, part of 1."""
DAMPING_SCATTER = 0.05
"""The same for a damping, which depends on the oil's temperature; also for a seal's inertia."""
EXCITATION_SCATTER = 0.03
"""The same for each component of an unbalance or of another excitation, part of its magnitude."""
LEAST_EXCITATION = 1.0 / 3.0
"""Small unbalances take up what the model lacks: none is expected to repeat better than this part of the largest does."""
COMPONENTS = (".real", ".imaginary")
GAINS = tuple(f".gain{part}" for part in COMPONENTS)


@dataclass(frozen=True)
class Scatter:
    """Run-to-run scatter of N parameters.

    names: of the parameters. size: (N,) what a change of each is measured by, in the parameter's unit: 1 for a logarithm, the
    direct terms beside a cross-coupled term, the magnitude of an unbalance. variance: (N,) from run to run, in the
    parameter's unit squared. degrees_of_freedom: (N,) with which each variance is known, PRIOR_WEIGHT to PRIOR_WEIGHT + n - 1.
    """

    names: tuple[str, ...]
    size: Floats
    variance: Floats
    degrees_of_freedom: Floats


def between_run_scatter(baseline: Sequence[Point]) -> Scatter:
    """Scatter of the parameters of a baseline, whose points all have the same names.

    Raises ValueError for an empty baseline or points of different parameters.
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
    """Standard deviation (N,) that is expected from run to run, part of each parameter's size."""
    return np.array([_expected(name) for name in names])


def sizes(names: Sequence[str], centre: Floats) -> Floats:
    """What a change of each parameter (N,) is measured by, in the parameter's unit, from a baseline's centre (N,)."""
    at = dict(zip(names, centre.tolist(), strict=True))
    excitations = {stem: math.hypot(*(at.get(stem + part, 0.0) for part in COMPONENTS)) for stem in _excitations(names)}
    largest: dict[str, float] = {}
    for stem, magnitude in excitations.items():
        largest[_kind(stem)] = max(magnitude, largest.get(_kind(stem), 0.0))

    def size(name: str) -> float:
        if is_direct(name) or name.endswith(GAINS):
            return 1.0
        if name.endswith(COMPONENTS):
            stem = name.rsplit(".", 1)[0]
            return max(excitations[stem], LEAST_EXCITATION * largest[_kind(stem)])
        return _beside(name, at)

    return np.array([size(name) for name in names])


def _expected(name: str) -> float:
    if name.endswith(GAINS):
        return STIFFNESS_SCATTER
    if name.endswith(COMPONENTS):
        return EXCITATION_SCATTER
    term = name.partition("@")[0].rsplit(".", 1)[-1]
    return DAMPING_SCATTER if term.startswith(("c", "m")) else STIFFNESS_SCATTER


def _excitations(names: Sequence[str]) -> list[str]:
    return [name.rsplit(".", 1)[0] for name in names if name.endswith(COMPONENTS)]


def _kind(stem: str) -> str:
    """Excitations of one kind, such as unbalances, share a unit."""
    return stem.rsplit(".", 1)[-1]


def _beside(name: str, at: Mapping[str, float]) -> float:
    """Geometric mean of the direct terms beside a cross-coupled one, as far as they are known; else its own magnitude."""
    coefficient, _, knot = name.partition("@")
    element, term = coefficient.rsplit(".", 1)
    if term.startswith(("k_phi", "c_phi")):
        pair = (f"{term[:5]}x", f"{term[:5]}y")
    elif "_phi" in term:
        pair = (f"k{term[1]}{term[1]}", f"k_phi{term[-1]}")
    else:
        pair = (f"{term[0]}xx", f"{term[0]}yy")
    suffix = f"@{knot}" if knot else ""
    known = [at[f"{element}.{one}{suffix}"] for one in pair if f"{element}.{one}{suffix}" in at]
    return math.exp(sum(known) / len(known)) if known else abs(at[name]) or 1.0
