"""Modes of a model at some speeds."""

from dataclasses import dataclass

import msgspec

from estimator.arrays import Floats
from estimator.modes.eigenmodes import Modes, log_decrement
from estimator.rotor.assembly import PEDESTAL_TILT
from estimator.rotor.whirl import whirl
from estimator.units import RAD_PER_S, rpm_to_rad_per_s
from estimator.updated_model.modal_uncertainty import modes_at, natural_frequency_errors
from estimator.updated_model.model import HIGHEST_FREQUENCY, UpdatedModel
from rotorundown.model_results.origin import origin_notes
from rotorundown.model_results.result_tables import Cells, RowTable, error_figure

TILTING_CPM = 0.99 * PEDESTAL_TILT / RAD_PER_S["rpm"]
"""Frequency from which modes are those of tilts that pedestals do not have [cycles/min]."""


class ModeRow(msgspec.Struct, frozen=True):
    """A mode at a spin speed.

    Attributes:
        speed_rpm: Spin speed [r/min].
        mode: Number of the mode at this speed, by frequency.
        frequency_cpm: Damped natural frequency [cycles/min].
        standard_error_cpm: Its standard error [cycles/min]; 0 of a model that nothing was measured of.
        damping_ratio: Damping ratio [-]; negative of a mode that grows.
        log_decrement: Logarithmic decrement [-].
        whirl: Sense of whirl from +1 forward to -1 backward [-].
    """

    speed_rpm: float
    mode: int
    frequency_cpm: float
    standard_error_cpm: float
    damping_ratio: float
    log_decrement: float
    whirl: float


@dataclass(frozen=True, eq=False, repr=False)
class ModesTable(RowTable[ModeRow]):
    """Modes at one speed or several, by ascending frequency.

    Attributes:
        title: Title of the table.
        rows: The modes of the train.
        si: The estimator's own modes for each speed, in SI units, with shapes.
        printed_cpm: Frequency up to which modes are printed [cycles/min]; the frame has all.
        notes: Notes on where they come from.
    """

    title: str
    rows: tuple[ModeRow, ...]
    si: tuple[Modes, ...]
    printed_cpm: float
    notes: tuple[str, ...] = ()
    kind = ModeRow

    def _cells(self) -> Cells:
        shown = [one for one in self.rows if one.frequency_cpm <= self.printed_cpm]
        return {
            "r/min": [f"{one.speed_rpm:.0f}" for one in shown],
            "mode": [str(one.mode) for one in shown],
            "cycles/min": [f"{one.frequency_cpm:.0f}" for one in shown],
            "± standard error": [error_figure(one.standard_error_cpm) for one in shown],
            "damping ratio": [f"{one.damping_ratio:.4f}" for one in shown],
            "log decrement": [f"{one.log_decrement:.3f}" for one in shown],
            "whirl": [f"{one.whirl:+.2f}" for one in shown],
        }


def modes_table(model: UpdatedModel, speed_rpm: Floats) -> ModesTable:
    """Return the modes of a model at speeds (S,) [r/min], with standard errors of their frequencies."""
    found = tuple(modes_at(model, speed=rpm_to_rad_per_s(float(one))) for one in speed_rpm)
    rows = [row for rpm, modes in zip(speed_rpm, found, strict=True) for row in _rows(model, float(rpm), modes)]
    printed = HIGHEST_FREQUENCY * model.machine.speed_range.maximum_rpm
    title = f"{model.machine.id}: modes up to {printed:.0f} cycles/min (whirl +1 forward to -1 backward)"
    return ModesTable(title, tuple(rows), found, printed, origin_notes(model))


def _rows(model: UpdatedModel, rpm: float, found: Modes) -> list[ModeRow]:
    speed = rpm_to_rad_per_s(rpm)
    errors = natural_frequency_errors(model, found, speed=speed)
    senses = whirl(found.shape, model.matrices(speed).mass, direction=model.machine.direction)
    columns = (
        found.eigenvalue.imag / RAD_PER_S["rpm"],
        errors / RAD_PER_S["rpm"],
        found.damping_ratio,
        log_decrement(found.eigenvalue),
        senses,
    )
    rows = enumerate(zip(*columns, strict=True), 1)
    return [ModeRow(rpm, number, *map(float, row)) for number, row in rows if row[0] < TILTING_CPM]
