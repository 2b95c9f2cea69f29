"""Critical speeds of a model."""

from dataclasses import dataclass

import msgspec

from estimator.modes.critical_speed import CriticalSpeed, critical_speed_table
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s
from estimator.updated_model.modal_uncertainty import critical_speed_errors
from estimator.updated_model.model import UpdatedModel
from rotorundown.model_results.origin import origin_notes
from rotorundown.model_results.result_tables import Cells, RowTable, error_figure


class CriticalSpeedRow(msgspec.Struct, frozen=True):
    """A critical speed.

    Attributes:
        speed_rpm: The speed [r/min].
        standard_error_rpm: Its standard error [r/min]; 0 of a model that nothing was measured of.
        damping_ratio: Damping ratio [-].
        log_decrement: Logarithmic decrement [-].
        whirl: Sense of whirl from +1 forward to -1 backward [-].
    """

    speed_rpm: float
    standard_error_rpm: float
    damping_ratio: float
    log_decrement: float
    whirl: float


@dataclass(frozen=True, eq=False, repr=False)
class CriticalSpeedTable(RowTable[CriticalSpeedRow]):
    """Critical speeds, ascending.

    Attributes:
        title: Title of the table.
        rows: The critical speeds.
        si: The estimator's own, in SI units.
        notes: Notes on where they come from.
    """

    title: str
    rows: tuple[CriticalSpeedRow, ...]
    si: tuple[CriticalSpeed, ...]
    notes: tuple[str, ...] = ()
    kind = CriticalSpeedRow

    def _cells(self) -> Cells:
        return {
            "r/min": [f"{one.speed_rpm:.0f}" for one in self.rows],
            "± standard error": [error_figure(one.standard_error_rpm) for one in self.rows],
            "damping ratio": [f"{one.damping_ratio:.4f}" for one in self.rows],
            "log decrement": [f"{one.log_decrement:.3f}" for one in self.rows],
            "whirl": [f"{one.whirl:+.2f}" for one in self.rows],
        }


def crossings_of(model: UpdatedModel, *, highest_rpm: float) -> tuple[CriticalSpeed, ...]:
    """Find the critical speeds of a model up to a speed [r/min]."""
    highest = rpm_to_rad_per_s(highest_rpm)
    return critical_speed_table(model.scaled_machine, highest=highest, coefficients=model.coefficients)


def critical_speeds_of(model: UpdatedModel, crossings: tuple[CriticalSpeed, ...], *, highest_rpm: float) -> CriticalSpeedTable:
    """Return the critical speeds of a model up to a speed [r/min], with standard errors."""
    rows = tuple(
        CriticalSpeedRow(
            rad_per_s_to_rpm(one.speed), rad_per_s_to_rpm(float(error)), one.damping_ratio, one.log_decrement, one.whirl
        )
        for one, error in zip(crossings, critical_speed_errors(model, crossings), strict=True)
    )
    title = f"{model.machine.id}: critical speeds up to {highest_rpm:.0f} r/min (whirl +1 forward to -1 backward)"
    return CriticalSpeedTable(title, rows, crossings, origin_notes(model))
