"""One identification: from a machine and its measured phasors to estimates with uncertainties, or to the reason why not."""

import math
from dataclasses import dataclass, replace

import numpy as np

from estimator.condensation import CondensedTrain, Floats, condense
from estimator.coordinates import Coordinates
from estimator.fit import Fit, Problem, fit
from estimator.machine import Machine
from estimator.measurement import Measurement
from estimator.parameters import Quantity

CHI_SQUARE_LIMIT = 5.0
"""The fit is accepted when χ²/dof stays below 1 by this many standard deviations √(2/dof)."""
START_SPREAD_LOG = 0.35
"""Standard deviation of the logarithm of a direct term in a random start."""
START_SPREAD_CROSS = 0.35
"""The same for a cross-coupled term, in units of its element's direct terms."""
LARGEST_SAMPLE_COUNT = 1000
"""Samples that one fit uses; more are thinned evenly."""
CONFIDENCE_95 = 1.959964


class NotEnoughData(ValueError):
    """The data cannot determine the unknowns, whatever their values."""


@dataclass(frozen=True)
class Options:
    """How to identify. starts: most starts tried before a misfit is reported; seed: of the random starts."""

    starts: int = 10
    seed: int = 0


@dataclass(frozen=True)
class Estimate:
    """One estimated parameter, in SI units.

    value, standard_error, lower, upper (95 %): None where the data do not determine it; `reason` then says why. An
    unbalance has an imaginary part and its standard error beside the real one; lower and upper then bound the magnitude.
    """

    name: str
    element: str
    quantity: Quantity
    unit: str
    value: float | None
    standard_error: float | None
    lower: float | None
    upper: float | None
    imaginary: float | None = None
    imaginary_standard_error: float | None = None
    reason: str | None = None

    @property
    def estimable(self) -> bool:
        """Whether the data determine this parameter."""
        return self.value is not None


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
    Raises NotEnoughData when there are fewer measured numbers than unknowns.
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
    keep = measurement.usable.any(axis=1)
    return Measurement(
        measurement.speed[keep],
        measurement.direction[keep],
        measurement.phasor[keep],
        measurement.usable[keep],
        measurement.scatter[keep],
    )


def _thinned(measurement: Measurement) -> Measurement:
    return measurement.every(max(1, math.ceil(measurement.speed.size / LARGEST_SAMPLE_COUNT)))


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
    theta = problem.best_unbalances(coordinates.centre, problem.weight(np.abs(problem.measurement.phasor), 0.5))
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
    iterations = 0
    for start_number in range(1, max(1, options.starts) + 1):
        found = fit(problem, _start(problem, rng, first=start_number == 1))
        iterations += found.iterations
        if best is None or found.chi_square < best.chi_square:
            best = found
        if best.converged and accepted(best.chi_square, freedom):
            break
    assert best is not None  # the loop runs at least once
    return best, start_number, iterations


def _start(problem: Problem, rng: np.random.Generator, *, first: bool) -> Floats:
    coordinates = problem.coordinates
    theta = coordinates.centre.copy()
    if not first:
        count = coordinates.coefficient_count
        spread = np.where(coordinates.logarithmic, START_SPREAD_LOG, START_SPREAD_CROSS)
        theta[:count] += spread * rng.standard_normal(count)
    return problem.best_unbalances(theta, problem.weight(np.abs(problem.measurement.phasor), 0.5))


def _result(problem: Problem, best: Fit, freedom: int, starts: int, iterations: int) -> Identification:
    coordinates = problem.coordinates
    information = best.information + np.diag(coordinates.spread**-2)
    covariance = np.linalg.inv(information)
    covariance = (covariance + covariance.T) / 2
    size = np.sqrt(np.diag(information))
    good = best.converged and accepted(best.chi_square, freedom)
    speed = problem.measurement.speed
    return Identification(
        estimates=_estimates(problem, best.theta, np.sqrt(np.diag(covariance))),
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


def _estimates(problem: Problem, theta: Floats, error: Floats) -> tuple[Estimate, ...]:
    coordinates = problem.coordinates
    values = coordinates.coefficients(theta)
    count = coordinates.coefficient_count
    result: list[Estimate] = []
    for i, coefficient in enumerate(problem.train.unknowns.coefficients):
        common = (coefficient.name, coefficient.element, coefficient.quantity, coefficient.unit)
        if error[i] > 1.0:
            against = "its value" if coefficient.direct else "the direct terms of its element"
            reason = f"the data leave it uncertain by {100 * error[i]:.0f} % of {against}"
            result.append(Estimate(*common, None, None, None, None, reason=reason))
        elif coefficient.direct:
            low, high = (values[i] * math.exp(sign * CONFIDENCE_95 * error[i]) for sign in (-1, 1))
            result.append(Estimate(*common, float(values[i]), float(values[i] * error[i]), float(low), float(high)))
        else:
            spread = float(coefficient.scale * error[i])
            middle = float(values[i])
            result.append(Estimate(*common, middle, spread, middle - CONFIDENCE_95 * spread, middle + CONFIDENCE_95 * spread))
    unbalances = coordinates.unbalances(theta)
    largest = float(np.max(np.abs(unbalances)))
    for i, plane in enumerate(problem.train.unknowns.unbalances):
        spread_parts = coordinates.unbalance_scale * error[count + 2 * i : count + 2 * i + 2]
        common = (plane.name, plane.element, "unbalance", plane.unit)
        size = float(np.max(spread_parts))
        if size > largest:
            reason = f"the data leave it uncertain by {size:.2g} kg m, more than the largest unbalance found"
            result.append(Estimate(*common, None, None, None, None, reason=reason))
            continue
        magnitude = abs(unbalances[i])
        result.append(
            Estimate(
                *common,
                value=float(unbalances[i].real),
                standard_error=float(spread_parts[0]),
                lower=max(0.0, float(magnitude - CONFIDENCE_95 * size)),
                upper=float(magnitude + CONFIDENCE_95 * size),
                imaginary=float(unbalances[i].imag),
                imaginary_standard_error=float(spread_parts[1]),
            )
        )
    return tuple(result)
