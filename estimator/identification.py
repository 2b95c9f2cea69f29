"""One identification: from a machine and its measured phasors to estimates with uncertainties, or to the reason why not."""

import math
from dataclasses import dataclass, replace

import numpy as np

from estimator.condensation import CondensedTrain, Floats, condense
from estimator.coordinates import Coordinates
from estimator.estimates import Estimate, estimates
from estimator.fit import STAGE_MISFITS, Fit, Problem, fit
from estimator.machine import Machine
from estimator.measurement import Measurement

CHI_SQUARE_LIMIT = 5.0
"""The fit is accepted when χ²/dof is at most 1 plus this many standard deviations √(2/dof)."""
START_SPREAD_LOG = 0.35
"""Standard deviation of the logarithm of a direct term in a random start."""
START_SPREAD_CROSS = 0.35
"""The same for a cross-coupled term, in units of its element's direct terms."""
AGREEING_STARTS = 3
"""So many starts that end in the same misfit are believed, …"""
SAME_MISFIT = 1.01
"""… the same up to this factor."""
CANDIDATES = 12
"""Random candidates from which each start after the first is the best."""
GUESSED_CANDIDATES = 60
"""The same where the document leaves nominal values out."""
GUESSED_SPREAD = 1.5
"""Standard deviation of the logarithm of the factor that all unknown direct terms of a kind share in a candidate."""
LARGEST_SAMPLE_COUNT = 1000
"""Samples that one fit uses; more are thinned out."""
THINNING_BINS = 200
"""Pieces of the speed range in which samples are thinned out."""


class NotEnoughData(ValueError):
    """The data cannot determine the unknowns, whatever their values."""


class FitFailed(ValueError):
    """The fit ran into numbers that are none."""


@dataclass(frozen=True)
class Options:
    """How to identify. starts: most starts tried before a misfit is reported; seed: of the random starts."""

    starts: int = 10
    seed: int = 0


@dataclass(frozen=True)
class Identification:
    """The outcome of one fit.

    estimates: one per parameter name. covariance: (N, N) over `coordinates`, the real fit coordinates named there, with
    direct terms as logarithms, [SI² or 1]. chi_square over degrees_of_freedom judges the fit: accepted says the verdict,
    verdict says it in words. condition_number: of the correlation form of the information matrix. samples: used in the fit.
    """

    estimates: tuple[Estimate, ...]
    coordinates: tuple[str, ...]
    covariance: Floats
    chi_square: float
    degrees_of_freedom: int
    accepted: bool
    verdict: str
    condition_number: float
    starts: int
    iterations: int
    samples: int
    speed_minimum: float
    speed_maximum: float

    def estimate(self, name: str) -> Estimate:
        """The estimate of that name. Raises KeyError."""
        for one in self.estimates:
            if one.name == name:
                return one
        raise KeyError(name)


def identify(machine: Machine, measurement: Measurement, options: Options | None = None) -> Identification:
    """Identify every bearing and coupling coefficient and every disc's unbalance of a machine.

    Maximum likelihood under independent Gaussian errors of the size that the measurement or the machine's noise model
    states. Starts from the nominal values; where the χ² test fails, random starts around them follow.
    Raises NotEnoughData when there are fewer measured numbers than unknowns, FitFailed when no start leads anywhere,
    SingularCondensation for a speed that cannot be condensed at, ValueError when the channels are not the machine's.
    """
    options = options or Options()
    measurement = _thinned(_without_empty_samples(measurement))
    _require_enough(machine, measurement)
    train = condense(machine, speed=measurement.speed, direction=measurement.direction)
    count = 2 * int(np.count_nonzero(measurement.usable))
    freedom = count - train.unknowns.real_count
    if freedom < 1:
        raise NotEnoughData(
            f"{count} measured numbers cannot determine {train.unknowns.real_count} unknowns: "
            "more speeds or more channels are needed"
        )
    problem = _problem(machine, train, measurement)
    best, starts, iterations = _best_fit(problem, freedom, options)
    return _result(problem, best, freedom, starts, iterations)


def accepted(chi_square: float, freedom: int) -> bool:
    """Whether χ² is no larger than the noise explains."""
    return chi_square / freedom <= 1.0 + CHI_SQUARE_LIMIT * math.sqrt(2.0 / freedom)


def _without_empty_samples(measurement: Measurement) -> Measurement:
    return measurement.pick(np.asarray(measurement.usable.any(axis=1)))


def _thinned(measurement: Measurement) -> Measurement:
    """At most LARGEST_SAMPLE_COUNT samples, taken away where speeds are most crowded: hours at speed add little."""
    if measurement.speed.size <= LARGEST_SAMPLE_COUNT:
        return measurement
    edges = np.linspace(measurement.speed.min(), measurement.speed.max(), THINNING_BINS + 1)
    place = np.clip(np.searchsorted(edges, measurement.speed, side="right") - 1, 0, THINNING_BINS - 1)
    held = np.bincount(place, minlength=THINNING_BINS)
    most = max(cap for cap in range(1, held.max() + 1) if cap == 1 or np.minimum(held, cap).sum() <= LARGEST_SAMPLE_COUNT)
    keep = np.zeros(place.size, dtype=bool)
    for crowd in range(THINNING_BINS):
        members = np.flatnonzero(place == crowd)
        keep[members[np.linspace(0, members.size - 1, min(most, members.size)).round().astype(int)]] = True
    return measurement.pick(keep)


def _require_enough(machine: Machine, measurement: Measurement) -> None:
    if measurement.phasor.shape[1] != len(machine.probes):
        raise ValueError(
            f"the measurement has {measurement.phasor.shape[1]} channels, machine '{machine.id}' has {len(machine.probes)}"
        )
    if measurement.speed.size == 0:
        raise NotEnoughData("no sample has a usable channel")


def _problem(machine: Machine, train: CondensedTrain, measurement: Measurement) -> Problem:
    """The fit problem, with the unbalances' scale taken from the data at the nominal coefficients."""
    coordinates = Coordinates.of(train.unknowns, unbalance_scale=1.0)
    problem = Problem(train, _silenced(measurement), coordinates, machine.noise)
    theta = problem.best_unbalances(coordinates.centre, problem.weight(np.abs(problem.measurement.phasor), STAGE_MISFITS[0]))
    scale = float(np.max(np.abs(coordinates.unbalances(theta)), initial=0.0))
    if not scale > 0.0:
        raise NotEnoughData("every usable phasor is zero: there is no response to identify from")
    return replace(problem, coordinates=Coordinates.of(train.unknowns, unbalance_scale=scale))


def _silenced(measurement: Measurement) -> Measurement:
    """The measurement with unusable phasors set to zero, so that arithmetic on whole arrays stays finite."""
    return replace(measurement, phasor=np.where(measurement.usable, measurement.phasor, 0.0))


def _best_fit(problem: Problem, freedom: int, options: Options) -> tuple[Fit, int, int]:
    """The best of several starts, the number tried and the iterations spent."""
    rng = np.random.default_rng(options.seed)
    best: Fit | None = None
    reached: list[float] = []
    iterations = 0
    for start_number in range(1, max(1, options.starts) + 1):
        found = fit(problem, _start(problem, rng, first=start_number == 1))
        iterations += found.iterations
        if np.isfinite(found.chi_square) and (best is None or found.chi_square < best.chi_square):
            best = found
        if best is not None and best.converged and accepted(best.chi_square, freedom):
            break
        reached.append(found.chi_square)
        if best is not None and sum(value < SAME_MISFIT * best.chi_square for value in reached) >= AGREEING_STARTS:
            break  # the same misfit from everywhere is the data's or the model's, not the start's
    if best is None:
        raise FitFailed(f"none of {start_number} starts led to a finite misfit: are the document's values sensible?")
    return best, start_number, iterations


def _start(problem: Problem, rng: np.random.Generator, *, first: bool) -> Floats:
    """Where a fit starts: at the nominal values, else at the best of some random candidates, by their first-stage misfit."""
    coordinates = problem.coordinates
    weight = problem.weight(np.abs(problem.measurement.phasor), STAGE_MISFITS[0])
    if first and not coordinates.guessed.any():
        return problem.best_unbalances(coordinates.centre, weight)
    candidates = [
        problem.best_unbalances(_candidate(coordinates, rng), weight)
        for _ in range(GUESSED_CANDIDATES if coordinates.guessed.any() else CANDIDATES)
    ]
    return min(candidates, key=lambda theta: problem.chi_square(theta, weight))


def _candidate(coordinates: Coordinates, rng: np.random.Generator) -> Floats:
    """Random coefficients around the expected ones; those that nobody knows share a common factor besides."""
    count = coordinates.coefficient_count
    spread = np.where(coordinates.logarithmic, START_SPREAD_LOG, START_SPREAD_CROSS)
    theta = coordinates.centre.copy()
    theta[:count] += spread * rng.standard_normal(count)
    common = {quantity: GUESSED_SPREAD * rng.standard_normal() for quantity in sorted(set(coordinates.quantities))}
    shift = np.array([common[quantity] for quantity in coordinates.quantities])
    theta[:count] += np.where(coordinates.guessed, shift, 0.0)
    return theta


def _result(problem: Problem, best: Fit, freedom: int, starts: int, iterations: int) -> Identification:
    coordinates = problem.coordinates
    information = best.information + np.diag(coordinates.spread**-2)
    covariance = np.linalg.inv(information)
    covariance = (covariance + covariance.T) / 2
    size = np.sqrt(np.diag(information))
    good = best.converged and accepted(best.chi_square, freedom)
    speed = problem.measurement.speed
    return Identification(
        estimates=estimates(problem.train.unknowns, coordinates, best.theta, np.sqrt(np.diag(covariance))),
        coordinates=_coordinate_names(problem),
        covariance=_physical_covariance(coordinates, covariance),
        chi_square=best.chi_square,
        degrees_of_freedom=freedom,
        accepted=good,
        verdict=_verdict(best, freedom),
        condition_number=float(np.linalg.cond(information / np.outer(size, size))),
        starts=starts,
        iterations=iterations,
        samples=int(speed.size),
        speed_minimum=float(speed.min()),
        speed_maximum=float(speed.max()),
    )


def _verdict(best: Fit, freedom: int) -> str:
    reduced, spread = best.chi_square / freedom, math.sqrt(2.0 / freedom)
    if not best.converged:
        return f"not converged, χ²/dof {reduced:.3g}"
    if not accepted(best.chi_square, freedom):
        return f"the model does not fit the data: χ²/dof {reduced:.3g}, expected 1 ± {spread:.2g}"
    if reduced < 1.0 - CHI_SQUARE_LIMIT * spread:
        return f"accepted; the stated noise is too large: χ²/dof {reduced:.3g}, expected 1 ± {spread:.2g}"
    return f"accepted: χ²/dof {reduced:.3g}, expected 1 ± {spread:.2g}"


def _coordinate_names(problem: Problem) -> tuple[str, ...]:
    unknown = problem.train.unknowns
    planes = [f"{plane.name}.{part}" for plane in unknown.unbalances for part in ("real", "imaginary")]
    return tuple([c.name for c in unknown.coefficients] + planes)


def _physical_covariance(coordinates: Coordinates, covariance: Floats) -> Floats:
    """Covariance with direct terms as logarithms and everything else in SI."""
    count = coordinates.coefficient_count
    unit = np.full(covariance.shape[0], coordinates.unbalance_scale)
    unit[:count] = np.where(coordinates.logarithmic, 1.0, coordinates.scale)
    return covariance * np.outer(unit, unit)
