"""Critical speeds of the document's nominal model, and which of them a run has crossed."""

from functools import lru_cache

import numpy as np

from estimator.arrays import Floats
from estimator.critical_speed import undamped_critical_speeds
from estimator.machine import Machine
from estimator.modal_reduction import modal_basis
from estimator.system_matrices import system_matrices_over_speed
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s

REMEMBERED = 256
"""Machines whose critical speeds are kept in memory."""


def crossed_critical_speeds(machine: Machine, *, lowest: float, highest: float) -> list[float]:
    """Nominal critical speeds between two speeds [rad/s], ascending [r/min], to a tenth."""
    found = nominal_critical_speeds(machine).tolist()
    return [round(rad_per_s_to_rpm(one), 1) for one in found if lowest <= one <= highest]


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
