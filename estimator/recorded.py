"""A run as it was measured."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats


@dataclass(frozen=True)
class RecordedRun:
    """A run as it was measured, S samples in order of time.

    time: (S,) [s], None where it is not known. speed: (S,) [rad/s]. phasor: (S, m) [m]. status: (S, m) ChannelStatus.
    scatter: (S, m) [m], NaN where unknown. channels: m ids.
    """

    time: Floats | None
    speed: Floats
    phasor: Complexes
    status: NDArray[np.uint8]
    scatter: Floats
    channels: tuple[str, ...]

    def pick(self, which: NDArray[np.bool_]) -> "RecordedRun":
        """Some of the samples, (S,) True for those wanted."""
        time = None if self.time is None else self.time[which]
        return RecordedRun(time, self.speed[which], self.phasor[which], self.status[which], self.scatter[which], self.channels)
