"""Peaks of the response that an updated model predicts, with their separation from the service speed."""

import numpy as np

from estimator.units import rpm_to_rad_per_s
from estimator.updated_model.amplification import SeparationMargin, amplification
from rotorundown.machine_model import HIGHEST_ABOVE_RANGE, Model


def response_peaks(model: Model, *, service_rpm: float) -> list[tuple[str, SeparationMargin]]:
    """Return each peak with its channel, up to a quarter above the speed range. service_rpm: the service speed [r/min]."""
    machine, speed = model.machine, rpm_to_rad_per_s(service_rpm)
    margins = amplification(
        model.updated,
        places=machine.probes,
        lowest=rpm_to_rad_per_s(machine.speed_range.minimum_rpm),
        highest=rpm_to_rad_per_s(HIGHEST_ABOVE_RANGE * machine.speed_range.maximum_rpm),
        minimum_speed=speed,
        maximum_continuous_speed=speed,
        crossings=np.array([one.eigenvalue for one in model.critical_speeds().si], dtype=complex),
    )
    return [(channel, one) for channel, peaks in zip(machine.channels, margins, strict=True) for one in peaks]
