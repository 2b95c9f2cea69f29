"""Results of a model as a library gives them: critical speeds, Campbell diagram, response, loads, balancing."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from estimator.machine.document import Machine
from estimator.modes.critical_speed import CriticalSpeed
from estimator.updated_model.model import UpdatedModel
from rotorundown.environment.notebook_text import notebook_text
from rotorundown.model_results.balance_correction import BalanceCorrection, balance_correction
from rotorundown.model_results.campbell_table import CampbellTable, campbell_table
from rotorundown.model_results.coupling_loads import CouplingLoads, coupling_loads_of
from rotorundown.model_results.critical_speeds import CriticalSpeedTable, critical_speeds_of, crossings_of
from rotorundown.model_results.modes_table import ModesTable, modes_table
from rotorundown.model_results.residual_unbalance import BalanceGrades, balance_grades_of
from rotorundown.model_results.speeds import SpeedsRpm, speeds_in_rpm
from rotorundown.model_results.vibration import PredictedVibration, response_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

HIGHEST_ABOVE_RANGE = 1.25
"""Highest speed of critical speeds and Campbell diagram, as a multiple of the speed range's end."""


@dataclass(frozen=True, eq=False)
class Model:
    """Results that follow from a machine's parameters, in the units of plants.

    Speeds are in r/min, one or several; each result prints as a table, has `to_frame()`, and holds the estimator's own object,
    in SI units, as `si`.

    Attributes:
        updated: The machine with values of its parameters, and their covariance.
    """

    updated: UpdatedModel

    def __str__(self) -> str:
        diagram = ("campbell", "plot_campbell")
        results = ("critical_speeds", *diagram, "modes", "response", "coupling_loads", "balance_grades", "balance")
        return f"{self.machine.id}: model with {', '.join(f'{name}()' for name in results)}"

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """Return the text for a notebook, escaped."""
        return notebook_text(self)

    @property
    def machine(self) -> Machine:
        """Return the machine."""
        return self.updated.machine

    @property
    def _highest_rpm(self) -> float:
        return HIGHEST_ABOVE_RANGE * self.machine.speed_range.maximum_rpm

    @cached_property
    def _crossings(self) -> tuple[CriticalSpeed, ...]:
        """Return the critical speeds, searched once for table and diagram."""
        return crossings_of(self.updated, highest_rpm=self._highest_rpm)

    def critical_speeds(self) -> CriticalSpeedTable:
        """Return the critical speeds up to a quarter above the speed range [r/min], with standard errors."""
        return critical_speeds_of(self.updated, self._crossings, highest_rpm=self._highest_rpm)

    def campbell(self) -> CampbellTable:
        """Return the Campbell diagram up to a quarter above the speed range: natural frequencies [cycles/min] over speed."""
        return campbell_table(self.updated, self._crossings, highest_rpm=self._highest_rpm)

    def plot_campbell(self) -> "Figure":
        """Plot the Campbell diagram. Raises PackageMissing without matplotlib."""
        from rotorundown.plots.campbell import campbell_diagram

        return campbell_diagram(self.campbell().si)

    def modes(self, speed_rpm: SpeedsRpm) -> ModesTable:
        """Return natural frequencies [cycles/min], damping and whirl at a spin speed or several [r/min]; 0 is standstill.

        Eigenvalues and shapes are in `si`, one for each speed. Raises WrongSpeed.
        """
        return modes_table(self.updated, speeds_in_rpm(speed_rpm, "modes", standstill=True))

    def response(self, speed_rpm: SpeedsRpm) -> PredictedVibration:
        """Return the 1× response of the shaft at the machine's probes at speeds [r/min], with 95 % bands.

        It is in µm peak-to-peak and degrees of lag, as runs have it. Raises WrongSpeed.
        """
        return response_of(self.updated, speeds_in_rpm(speed_rpm, "responses"))

    def coupling_loads(self, speed_rpm: SpeedsRpm) -> CouplingLoads:
        """Return the 1× forces and moments in the couplings at speeds [r/min], 0-to-peak with 95 % bands.

        Raises WrongSpeed.
        """
        return coupling_loads_of(self.updated, speeds_in_rpm(speed_rpm, "coupling loads"))

    def balance_grades(self, speed_rpm: SpeedsRpm, *, grade: float = 2.5) -> BalanceGrades:
        """Return the residual unbalance per bearing plane [g mm] against ISO 21940-11 and API 617 at speeds [r/min].

        grade: G wanted [mm/s]. Raises WrongSpeed, WrongGrade.
        """
        return balance_grades_of(self.updated, speeds_in_rpm(speed_rpm, "balance grades"), grade=grade)

    def balance(self, speed_rpm: SpeedsRpm, *, planes: Sequence[str] | str | None = None) -> BalanceCorrection:
        """Return the unbalances to add [g mm at degrees] that leave least vibration at speeds [r/min].

        planes: ids of discs; all by default. Raises WrongSpeed, WrongPlane.
        """
        return balance_correction(self.updated, speeds_in_rpm(speed_rpm, "balance corrections"), planes=planes)
