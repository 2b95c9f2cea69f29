"""Campbell diagram of a model, as a table."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from estimator.arrays import Floats
from estimator.modes.campbell import Campbell, campbell
from estimator.modes.critical_speed import CriticalSpeed
from estimator.units import RAD_PER_S, rad_per_s_to_rpm, rpm_to_rad_per_s
from estimator.updated_model.model import UpdatedModel
from rotorundown.model_results.origin import origin_notes
from rotorundown.model_results.result_tables import Cells, ResultTable

SPEEDS = 40
"""Number of speeds."""
PRINTED_SPEEDS = 8
"""Number of speeds that are printed."""


@dataclass(frozen=True, eq=False, repr=False)
class CampbellTable(ResultTable):
    """Natural frequencies of n modes over S speeds.

    Attributes:
        title: Title of the table.
        si: The estimator's own diagram, in SI units, with the critical speeds.
        notes: Notes on where it comes from.
    """

    title: str
    si: Campbell
    notes: tuple[str, ...] = ()

    @property
    def speed_rpm(self) -> Floats:
        """Return the speeds (S,) [r/min]."""
        return np.asarray(self.si.speed / RAD_PER_S["rpm"])

    @property
    def frequency_cpm(self) -> Floats:
        """Return the damped natural frequencies (S, n) [cycles/min], NaN where a mode is overdamped."""
        return np.asarray(self.si.frequency / RAD_PER_S["rpm"])

    @property
    def critical_speed_rpm(self) -> Floats:
        """Return the critical speeds, where a frequency equals the speed [r/min]."""
        return np.array([rad_per_s_to_rpm(one.speed) for one in self.si.critical_speeds])

    def _columns(self) -> Mapping[str, Sequence[Any] | Floats]:
        speeds, modes = self.si.eigenvalue.shape
        return {
            "mode": np.repeat(np.arange(1, modes + 1), speeds),
            "speed_rpm": np.tile(self.speed_rpm, modes),
            "frequency_cpm": self.frequency_cpm.T.ravel(),
            "damping_ratio": self.si.damping_ratio.T.ravel(),
            "log_decrement": self.si.log_decrement.T.ravel(),
            "whirl": self.si.whirl.T.ravel(),
        }

    def _cells(self) -> Cells:
        shown = np.unique(np.linspace(0, self.speed_rpm.size - 1, PRINTED_SPEEDS).round().astype(int))
        modes = range(self.si.eigenvalue.shape[1])
        cells = {"mode": [str(mode + 1) for mode in modes]}
        for place in map(int, shown):
            row = self.frequency_cpm[place]
            cells[f"{self.speed_rpm[place]:.0f}"] = ["-" if np.isnan(one) else f"{one:.0f}" for one in row]
        return cells | {"whirl": ["-" if np.isnan(one) else f"{one:+.2f}" for one in self.si.whirl[-1]]}


def campbell_table(model: UpdatedModel, crossings: tuple[CriticalSpeed, ...], *, highest_rpm: float) -> CampbellTable:
    """Return the Campbell diagram of a model up to a speed, and a frequency as high [r/min].

    crossings: its critical speeds up to there.
    """
    highest = rpm_to_rad_per_s(highest_rpm)
    found = campbell(
        model.scaled_machine,
        speed=np.linspace(0.0, highest, SPEEDS),
        highest_frequency=highest,
        coefficients=model.coefficients,
        crossings=crossings,
    )
    title = f"{model.machine.id}: natural frequencies [cycles/min] over speeds [r/min]; whirl at the last"
    return CampbellTable(title, found, origin_notes(model))
