"""What follows from an identification: quantities of the updated model that a person trends beside its parameters.

Each comes with a 95 % interval, to first order from the identification's covariance, or with the reason why it has no value.
"""

from dataclasses import dataclass

import numpy as np

from estimator.identification import Identification
from estimator.machine import Machine
from estimator.misalignment_force import coupling_forces
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model import UpdatedModel, updated_model


@dataclass(frozen=True)
class Derived:
    """One derived quantity, in SI units. value, lower, upper (95 %): None where there is none, for what `reason` says."""

    name: str
    unit: str
    value: float | None
    lower: float | None
    upper: float | None
    reason: str | None = None


def derived_quantities(machine: Machine, identification: Identification) -> tuple[Derived, ...]:
    """Everything that follows from an accepted identification of a machine, named as in the analysts' page.

    Raises ValueError for an identification of another machine.
    """
    model = updated_model(machine, identification)
    return _coupling_loads(model, running_speed(machine, identification))


def running_speed(machine: Machine, identification: Identification) -> float:
    """Speed [rad/s] at which loads are stated: the machine's running speed, else the highest that was identified from."""
    given = machine.operation.running_rpm
    return identification.speed_maximum if given is None else rpm_to_rad_per_s(given)


def _coupling_loads(model: UpdatedModel, speed: float) -> tuple[Derived, ...]:
    found = []
    for one in coupling_forces(model, speed=np.array([speed])):
        for what, unit, band in (("force", "N", one.force), ("moment", "N m", one.moment)):
            name = f"coupling.{one.coupling}.misalignment_{what}"
            found.append(Derived(name, unit, float(band.amplitude[0]), float(band.lower[0]), float(band.upper[0])))
    return tuple(found)
