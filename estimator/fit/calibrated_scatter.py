"""Errors of phasors as a calibration has found them, where their source does not state any."""

import numpy as np
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.machine.document import Machine
from estimator.phasors.measurement import Measurement
from estimator.phasors.noise import error_size
from estimator.units import rpm_to_rad_per_s

NEAR = 0.05
"""Relative difference of speeds within which the scatter found at one speed counts at another [-]."""


def with_calibrated_scatter(machine: Machine, measurement: Measurement) -> Measurement:
    """Return a measurement with the scatter that the machine's calibration found, where it has none of its own.

    Args:
        machine: The machine.
        measurement: Its S samples of m channels.

    Returns:
        The measurement; the same one where there is no calibration.
    """
    if machine.calibration is None:
        return measurement
    modelled = error_size(machine.noise, np.abs(measurement.phasor), np.full(measurement.phasor.shape, np.nan))
    found = np.stack(
        [
            _scatter(machine, channel, measurement.speed, modelled[:, column])
            for column, channel in enumerate(machine.channels)
        ],
        axis=1,
    )
    return replace(measurement, scatter=np.where(measurement.scatter > 0.0, measurement.scatter, found))


def _scatter(machine: Machine, channel: str, speed: Floats, modelled: Floats) -> Floats:
    """Return a channel's rms errors (S,) [m]; NaN where its calibration says nothing."""
    said = () if machine.calibration is None else machine.calibration.scatter
    factor = [one.rms for one in said if one.channel == channel and one.rpm is None]
    found = factor[0] * modelled if factor else np.full(speed.size, np.nan)
    dwells = [(rpm_to_rad_per_s(one.rpm), one.rms) for one in said if one.channel == channel and one.rpm is not None]
    if not dwells:
        return found
    speeds, rms = np.array(dwells).T
    away = np.abs(np.log(speed[:, None] / speeds))
    nearest = np.argmin(away, axis=1)
    return np.where(away[np.arange(speed.size), nearest] <= NEAR, rms[nearest], found)
