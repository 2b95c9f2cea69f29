"""Plausibility of one source's samples: ascending times, and speeds that a shaft can follow."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.machine.document import Machine
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s
from formats.wire import Fault
from storage.encoding.sample_blocks import Samples

FASTEST_CHANGE = 0.5
"""Largest plausible change of speed per second, as a part of the machine's maximum speed."""
JITTER = 0.08
"""Further allowance for errors of single speed readings, as a part of the maximum speed: over five times that of two of 1 %
each."""
STRIKES = 3
"""Number of consecutive implausible speeds or times that are accepted after all when they agree: the one before was wrong."""


@dataclass
class Plausibility:
    """The last plausible sample of a source: its next samples are checked against it.

    time [ns], speed [rad/s]; doubted: the last implausible speed, with its time. before: time [ns] of a known sample with a
    later number. set_back, back: the last implausible time [ns], and how many in a row ascend up to it.
    """

    time: int = 0
    before: int | None = None
    speed: float | None = None
    doubted: tuple[int, float] | None = None
    strikes: int = 0
    set_back: int | None = None
    back: int = 0

    def check(self, machine: Machine, samples: Samples, taken: NDArray[np.bool_]) -> list[Fault]:
        """Check a batch in order; clear `taken` for implausible samples and return the faults."""
        highest = rpm_to_rad_per_s(machine.speed_range.maximum_rpm)
        faults: list[Fault] = []
        for index in np.flatnonzero(taken):
            time, speed = int(samples.time[index]), float(samples.speed[index])
            fault = self._fault(int(index), time, speed, highest)
            if fault is None:
                self.time, self.speed, self.doubted, self.strikes = time, speed, None, 0
                self.set_back, self.back = None, 0
            else:
                faults.append(fault)
                taken[index] = False
        return faults

    def _fault(self, index: int, time: int, speed: float, highest: float) -> Fault | None:
        if time <= self.time and not self._was_set_back(time):
            return Fault(index, "time_out_of_order", f"time {time} ns is not after {self.time} ns, the sample before it")
        if time <= self.time:
            return None  # the speed before is unknown
        if self.before is not None and time >= self.before:
            return Fault(index, "time_out_of_order", f"time {time} ns is not before {self.before} ns, a sample after it")
        if self.speed is None or _follows((self.time, self.speed), (time, speed), highest):
            return None
        agrees = self.doubted is not None and _follows(self.doubted, (time, speed), highest)
        self.strikes = self.strikes + 1 if agrees else 1
        self.doubted = (time, speed)
        if self.strikes >= STRIKES:
            return None
        seconds = (time - self.time) / 1e9
        speeds = f"speed {rad_per_s_to_rpm(speed):.6g} r/min cannot follow {rad_per_s_to_rpm(self.speed):.6g} r/min"
        detail = f"{speeds} within {seconds:.3g} s"
        return Fault(index, "speed_out_of_order", detail)

    def _was_set_back(self, time: int) -> bool:
        """Return whether enough times in a row ascend to show that the one before was ahead, or the clock was set back."""
        ascends = self.set_back is not None and time > self.set_back
        self.back = self.back + 1 if ascends else 1
        self.set_back = time
        return self.before is None and self.back >= STRIKES


def _follows(before: tuple[int, float], after: tuple[int, float], highest: float) -> bool:
    seconds = (after[0] - before[0]) / 1e9
    return abs(after[1] - before[1]) <= highest * (FASTEST_CHANGE * seconds + JITTER)
