"""Recorded run: the samples as they were measured."""

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats


class RecordedRun(Struct, frozen=True, eq=False):
    """A run as it was measured, S samples of m channels in order of time.

    Attributes:
        time: Times (S,) [s]; None where not known.
        speed: Spin speeds (S,) [rad/s].
        phasor: Phasors (S, m) [m].
        status: ChannelStatus of each phasor (S, m).
        scatter: Rms of the complex error (S, m) [m]; NaN where unknown.
        channels: Ids of the m channels.
    """

    time: Floats | None
    speed: Floats
    phasor: Complexes
    status: NDArray[np.uint8]
    scatter: Floats
    channels: tuple[str, ...]

    def pick(self, which: NDArray[np.bool_]) -> "RecordedRun":
        """Return some of the samples.

        Args:
            which: True for the samples wanted (S,).

        Returns:
            The run with these samples.
        """
        time = None if self.time is None else self.time[which]
        return RecordedRun(time, self.speed[which], self.phasor[which], self.status[which], self.scatter[which], self.channels)
