"""Samples that one fit uses: usable, no more than it needs, and enough for its unknowns."""

import numpy as np

from estimator.machine.bearings_on_films import bearings_on_films
from estimator.machine.checks.document_size import FEWEST_SAMPLES, document_size
from estimator.machine.document import Machine
from estimator.phasors.measurement import Measurement
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s

LARGEST_SAMPLE_COUNT = 5000
"""Most samples that one fit uses; more are thinned out."""
LARGEST_AMPLITUDE = 1e6
"""Amplitude [m] above which the data are refused as a slip that arithmetic may not survive."""
SAME_SPEED = 1e-3
"""Relative difference of speeds that count as one [-]: samples there repeat each other."""
THINNING_BINS = 200
"""Number of pieces of the speed range in which samples are thinned out."""


class NotEnoughData(ValueError):
    """Raised when the data cannot determine the unknowns, whatever their values."""


def without_empty_samples(measurement: Measurement) -> Measurement:
    """Pick the samples of which a phasor is usable.

    Args:
        measurement: Measured phasors.

    Returns:
        The samples with a usable phasor.
    """
    return measurement.pick(np.asarray(measurement.usable.any(axis=1)))


def carried_by_films(machine: Machine, measurement: Measurement) -> Measurement:
    """Pick the samples at speeds at which the films of the document carry their journals.

    Args:
        machine: The machine.
        measurement: Its measured phasors.

    Returns:
        The samples above the films' `valid_above_rpm`.

    Raises:
        NotEnoughData: There are samples, but none of these.
    """
    slowest = rpm_to_rad_per_s(max((one.film.valid_above_rpm for one in bearings_on_films(machine.bearings)), default=0.0))
    found = measurement.pick(np.asarray(measurement.speed >= slowest))
    if found.speed.size == 0 < measurement.speed.size:
        raise NotEnoughData(f"no sample is above valid_above_rpm of a film, {rad_per_s_to_rpm(slowest):.0f} r/min")
    return found


def most_samples(machine: Machine) -> int:
    """Return the most samples of a machine that one fit uses: fewer of a long train.

    Args:
        machine: The machine.

    Returns:
        Number of samples.
    """
    return min(LARGEST_SAMPLE_COUNT, max(FEWEST_SAMPLES, document_size(machine).samples))


def thinned(measurement: Measurement, *, most: int) -> Measurement:
    """Pick at most so many samples, taking away where speeds are most crowded: hours at speed add little.

    Args:
        measurement: Measured phasors.
        most: Most samples.

    Returns:
        The samples, spread over the range of speeds.
    """
    if measurement.speed.size <= most:
        return measurement
    edges = np.linspace(measurement.speed.min(), measurement.speed.max(), THINNING_BINS + 1)
    place = np.clip(np.searchsorted(edges, measurement.speed, side="right") - 1, 0, THINNING_BINS - 1)
    held = np.bincount(place, minlength=THINNING_BINS)
    each = max(cap for cap in range(1, held.max() + 1) if cap == 1 or np.minimum(held, cap).sum() <= most)
    keep = np.zeros(place.size, dtype=bool)
    for crowd in range(THINNING_BINS):
        members = np.flatnonzero(place == crowd)
        keep[members[np.linspace(0, members.size - 1, min(each, members.size)).round().astype(int)]] = True
    return measurement.pick(keep)


def require_usable(machine: Machine, measurement: Measurement) -> None:
    """Check that channels and discs are the machine's, and that some phasor has a size that a shaft can reach.

    Args:
        machine: The machine.
        measurement: Its measured phasors.

    Raises:
        NotEnoughData: There is no sample.
        ValueError: The channels or discs are not the machine's, or an amplitude is a slip.
    """
    if measurement.phasor.shape[1] != len(machine.probes):
        raise ValueError(
            f"the measurement has {measurement.phasor.shape[1]} channels, machine '{machine.id}' has {len(machine.probes)}"
        )
    if measurement.added is not None and measurement.added.shape[1] != len(machine.discs):
        raise ValueError(
            f"added unbalances are given for {measurement.added.shape[1]} discs, "
            f"machine '{machine.id}' has {len(machine.discs)}"
        )
    if measurement.speed.size == 0:
        raise NotEnoughData("no sample has a usable channel")
    largest = float(np.max(np.abs(measurement.phasor), where=measurement.usable, initial=0.0))
    if largest > LARGEST_AMPLITUDE:
        raise ValueError(f"an amplitude of {largest:.3g} m: no shaft moves so far; are the units right?")


def require_more_than(free: int, measurement: Measurement) -> None:
    """Check that more independent numbers were measured than unknowns are free.

    Args:
        free: Number of unknowns.
        measurement: Measured phasors.

    Raises:
        NotEnoughData: There are as many or fewer.
    """
    count = _independent_numbers(measurement)
    if count <= free:
        raise NotEnoughData(
            f"{count} measured numbers cannot determine {free} unknowns: more speeds or more channels are needed "
            "(samples at one speed repeat each other)"
        )


def _independent_numbers(measurement: Measurement) -> int:
    """Count the real numbers that were measured, those at the same speed, sense of rotation and trial weight once."""
    bins = np.round(np.log(measurement.speed) / SAME_SPEED)
    keys = [bins, measurement.direction]
    if measurement.added is not None:
        keys += [*measurement.added.real.T, *measurement.added.imag.T]
    _, place = np.unique(np.stack(keys, axis=1), axis=0, return_inverse=True)
    seen = np.zeros((place.max() + 1, measurement.phasor.shape[1]), dtype=bool)
    np.logical_or.at(seen, place.reshape(-1), measurement.usable)
    return 2 * int(np.count_nonzero(seen))
