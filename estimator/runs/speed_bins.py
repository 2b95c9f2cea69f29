"""Rolling collection: the newest samples in each bin of the speed range, for machines whose speed wanders.

Only times are kept, so that the state is small and bounded; the samples themselves are in the store.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.machine.document import Machine
from estimator.units import rpm_to_rad_per_s

ROLLING = "rolling"
"""Kind of a run that was collected over speed bins."""


@dataclass(frozen=True)
class SpeedBins:
    """Times of the newest samples per bin of equal width from the lowest speed to the highest.

    Attributes:
        times: Times of each bin's samples, ascending [ns].
    """

    times: tuple[tuple[int, ...], ...]

    @classmethod
    def empty(cls, machine: Machine) -> "SpeedBins":
        """Return the bins of a machine without samples.

        Args:
            machine: The machine.

        Returns:
            Empty bins.
        """
        return cls(((),) * machine.collection.rolling.bins)

    def recent(self, machine: Machine, now: int) -> "SpeedBins":
        """Return the bins without samples that are older than the machine's document allows.

        Args:
            machine: The machine.
            now: Present time [ns].

        Returns:
            The bins with recent samples.
        """
        oldest = now - round(1e9 * machine.collection.rolling.recency_s)
        return SpeedBins(tuple(tuple(time for time in times if time >= oldest) for times in self.times))

    @property
    def coverage(self) -> float:
        """Return the part of the bins that hold samples [-]."""
        return sum(bool(times) for times in self.times) / len(self.times)

    @property
    def all_times(self) -> list[int]:
        """Return every time kept, ascending, each once [ns]."""
        return sorted({time for times in self.times for time in times})


def filled(bins: SpeedBins, machine: Machine, *, time: NDArray[np.int64], speed: Floats) -> SpeedBins:
    """Add new samples to the bins.

    Samples outside the speed range are left out, and those that follow the last one of their bin too closely.

    Args:
        bins: The bins.
        machine: The machine.
        time: Times (S,), ascending [ns].
        speed: Speeds (S,) [rad/s].

    Returns:
        The bins with the samples.
    """
    rules = machine.collection.rolling
    lowest, highest = (rpm_to_rad_per_s(rpm) for rpm in (machine.speed_range.minimum_rpm, machine.speed_range.maximum_rpm))
    place = np.floor((speed - lowest) / (highest - lowest) * rules.bins)
    inside = (place >= 0) & (speed <= highest)
    place = np.minimum(place, rules.bins - 1).astype(int)
    spacing = round(1e9 * rules.spacing_s)
    times = [list(one) for one in bins.times]
    for moment, index in zip(time[inside].tolist(), place[inside].tolist(), strict=True):
        if not times[index] or moment - times[index][-1] >= max(spacing, 1):
            times[index].append(moment)
    return SpeedBins(tuple(tuple(one[-rules.samples_per_bin :]) for one in times))
