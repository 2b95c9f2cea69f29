"""1× vibration of a model at its probes, over speed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.units import METRES, PEAK, RAD_PER_S
from estimator.updated_model.forced_response import forced_response
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.uncertainty import PhasorBand
from rotorundown.model_results.origin import origin_notes, require_unbalance
from rotorundown.model_results.result_tables import MOST_ROWS, Cells, ResultTable, figure

MICROMETRES_PP = METRES["um"] * PEAK["peak-to-peak"]


@dataclass(frozen=True, eq=False, repr=False)
class PredictedVibration(ResultTable):
    """1× vibration of the shaft at m channels over S speeds, in µm peak-to-peak and degrees of lag as runs have them.

    Attributes:
        title: Title of the table.
        channels: Ids of the m channels.
        speed_rpm: Speeds (S,) [r/min].
        si: The estimator's own phasors with their bands, in SI units.
        notes: Notes on where they come from.
    """

    title: str
    channels: tuple[str, ...]
    speed_rpm: Floats
    si: PhasorBand
    notes: tuple[str, ...] = ()

    @property
    def amplitude_um_pp(self) -> Floats:
        """Return the amplitudes (S, m) [µm peak-to-peak]."""
        return np.asarray(self.si.amplitude / MICROMETRES_PP)

    @property
    def phase_lag_deg(self) -> Floats:
        """Return the phase lags (S, m) [°], from 0 to 360."""
        return lag_deg(self.si.value)

    @property
    def lower_um_pp(self) -> Floats:
        """Return the lower ends (S, m) of the amplitudes' 95 % bands [µm peak-to-peak]."""
        return np.asarray(self.si.lower / MICROMETRES_PP)

    @property
    def upper_um_pp(self) -> Floats:
        """Return the upper ends (S, m) of the amplitudes' 95 % bands [µm peak-to-peak]."""
        return np.asarray(self.si.upper / MICROMETRES_PP)

    def _columns(self) -> Mapping[str, Sequence[Any] | Floats]:
        columns: dict[str, Floats] = {"speed_rpm": self.speed_rpm}
        parts = {"um_pp": self.amplitude_um_pp, "lag_deg": self.phase_lag_deg}
        bands = {"lower_um_pp": self.lower_um_pp, "upper_um_pp": self.upper_um_pp}
        for number, channel in enumerate(self.channels):
            columns |= {f"{channel}_{name}": values[:, number] for name, values in (parts | bands).items()}
        return columns

    def _cells(self) -> Cells:
        """Return a row for each speed and channel, or where these are many for the largest amplitude of each channel."""
        speeds, channels = self.amplitude_um_pp.shape
        largest = speeds * channels > MOST_ROWS
        places = list(enumerate(self.amplitude_um_pp.argmax(axis=0))) if largest else list(_every(speeds, channels))
        told = [(int(row), column) for column, row in places]
        return {
            "largest of" if largest else "channel": [self.channels[column] for _, column in told],
            "at r/min": [f"{self.speed_rpm[row]:.0f}" for row, _ in told],
            "µm pp": [figure(float(self.amplitude_um_pp[place])) for place in told],
            "95 % from": [figure(float(self.lower_um_pp[place])) for place in told],
            "to": [figure(float(self.upper_um_pp[place])) for place in told],
            "lag [°]": [whole_degrees(float(self.phase_lag_deg[place])) for place in told],
        }


def response_of(model: UpdatedModel, speed_rpm: Floats) -> PredictedVibration:
    """Return the 1× response of a model at its probes at speeds (S,) [r/min], with 95 % bands. Raises UnbalanceUnknown."""
    require_unbalance(model)
    found = forced_response(model, speed=speed_rpm * RAD_PER_S["rpm"]).band(model)
    title = f"{model.machine.id}: 1× of the shaft at its probes [µm peak-to-peak, phase lag]"
    return PredictedVibration(title, model.machine.channels, speed_rpm, found, origin_notes(model))


def lag_deg(value: Complexes) -> Floats:
    """Return the phase lags (...) of phasors [°], from 0 to 360."""
    return np.asarray(-np.degrees(np.angle(value)) % 360.0 % 360.0)


def whole_degrees(angle: float) -> str:
    """Return an angle without decimals, nearly a full turn as 0."""
    return f"{round(angle) % 360}"


def _every(speeds: int, channels: int) -> list[tuple[int, int]]:
    return [(column, row) for row in range(speeds) for column in range(channels)]
