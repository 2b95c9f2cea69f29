"""Several runs of one machine as one identification, without pretending that the machine was the same in all of them.

Each run is identified by itself; the estimates are averaged, and the errors of the averages come from the runs' own errors or
from their scatter, whichever is larger (a random-effects mean: DerSimonian and Laird, Controlled Clinical Trials 7 (1986) 177,
doi:10.1016/0197-2456(86)90046-2, with equal weights).
"""

import math
from collections import Counter
from collections.abc import Sequence

import numpy as np
import scipy.special
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.fit.estimates import Estimate
from estimator.fit.identification import Identification
from estimator.fit.validation.doubted_force import DoubtedForce
from estimator.machine.parameter_description import is_direct


def combine(results: Sequence[Identification]) -> Identification:
    """Combine the identifications of single runs of the same machine into one.

    Source: random-effects mean (DerSimonian and Laird 1986, doi:10.1016/0197-2456(86)90046-2) with equal weights.

    Args:
        results: Identifications of at least two runs, with the same coordinates.

    Returns:
        One identification.

    Raises:
        ValueError: There are fewer than two.
    """
    count = len(results)
    if count < 2:
        raise ValueError("at least two identifications are needed to combine them")
    values = np.array([_coordinates(result) for result in results])
    own = np.mean([result.covariance for result in results], axis=0) / count
    between = np.var(values, axis=0, ddof=1) / count
    doubted = _doubted(results)
    for force in doubted:  # what it is off by is the same in all runs: no mean makes it less
        own = own + (1.0 - 1.0 / count) * force.size**2 * np.outer(force.answer, force.answer)
    covariance = own + np.diag(np.maximum(np.nan_to_num(between) - np.diag(own), 0.0))
    half = float(scipy.special.stdtrit(count - 1, 0.975))
    error = np.sqrt(np.diag(covariance))
    mean = np.mean(values, axis=0)
    accepted = all(result.accepted for result in results)
    first = results[0]
    return replace(
        first,
        estimates=tuple(
            _estimate(one, dict(zip(first.coordinates, zip(mean, error, strict=True), strict=True)), half)
            for one in first.estimates
        ),
        covariance=covariance,
        point=np.mean([result.point for result in results], axis=0),
        chi_square=math.fsum(result.chi_square for result in results),
        degrees_of_freedom=sum(result.degrees_of_freedom for result in results),
        accepted=accepted,
        verdict=f"{count} runs averaged: " + ("each accepted" if accepted else "; ".join(r.verdict for r in results)),
        condition_number=max(result.condition_number for result in results),
        starts=sum(result.starts for result in results),
        iterations=sum(result.iterations for result in results),
        samples=sum(result.samples for result in results),
        speed_minimum=min(result.speed_minimum for result in results),
        speed_maximum=max(result.speed_maximum for result in results),
        outliers=dict(sum((Counter(result.outliers) for result in results), Counter())),
        channel_effects=None,
        doubted_forces=doubted,
    )


def _doubted(results: Sequence[Identification]) -> tuple[DoubtedForce, ...]:
    """Return the forces that some runs doubt, each as far off in the mean square as all runs have it.

    Answers count by the square of their sizes: what the force leaves open is then no more than the pooled covariance has.
    """
    found: dict[str, list[DoubtedForce]] = {}
    for result in results:
        for one in result.doubted_forces:
            found.setdefault(one.name, []).append(one)
    return tuple(
        DoubtedForce(
            name,
            math.sqrt(sum(one.size**2 for one in each) / len(results)),
            np.average([one.answer for one in each], axis=0, weights=[one.size**2 for one in each]),
        )
        for name, each in found.items()
    )


def _coordinates(result: Identification) -> Floats:
    """Return the values over `result.coordinates`: direct terms as logarithms, NaN where not estimable."""
    values: dict[str, float] = {}
    for one in result.estimates:
        if one.value is None:
            continue
        if one.imaginary is not None:
            values[f"{one.name}.real"], values[f"{one.name}.imaginary"] = one.value, one.imaginary
        else:
            values[one.name] = math.log(one.value) if is_direct(one.name) else one.value
    return np.array([values.get(name, math.nan) for name in result.coordinates])


def _estimate(one: Estimate, found: dict[str, tuple[float, float]], half: float) -> Estimate:
    """Build the averaged estimate; not estimable where a single run could not determine it."""
    common = (one.name, one.element, one.quantity, one.unit)
    parts = [found[name] for name in (one.name, f"{one.name}.real", f"{one.name}.imaginary") if name in found]
    if not parts:
        return one  # fixed or tied: no run has estimated it
    if any(math.isnan(value) for value, _ in parts):
        return Estimate(*common, None, None, None, None, reason="not every run determines it")
    value, error = float(parts[0][0]), float(parts[0][1])
    if len(parts) == 2:
        imaginary, other = float(parts[1][0]), float(parts[1][1])
        size, margin = math.hypot(value, imaginary), half * max(error, other)
        return Estimate(*common, value, error, max(0.0, size - margin), size + margin, imaginary, other)
    if is_direct(one.name):
        middle = math.exp(value)
        return Estimate(*common, middle, middle * error, middle * math.exp(-half * error), middle * math.exp(half * error))
    return Estimate(*common, value, error, value - half * error, value + half * error)
