"""Critical speeds of the document's nominal model, and the ones that a run has crossed."""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
import scipy

from estimator.arrays import Floats
from estimator.machine.document import Machine
from estimator.modes.critical_speed import undamped_critical_speeds
from estimator.rotor.modal_reduction import modal_basis
from estimator.rotor.system_matrices import system_matrices_over_speed
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s

CACHE_SIZE = 256
"""Number of machines whose critical speeds are cached."""
GRID = 16
"""Number of speeds between which crossings are looked for where coefficients follow a table over speed."""


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

    Source: Nelson and McVaugh, J. Eng. Ind. 98 (1976) 593, doi:10.1115/1.3438942.

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
    matrices = system_matrices_over_speed(machine, basis=modal_basis(machine, highest))

    def undamped(speed: float) -> Floats:
        return undamped_critical_speeds(matrices(speed), direction=machine.direction)

    # Matrices of nominal coefficients that do not follow the speed are one and the same.
    if matrices(highest) is not matrices(highest / GRID):
        return _crossings(undamped, np.linspace(highest / GRID, highest, GRID))
    found = undamped(highest)
    return np.asarray(found[found <= highest])


def _crossings(undamped: Callable[[float], Floats], speeds: Floats) -> Floats:
    """Find the speeds that are a critical speed of the matrices at that same speed.

    Roots by Brent (Algorithms for Minimization without Derivatives, Prentice-Hall 1973; Comput. J. 14 (1971) 422).
    """
    at = [undamped(float(one)) for one in speeds]
    found: list[float] = []
    for k in range(min(map(len, at))):
        away = np.array([one[k] for one in at]) - speeds
        for i in np.flatnonzero(np.sign(away[1:]) != np.sign(away[:-1])).tolist():
            ends = speeds[i], speeds[i + 1]
            found.append(float(scipy.optimize.brentq(lambda one, k=k: float(undamped(one)[k]) - one, *ends, rtol=1e-8)))
    return np.sort(found)
