"""Samples of one source in the order of time, with speeds that a shaft can follow."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.machine.document import Machine
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s
from service.wire import Fault
from storage.encoding.sample_blocks import Samples

FASTEST_CHANGE = 0.5
"""Largest change of speed that is believed: this part of the machine's maximum speed in a second, …"""
JITTER = 0.08
"""… and this part of it on top, for the errors of single speed readings: more than five times that of two of 1 % each."""
STRIKES = 3
"""So many speeds, or times, in a row that agree with each other are believed after all: the one before them was wrong."""


@dataclass
class Plausibility:
    """What was last believed of one source, against which its next samples are checked.

    time [ns], speed [rad/s]; doubted: the last speed not believed.

    before: time [ns] of a sample that comes later in number and is known already. set_back, back: the last time that
    was not believed [ns], and how many in a row ascend up to it.
    """

    time: int = 0
    before: int | None = None
    speed: float | None = None
    doubted: tuple[int, float] | None = None
    strikes: int = 0
    set_back: int | None = None
    back: int = 0

    def check(self, machine: Machine, samples: Samples, taken: NDArray[np.bool_]) -> list[Fault]:
        """Go through a batch in order; clear `taken` where a sample is not believed and return why."""
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
            return None  # nothing is known of the speed before
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
        speeds = f"speed {rad_per_s_to_rpm(speed):.6g} rpm cannot follow {rad_per_s_to_rpm(self.speed):.6g} rpm"
        detail = f"{speeds} within {seconds:.3g} s"
        return Fault(index, "speed_out_of_order", detail)

    def _was_set_back(self, time: int) -> bool:
        """Return whether so many times in a row ascend that the one before was ahead, or the clock was set back."""
        ascends = self.set_back is not None and time > self.set_back
        self.back = self.back + 1 if ascends else 1
        self.set_back = time
        return self.before is None and self.back >= STRIKES


def _follows(before: tuple[int, float], after: tuple[int, float], highest: float) -> bool:
    seconds = (after[0] - before[0]) / 1e9
    return abs(after[1] - before[1]) <= highest * (FASTEST_CHANGE * seconds + JITTER)
