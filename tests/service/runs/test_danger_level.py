"""The time for which a vibration beyond its danger limit is told: a critical speed is none, and a trip keeps it."""

from collections.abc import Sequence

import numpy as np

from estimator.machine.document import Machine
from estimator.runs.operating_state import OperatingLimits, OperatingState, advance
from estimator.units import rpm_to_rad_per_s
from service.runs.danger_level import DangerWatch, watched
from storage.encoding.sample_blocks import Samples
from tests.plant import SECOND, START, machine, samples, sweep_rpm

LIMIT = 6e-5
"""0-to-peak [m]."""
NAMED = machine(operation={"vibration_danger": LIMIT, "running_rpm": 2900.0})
UNNAMED = machine(operation={"vibration_danger": LIMIT})


class VibrationRecord:
    """A machine's samples, a second apart, and what is told of them."""

    def __init__(self, pump: Machine) -> None:
        self.machine = pump
        self.limits = OperatingLimits.of(pump)
        self.state = OperatingState()
        self.watch = DangerWatch()
        self.time = START

    def go(self, rpm: Sequence[float], um_pp: Sequence[float], *, step: int = SECOND) -> DangerWatch:
        """Turn at speeds with amplitudes at the second channel; the state goes through its stored form each time."""
        new = samples(len(rpm), start=self.time, step=step, rpm=rpm)
        phasor = np.full_like(new.phasor, 1e-5)
        phasor[:, 1] = np.array(um_pp) / 2e6
        new = Samples(new.time, new.speed, new.direction, phasor, new.status, new.scatter, new.second)
        modes = []
        for moment, speed in zip(new.time.tolist(), new.speed.tolist(), strict=True):
            self.state, _ = advance(self.state, self.limits, time=moment, speed=speed, direction=1)
            modes.append(self.state.mode)
        self.watch = DangerWatch.restored(watched(self.watch, self.machine, new, modes).stored())
        self.time = int(new.time[-1]) + step
        return self.watch

    def hold(self, *um_pp: float, rpm: float = 2900.0) -> bool:
        """Turn at one speed; return whether a danger is told then."""
        return self.go([rpm] * len(um_pp), um_pp).told is not None


def run_down(rpm: Sequence[float], *, peak_um_pp: float) -> list[float]:
    """Amplitudes that are large at the middle of the speeds."""
    middle = float(np.mean(rpm))
    return [peak_um_pp if abs(one - middle) < 300.0 else 50.0 for one in rpm]


def test_a_critical_speed_that_is_passed_is_none() -> None:
    for pump in (NAMED, UNNAMED):
        record = VibrationRecord(pump)
        assert not record.hold(*[50.0] * 10)
        down = sweep_rpm(2890.0, 310.0, 60)
        assert record.go(down, run_down(down, peak_um_pp=400.0)).told is None
        assert record.watch.exceeding is None


def test_three_samples_at_running_speed_are_one_and_a_single_one_is_not() -> None:
    record = VibrationRecord(NAMED)
    assert not record.hold(50.0, 150.0, 50.0, 150.0, 150.0, 50.0)
    assert record.hold(150.0, 170.0, 150.0)
    told = record.watch.told
    assert told is not None
    assert (told.channel, told.amplitude, told.limit) == ("B2Y", 85e-6, LIMIT)
    assert told.speed == rpm_to_rad_per_s(2900.0)
    assert told.last - told.first == 2 * SECOND


def test_a_trip_keeps_it_until_the_machine_runs_below_the_limit_again() -> None:
    for pump in (NAMED, UNNAMED):
        record = VibrationRecord(pump)
        assert not record.hold(*[50.0] * 10)
        assert record.hold(*[200.0] * 5)
        down = sweep_rpm(2880.0, 10.0, 60)
        assert record.go(down, [20.0] * 60).told is not None, "it slowed down, and nobody has looked"
        assert record.hold(*[0.5] * 300, rpm=1.0), "it stands still"
        up = sweep_rpm(30.0, 2880.0, 60)
        assert record.go(up, run_down(up, peak_um_pp=400.0)).told is not None
        assert record.hold(*[50.0] * 200, *[200.0], *[50.0] * 299)
        assert not record.hold(*[50.0] * 60)


def test_a_minute_beyond_the_limit_is_one_at_any_speed() -> None:
    record = VibrationRecord(NAMED)
    up = sweep_rpm(310.0, 1500.0, 30)
    assert record.go(up, [50.0] * 30).told is None
    assert not record.hold(*[150.0] * 60, rpm=1500.0)
    assert record.hold(150.0, rpm=1500.0)


def test_what_was_before_a_silence_does_not_last_through_it() -> None:
    record = VibrationRecord(NAMED)
    record.go([1500.0], [150.0])
    record.watch = record.watch.interrupted()
    record.time += 3600 * SECOND
    assert not record.hold(150.0, rpm=1500.0)


def test_samples_without_a_good_phasor_change_nothing() -> None:
    record = VibrationRecord(NAMED)
    record.hold(*[150.0] * 3)
    nothing = samples(5, start=record.time, rpm=[2900.0] * 5)
    bad = Samples(
        nothing.time,
        nothing.speed,
        nothing.direction,
        nothing.phasor,
        np.full_like(nothing.status, nothing.status[0, 0]),
        nothing.scatter,
        nothing.second,
    )
    assert watched(record.watch, NAMED, bad, ["at speed"] * 5) == record.watch
