"""States and runs told from noisy speeds: how often every one of a cycle comes out, and what a sample costs.

`python -m benchmarks.estimator.states [--seeds N]`: cycles of standstill, slow roll, run-up, hold, run-down at several
sampling rates. A cycle is right when the states are the seven that it passes, in order, and its runs are one run-up and one
run-down.
"""

import argparse
import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from estimator.machine.rules import SpeedRange
from estimator.runs.operating_state import ModeChanged, OperatingEvent, OperatingLimits, OperatingState, advance
from estimator.runs.segmentation import RunEnded, SweepLimits
from estimator.units import rpm_to_rad_per_s

LOWEST, HIGHEST, TOP = 300.0, 3000.0, 2900.0
"""Limits of the speed range, and the speed of the hold [r/min]."""
STATES = ["stopped", "slow roll", "run-up", "at speed", "run-down", "slow roll", "stopped"]
NOISES = (0.0, 0.002, 0.005, 0.01, 0.015, 0.02)
STEPS = (0.2, 1.0, 5.0)
"""Time between samples [s]."""
UP, DOWN = 280.0, 290.0
"""Duration of the sweeps [s]."""


@dataclass(frozen=True)
class Tally:
    """Number of cycles whose runs were right, and errors of the runs' beginnings and ends [s]."""

    right: int
    began: list[float]
    ended: list[float]


def cycle(step: float) -> Iterator[tuple[float, float]]:
    """Yield seconds and speeds [r/min]."""
    knots = np.cumsum([0.0, 60.0, 20.0, 60.0, UP, 400.0, DOWN, 120.0])
    speeds = [0.0, 0.0, 100.0, 100.0, TOP, TOP, 0.0, 0.0]
    for second in np.arange(0.0, knots[-1], step).tolist():
        yield second, float(np.interp(second, knots, speeds))


def limits() -> OperatingLimits:
    """Return the limits of the simulated machine."""
    return OperatingLimits(
        SweepLimits.of(SpeedRange(minimum_rpm=LOWEST, maximum_rpm=HIGHEST)), rpm_to_rad_per_s(0.01 * HIGHEST), None
    )


def follow(step: float, noise: float, *, of_reading: bool, seed: int) -> list[OperatingEvent]:
    """Return the events of one cycle with noisy speed readings."""
    rng = np.random.default_rng(seed)
    state = OperatingState()
    events: list[OperatingEvent] = []
    told = limits()
    for second, rpm in cycle(step):
        size = noise * (rpm if of_reading else HIGHEST * (rpm > 0))
        reading = max(0.0, rpm + size * float(rng.standard_normal()))
        moment = round(1e9 * (second + 1.0))
        state, new = advance(state, told, time=moment, speed=rpm_to_rad_per_s(reading), direction=1)
        events += new
    return events


def tally(step: float, noise: float, *, of_reading: bool, seeds: int) -> Tally:
    """Count the cycles with the right states and runs, with the errors of the runs' times."""
    up = 1.0 + 140.0 + UP * (LOWEST - 100.0) / (TOP - 100.0)
    down = 1.0 + 140.0 + UP + 400.0
    true = {"run-up": (up, 141.0 + UP), "run-down": (down, down + DOWN * (TOP - LOWEST) / TOP)}
    right, began, ended = 0, [], []
    for seed in range(seeds):
        events = follow(step, noise, of_reading=of_reading, seed=seed)
        runs = [event for event in events if isinstance(event, RunEnded)]
        modes = [event.mode for event in events if isinstance(event, ModeChanged)]
        if modes != STATES or [run.kind for run in runs] != ["run-up", "run-down"]:
            continue
        right += 1
        began += [run.start / 1e9 - true[run.kind][0] for run in runs]
        ended += [run.time / 1e9 - true[run.kind][1] for run in runs]
    return Tally(right, began, ended)


def cost() -> float:
    """Return the seconds of this process per sample, at constant speed with 1 % of noise."""
    rng = np.random.default_rng(0)
    speeds = (300.0 + 3.0 * rng.standard_normal(20_000)).tolist()
    state, told = OperatingState(), limits()
    began = time.process_time()
    for number, speed in enumerate(speeds, start=1):
        state, _ = advance(state, told, time=number * 100_000_000, speed=speed, direction=1)
    return (time.process_time() - began) / len(speeds)


def main(given: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=10)
    seeds = parser.parse_args(given).seeds
    print(f"Cycles of which every state and run came out, of {seeds} (seeds 0 to {seeds - 1}); median and worst error [s]\n")
    print("noise, rms              step [s]   right   a run begins        a run ends")
    for of_reading in (True, False):
        for noise in NOISES:
            for step in STEPS:
                found = tally(step, noise, of_reading=of_reading, seeds=seeds if noise else 1)
                name = f"{100 * noise:.1f} % of {'the speed' if of_reading else 'the highest'}"
                print(f"{name:<24} {step:5.1f}   {found.right:4d}    {_errors(found.began)}   {_errors(found.ended)}")
    print(f"\nOne sample: {1e6 * cost():.0f} µs")


def _errors(values: list[float]) -> str:
    if not values:
        return f"{'':>16}"
    return f"{np.median(values):+6.1f} {max(values, key=abs):+8.1f}  "


if __name__ == "__main__":
    main()
