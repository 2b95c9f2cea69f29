"""Quantities that follow from an identification and are trended beside its parameters.

Each comes with a 95 % interval, to first order from the identification's covariance, or with the reason why it has no value.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.fit.estimates import (
    CONFIDENCE_95,
    LARGEST_DIRECT_ERROR,
    LARGEST_RELATIVE_ERROR,
    prior_alone,
    prior_alone_reason,
)
from estimator.fit.identification import Identification
from estimator.machine.document import Machine
from estimator.phasors.harmonic_ratio import FEWEST, NEAR, Orders, measures_second, second_order, second_over_first
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s
from estimator.updated_model.alignment_results import AlignmentResult, alignment_results
from estimator.updated_model.amplification import UncertainPeak, peaks_with_errors
from estimator.updated_model.coupling_loads import coupling_forces
from estimator.updated_model.critical_speed_tracking import HIGHEST_ABOVE_TRIP, FollowedCrossings, followed_crossings
from estimator.updated_model.film_results import FilmResult, film_results
from estimator.updated_model.modal_uncertainty import crossing_slopes
from estimator.updated_model.model import UpdatedModel, updated_model
from estimator.updated_model.static_coupling_loads import static_coupling_loads
from estimator.updated_model.uncertainty import standard_errors

NEAR_PEAK = 3.0
"""Farthest distance of a response peak from the critical speed it belongs to, in its half bandwidths ζΩ [-]."""


@dataclass(frozen=True)
class Derived:
    """One derived quantity.

    Attributes:
        name: Name, as in docs/analysts.md.
        unit: SI unit of the values.
        value: Value [unit]; None where there is none.
        lower: Lower end of the 95 % interval [unit]; None where there is none.
        upper: Upper end of the 95 % interval [unit]; None where there is none.
        reason: Reason why there is no value.
    """

    name: str
    unit: str
    value: float | None
    lower: float | None
    upper: float | None
    reason: str | None = None


def derived_quantities(
    machine: Machine, identification: Identification, runs: Sequence[Orders] = (), *, direction: int | None = None
) -> tuple[Derived, ...]:
    """Derive every quantity that follows from an accepted identification of a machine, named as in docs/analysts.md.

    Args:
        machine: The machine.
        identification: Its accepted identification.
        runs: Runs it was identified from, for the 2× component.
        direction: Sense in which it turned, +1 or -1; None for the document's.

    Returns:
        Derived quantities with their units.

    Raises:
        ValueError: The identification is of another machine.
    """
    model = updated_model(machine, identification).turning(machine.direction if direction is None else direction)
    speed = running_speed(machine, identification)
    return (*model_quantities(model, speed=speed), *_second_orders(machine, runs, speed))


def model_quantities(model: UpdatedModel, *, speed: float) -> tuple[Derived, ...]:
    """Derive the quantities that follow from a model alone.

    Args:
        model: The updated model.
        speed: Speed at which coupling loads are stated [rad/s].

    Returns:
        Derived quantities with their units.
    """
    crossings = followed_crossings(model)
    return (
        *_critical_speeds(model, crossings),
        *_coupling_loads(model, speed),
        *_amplification_factors(model, crossings),
        *map(_of_film, film_results(model)),
        *map(_of_film, static_coupling_loads(model)),
        *alignment_quantities(model),
    )


def alignment_quantities(model: UpdatedModel) -> tuple[Derived, ...]:
    """Derive offset and angle of each coupling in both planes, or the reason why a run does not determine them.

    Args:
        model: The updated model.

    Returns:
        Derived quantities [m, rad]; none of a train whose coefficients do not follow from films.
    """
    return tuple(map(_of_alignment, alignment_results(model)))


def running_speed(machine: Machine, identification: Identification) -> float:
    """Return the speed at which loads are stated: the machine's running speed, else the highest that was identified from.

    Args:
        machine: The machine.
        identification: Its identification.

    Returns:
        Speed [rad/s].
    """
    given = machine.operation.running_rpm
    return identification.speed_maximum if given is None else rpm_to_rad_per_s(given)


def _critical_speeds(model: UpdatedModel, crossings: FollowedCrossings) -> Iterator[Derived]:
    root = crossings.modes.eigenvalue
    slope = crossing_slopes(model, crossings.modes)
    place = {int(number): i for i, number in enumerate(crossings.number)}
    lost = "it is damped away, or cannot be followed from the document's model to the identified one"
    for number in range(crossings.count):
        if number not in place:
            yield Derived(f"critical_speed.{number + 1}", "rad/s", None, None, None, lost)
            yield Derived(f"damping_ratio.{number + 1}", "1", None, None, None, lost)
            continue
        i = place[number]
        speed, by_coordinate = float(root[i].imag), slope[i].imag
        yield _normal(f"critical_speed.{number + 1}", "rad/s", speed, by_coordinate, model)
        yield _normal(f"damping_ratio.{number + 1}", "1", *_damping_ratio(complex(root[i]), slope[i]), model)
    for first, second in crossings.pairs:
        name = f"splitting.{first + 1}-{second + 1}"
        if first not in place or second not in place:
            yield Derived(name, "1", None, None, None, lost)
            continue
        a, b = place[first], place[second]
        yield _normal(name, "1", *_splitting(root[[a, b]].imag, slope[[a, b]].imag), model)


def _damping_ratio(root: complex, slope: Complexes) -> tuple[float, Floats]:
    """Compute -Re λ / |λ| with its slopes, from those of λ."""
    size = abs(root)
    along = (np.conj(root) * slope).real / size
    return -root.real / size, np.asarray(-slope.real / size + root.real * along / size**2)


def _splitting(speed: Floats, slope: Floats) -> tuple[float, Floats]:
    """Compute the distance of two speeds (2,) in parts of their mean, with its slopes, from those of the speeds (2, n)."""
    total = float(speed.sum())
    return 2.0 * float(speed[1] - speed[0]) / total, 4.0 * (speed[0] * slope[1] - speed[1] * slope[0]) / total**2


def _coupling_loads(model: UpdatedModel, speed: float) -> Iterator[Derived]:
    for one in coupling_forces(model, speed=np.array([speed])):
        for what, unit, band in (("force", "N", one.force), ("moment", "N m", one.moment)):
            name = f"coupling.{one.coupling}.misalignment_{what}"
            yield Derived(name, unit, float(band.amplitude[0]), float(band.lower[0]), float(band.upper[0]))


def _amplification_factors(model: UpdatedModel, crossings: FollowedCrossings) -> Iterator[Derived]:
    limits = model.machine.speed_range
    lowest, highest = rpm_to_rad_per_s(limits.minimum_rpm), rpm_to_rad_per_s(limits.maximum_rpm)
    found = peaks_with_errors(
        model,
        places=model.machine.probes,
        crossings=crossings.modes.eigenvalue,
        lowest=lowest,
        highest=HIGHEST_ABOVE_TRIP * highest,
    )
    for channel, peaks in zip(model.machine.channels, found, strict=True):
        within = [one for one in peaks if one.peak.speed <= highest]
        for number, one in sorted(_owners(within, crossings).items()):
            name, factor = f"probe.{channel}.amplification_factor.{number + 1}", one.peak.amplification_factor
            if factor is None or one.factor_error is None:
                yield Derived(name, "1", None, None, None, "the response falls to 0.707 of its peak on neither side")
                continue
            ratio = math.exp(CONFIDENCE_95 * one.factor_error / factor)
            yield Derived(name, "1", factor, factor / ratio, factor * ratio)


def _owners(peaks: Sequence[UncertainPeak], crossings: FollowedCrossings) -> dict[int, UncertainPeak]:
    """Find the highest of the peaks that belong to each critical speed, by its number."""
    root = crossings.modes.eigenvalue
    owners: dict[int, UncertainPeak] = {}
    for one in peaks if root.size else ():
        nearest = int(np.argmin(np.abs(one.peak.speed - root.imag)))
        number, near = int(crossings.number[nearest]), NEAR_PEAK * abs(root[nearest].real)
        highest = number not in owners or one.peak.amplitude > owners[number].peak.amplitude
        if highest and abs(one.peak.speed - root[nearest].imag) <= near:
            owners[number] = one
    return owners


def _of_film(one: FilmResult) -> Derived:
    """State a number about a film by the rules of estimates: a direct term by its logarithm, nothing too uncertain."""
    limit = LARGEST_DIRECT_ERROR if one.positive else LARGEST_RELATIVE_ERROR
    if one.size is not None and one.error > limit * one.size:
        part = f"{100 * one.error / one.size:.0f} % of the direct terms"
        why = f"the data leave it uncertain by {part} (its standard error; {100 * limit:.0f} % at most)"
        return Derived(one.name, one.unit, None, None, None, why)
    half = CONFIDENCE_95 * one.error
    if one.positive:
        ratio = math.exp(half / one.value)
        return Derived(one.name, one.unit, one.value, one.value / ratio, one.value * ratio)
    return Derived(one.name, one.unit, one.value, one.value - half, one.value + half)


def _of_alignment(one: AlignmentResult) -> Derived:
    return interval(one.name, one.unit, one.value, error=one.error, believed=one.believed, undefined=one.undefined)


def interval(name: str, unit: str, value: float, *, error: float, believed: float, undefined: str | None) -> Derived:
    """State an offset or angle by the rule of levels: not where runs say hardly more than what was believed before.

    Args:
        name: Name of the quantity.
        unit: SI unit.
        value: Value [unit].
        error: Its standard error [unit].
        believed: Its standard deviation before the runs [unit].
        undefined: Reason why there is none; None where there is one.

    Returns:
        The quantity with its 95 % interval, or the reason why it has no value.
    """
    why = undefined or (prior_alone_reason(believed, unit) if prior_alone(error, believed) else None)
    if why is not None:
        return Derived(name, unit, None, None, None, why)
    half = CONFIDENCE_95 * error
    return Derived(name, unit, value, value - half, value + half)


def _second_orders(machine: Machine, runs: Sequence[Orders], speed: float) -> Iterator[Derived]:
    for place, channel in enumerate(machine.channels):
        if not measures_second(runs, place):
            continue
        name = f"probe.{channel}.second_over_first"
        found = second_over_first(runs, place, running_speed=speed)
        if found is None:
            why = f"fewer than {FEWEST} samples within {100 * NEAR:g} % of {rad_per_s_to_rpm(speed):.0f} r/min have both"
            yield Derived(name, "1", None, None, None, why)
        else:
            yield Derived(name, "1", found.value, found.lower, found.upper)
        second = second_order(runs, place, running_speed=speed)
        if second is not None:
            half = CONFIDENCE_95 * second.amplitude_error
            size = second.amplitude
            yield Derived(f"probe.{channel}.second_amplitude", "m", size, max(0.0, size - half), size + half)
            half, phase = CONFIDENCE_95 * second.phase_error, second.phase
            yield Derived(f"probe.{channel}.second_phase", "rad", phase, phase - half, phase + half)


def _normal(name: str, unit: str, value: float, slope: Floats, model: UpdatedModel) -> Derived:
    half = CONFIDENCE_95 * float(standard_errors(slope, model.covariance))
    return Derived(name, unit, value, value - half, value + half)
