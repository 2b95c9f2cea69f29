"""Coverage of a run by its samples: part of the speed range, density, usable channels. Needs no model of the machine."""

from dataclasses import dataclass

import numpy as np

from estimator.machine.document import Machine
from estimator.phasors.measurement import Measurement
from estimator.units import rad_per_s_to_rpm


@dataclass(frozen=True)
class Coverage:
    """Coverage of one run.

    Attributes:
        part: Part of the machine's speed range, 0 to 1 [-].
        samples_per_rpm: Number of samples over the range of speeds covered [min/r].
        largest_hole_rpm: Largest distance between neighbours in speed [r/min].
        usable: Part of the samples that are good, by channel [-].
        duration_s: Time from the first sample to the last [s].
    """

    part: float
    samples_per_rpm: float
    largest_hole_rpm: float
    usable: dict[str, float]
    duration_s: float


def coverage(machine: Machine, measurement: Measurement, *, duration_s: float) -> Coverage:
    """Compute the coverage of a run.

    Args:
        machine: The machine.
        measurement: Samples of the run, at least one.
        duration_s: Time from the first sample to the last [s].

    Returns:
        The coverage.
    """
    speed = np.sort(measurement.speed)
    lowest, highest = float(speed[0]), float(speed[-1])
    covered = rad_per_s_to_rpm(highest - lowest)
    limits = machine.speed_range
    usable = np.mean(measurement.usable, axis=0).tolist()
    return Coverage(
        part=min(1.0, covered / (limits.maximum_rpm - limits.minimum_rpm)),
        samples_per_rpm=speed.size / covered if covered > 0 else 0.0,
        largest_hole_rpm=rad_per_s_to_rpm(float(np.max(np.diff(speed), initial=0.0))),
        usable=dict(zip(machine.channels, usable, strict=True)),
        duration_s=duration_s,
    )
