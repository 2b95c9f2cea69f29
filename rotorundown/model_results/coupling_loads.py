"""Loads that a model has its couplings carry."""

import math
from dataclasses import dataclass

import msgspec

from estimator.arrays import Floats
from estimator.units import RAD_PER_S
from estimator.updated_model.coupling_loads import CouplingForce, coupling_forces
from estimator.updated_model.model import UpdatedModel
from rotorundown.model_results.origin import origin_notes, require_unbalance
from rotorundown.model_results.result_tables import Cells, RowTable, figure
from rotorundown.model_results.vibration import lag_deg, whole_degrees

LOADS = {
    "force_x": "N",
    "force_y": "N",
    "moment_x": "N m",
    "moment_y": "N m",
    "force": "N",
    "moment": "N m",
}
"""Unit of each load."""
LARGEST = ("force", "moment")
"""Loads along the major axis of their ellipses."""


class CouplingLoadRow(msgspec.Struct, frozen=True):
    """A 1× load of a coupling at a speed.

    Attributes:
        coupling: Id of the coupling.
        speed_rpm: Speed [r/min].
        load: Name of the load: `force_x`, `force_y`, `moment_x` and `moment_y` are along and about the axes, `force` and
            `moment` the largest in a turn.
        amplitude: Its amplitude, 0-to-peak [unit].
        lower: Lower end of its 95 % band [unit].
        upper: Upper end of its 95 % band [unit].
        unit: Unit of amplitude and band.
        lag_deg: Phase lag of the load [°]; not a number of the largest in a turn.
    """

    coupling: str
    speed_rpm: float
    load: str
    amplitude: float
    lower: float
    upper: float
    unit: str
    lag_deg: float


@dataclass(frozen=True, eq=False, repr=False)
class CouplingLoads(RowTable[CouplingLoadRow]):
    """Loads of couplings at one speed or several.

    Attributes:
        title: Title of the table.
        rows: The loads.
        si: The estimator's own loads of each coupling, as phasors.
        notes: Notes on where they come from.
    """

    title: str
    rows: tuple[CouplingLoadRow, ...]
    si: tuple[CouplingForce, ...]
    notes: tuple[str, ...] = ()
    kind = CouplingLoadRow

    def _cells(self) -> Cells:
        return {
            "coupling": [one.coupling for one in self.rows],
            "r/min": [f"{one.speed_rpm:.0f}" for one in self.rows],
            "load": [one.load for one in self.rows],
            "0-to-peak": [figure(one.amplitude) for one in self.rows],
            "95 % from": [figure(one.lower) for one in self.rows],
            "to": [figure(one.upper) for one in self.rows],
            "unit": [one.unit for one in self.rows],
            "lag [°]": ["-" if math.isnan(one.lag_deg) else whole_degrees(one.lag_deg) for one in self.rows],
        }


def coupling_loads_of(model: UpdatedModel, speed_rpm: Floats) -> CouplingLoads:
    """Return the 1× forces and moments in a model's couplings at speeds (S,) [r/min], with 95 % bands.

    Raises UnbalanceUnknown.
    """
    require_unbalance(model)
    found = coupling_forces(model, speed=speed_rpm * RAD_PER_S["rpm"])
    rows = [row for one in found for place, rpm in enumerate(speed_rpm) for row in _rows(one, place, float(rpm))]
    title = f"{model.machine.id}: 1× loads of couplings, 0-to-peak (force, moment: the largest in a turn)"
    return CouplingLoads(title, tuple(rows), found, origin_notes(model))


def _rows(found: CouplingForce, place: int, rpm: float) -> list[CouplingLoadRow]:
    rows = []
    for load, unit in LOADS.items():
        band = getattr(found, load)
        # The largest in a turn lies along an axis of its own, whose sense nothing fixes, nor the sign of its phase.
        lag = math.nan if load in LARGEST else float(lag_deg(band.value)[place])
        amplitude, lower, upper = (float(part[place]) for part in (band.amplitude, band.lower, band.upper))
        rows.append(CouplingLoadRow(found.coupling, rpm, load, amplitude, lower, upper, unit, lag))
    return rows
