"""Results of an updated model as a library gives them: critical speeds, Campbell diagram, response, loads, balancing."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from estimator.arrays import Floats
from estimator.machine.document import Machine
from estimator.modes.campbell import Campbell, campbell
from estimator.modes.critical_speed import CriticalSpeed, critical_speed_table
from estimator.modes.eigenmodes import Modes
from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.balance_quality import RotorBalance, balance_grades
from estimator.updated_model.balancing import Correction, balance
from estimator.updated_model.coupling_loads import CouplingForce, coupling_forces
from estimator.updated_model.forced_response import forced_response
from estimator.updated_model.modal_uncertainty import modes_at
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.uncertainty import PhasorBand

if TYPE_CHECKING:
    from matplotlib.figure import Figure

HIGHEST_ABOVE_RANGE = 1.25
"""Highest speed of critical speeds and Campbell diagram, as a multiple of the speed range's end."""
CAMPBELL_SPEEDS = 40


@dataclass(frozen=True, eq=False)
class Model:
    """Results that follow from a machine's parameters; speeds are in r/min here, all else in SI.

    Attributes:
        updated: The machine with values of its parameters, and their covariance.
    """

    updated: UpdatedModel

    def __str__(self) -> str:
        diagram = ("campbell", "plot_campbell")
        results = ("critical_speeds", *diagram, "modes", "response", "coupling_loads", "balance_grades", "balance")
        return f"{self.machine.id}: model with {', '.join(f'{name}()' for name in results)}"

    __repr__ = __str__

    @property
    def machine(self) -> Machine:
        """Return the machine."""
        return self.updated.machine

    @property
    def _highest(self) -> float:
        return HIGHEST_ABOVE_RANGE * rpm_to_rad_per_s(self.machine.speed_range.maximum_rpm)

    def critical_speeds(self) -> tuple[CriticalSpeed, ...]:
        """Return the critical speeds up to a quarter above the speed range."""
        return critical_speed_table(self.updated.scaled_machine, highest=self._highest, coefficients=self.updated.coefficients)

    def campbell(self) -> Campbell:
        """Return the Campbell diagram up to a quarter above the speed range."""
        speeds = np.linspace(0.0, self._highest, CAMPBELL_SPEEDS)
        return campbell(
            self.updated.scaled_machine,
            speed=speeds,
            highest_frequency=self._highest,
            coefficients=self.updated.coefficients,
        )

    def plot_campbell(self) -> "Figure":
        """Plot the Campbell diagram. Raises PackageMissing without matplotlib."""
        from rotorundown.plots.campbell import campbell_diagram

        return campbell_diagram(self.campbell())

    def modes(self, speed_rpm: float) -> Modes:
        """Return eigenvalues and shapes at a spin speed [r/min]."""
        return modes_at(self.updated, speed=rpm_to_rad_per_s(speed_rpm))

    def response(self, speed_rpm: Sequence[float] | Floats) -> PhasorBand:
        """Return the 1× response (S, m) at the machine's probes at speeds (S,) [r/min], with 95 % bands [m]."""
        speed = np.asarray(speed_rpm, dtype=float) * rpm_to_rad_per_s(1.0)
        return forced_response(self.updated, speed=speed).band(self.updated)

    def coupling_loads(self, speed_rpm: Sequence[float] | Floats) -> tuple[CouplingForce, ...]:
        """Return the 1× forces and moments in the couplings at speeds (S,) [r/min], with 95 % bands."""
        return coupling_forces(self.updated, speed=np.asarray(speed_rpm, dtype=float) * rpm_to_rad_per_s(1.0))

    def balance_grades(self, speed_rpm: float, *, grade: float = 2.5) -> tuple[RotorBalance, ...]:
        """Return the residual unbalance per bearing plane against ISO 21940-11 and API 617. grade: G wanted [mm/s]."""
        speed = rpm_to_rad_per_s(speed_rpm)
        return balance_grades(self.updated, grade=grade, service_speed=speed, maximum_continuous_speed=speed)

    def balance(self, speed_rpm: Sequence[float] | Floats, *, planes: Sequence[str] | None = None) -> Correction:
        """Return the unbalances to add that leave least vibration at speeds (S,) [r/min]. planes: ids of discs; all by
        default."""
        wanted = [disc.id for disc in self.machine.discs] if planes is None else list(planes)
        return balance(self.updated, planes=wanted, speed=np.asarray(speed_rpm, dtype=float) * rpm_to_rad_per_s(1.0))
