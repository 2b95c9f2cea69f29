"""Critical speeds of the document's nominal model, and the ones that a run has crossed."""

from functools import lru_cache

import numpy as np

from estimator.arrays import Floats
from estimator.machine.document import Machine
from estimator.modes.critical_speed import undamped_critical_speeds
from estimator.rotor.modal_reduction import modal_basis
from estimator.rotor.system_matrices import system_matrices_over_speed
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s

CACHE_SIZE = 256
"""Number of machines whose critical speeds are cached."""


def crossed_critical_speeds(machine: Machine, *, lowest: float, highest: float) -> list[float]:
    """List the nominal critical speeds between two speeds.

    Args:
        machine: The machine.
        lowest: Lowest speed [rad/s].
        highest: Highest speed [rad/s].

    Returns:
        Critical speeds, ascending, to a tenth [r/min].
    """
    found = nominal_critical_speeds(machine).tolist()
    return [round(rad_per_s_to_rpm(one), 1) for one in found if lowest <= one <= highest]


def nominal_critical_speeds(machine: Machine) -> Floats:
    """Compute the undamped critical speeds of the document's nominal model up to its maximum speed.

    Args:
        machine: The machine.

    Returns:
        Critical speeds (c,), ascending [rad/s].
    """
    return _critical_speeds(machine.model_dump_json())


@lru_cache(maxsize=CACHE_SIZE)
def _critical_speeds(document: str) -> Floats:
    machine = Machine.model_validate_json(document)
    highest = rpm_to_rad_per_s(machine.speed_range.maximum_rpm)
    # Where coefficients follow the speed, those of the middle.
    matrices = system_matrices_over_speed(machine, basis=modal_basis(machine, highest))
    found = undamped_critical_speeds(matrices(highest / 2), direction=machine.direction)
    return np.asarray(found[found <= highest])
