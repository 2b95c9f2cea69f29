"""What the samples of a run cover: part of the speed range, modes crossed, density, usable channels."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from estimator.condensation import Floats
from estimator.critical_speed import undamped_critical_speeds
from estimator.machine import Machine
from estimator.measurement import Measurement
from estimator.modal_reduction import modal_basis
from estimator.system_matrices import system_matrices_over_speed
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s

REMEMBERED = 256
"""Machines whose critical speeds are kept in memory."""


@dataclass(frozen=True)
class Coverage:
    """Coverage of one run.

    part: of the machine's speed range, 0 to 1. critical_speeds_rpm: those of the document's nominal model, without damping,
    between the lowest and the highest speed [r/min]. samples_per_rpm: their number over the speeds covered. largest_hole_rpm:
    between neighbours in speed [r/min]. usable: per channel the part of the samples that are good. duration_s: from the first
    sample to the last [s].
    """

    part: float
    critical_speeds_rpm: list[float]
    samples_per_rpm: float
    largest_hole_rpm: float
    usable: dict[str, float]
    duration_s: float


def coverage(machine: Machine, measurement: Measurement, *, duration_s: float) -> Coverage:
    """Coverage of a run's samples, at least one."""
    speed = np.sort(measurement.speed)
    lowest, highest = float(speed[0]), float(speed[-1])
    covered = rad_per_s_to_rpm(highest - lowest)
    limits = machine.speed_range
    usable = np.mean(measurement.usable, axis=0).tolist()
    crossed = [rad_per_s_to_rpm(one) for one in nominal_critical_speeds(machine).tolist() if lowest <= one <= highest]
    return Coverage(
        part=min(1.0, covered / (limits.maximum_rpm - limits.minimum_rpm)),
        critical_speeds_rpm=[round(one, 1) for one in crossed],
        samples_per_rpm=speed.size / covered if covered > 0 else 0.0,
        largest_hole_rpm=rad_per_s_to_rpm(float(np.max(np.diff(speed), initial=0.0))),
        usable=dict(zip(machine.channels, usable, strict=True)),
        duration_s=duration_s,
    )


def nominal_critical_speeds(machine: Machine) -> Floats:
    """Undamped critical speeds [rad/s] of the document's nominal model up to its maximum speed, ascending."""
    return _critical_speeds(machine.model_dump_json())


@lru_cache(maxsize=REMEMBERED)
def _critical_speeds(document: str) -> Floats:
    machine = Machine.model_validate_json(document)
    highest = rpm_to_rad_per_s(machine.speed_range.maximum_rpm)
    # Where coefficients follow the speed, those of the middle.
    matrices = system_matrices_over_speed(machine, basis=modal_basis(machine, highest))
    found = undamped_critical_speeds(matrices(highest / 2), direction=machine.direction)
    return np.asarray(found[found <= highest])
