"""The long form of `tests/faults`: real processes killed in every order, frozen, cut off and fed with damaged messages.

Every line is one scenario after which the store was compared with what was measured, sample by sample, to the bit; of alerts,
what was told with what happened, event by event.

    python -m benchmarks.faults [--rounds 1] [--only killed]
"""

import argparse
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from tests.faults import scenarios, telling
from tests.faults.chain import PARTS, every_order


def every_scenario(rounds: int) -> Iterator[tuple[str, Callable[[Path], object]]]:
    """Their names, and what to call."""
    for order in every_order():
        name = "killed " + ", ".join(order)
        yield name, lambda folder, order=order: scenarios.killed_in_turn(folder, order, samples=1000)
    for part in PARTS:
        name = f"frozen for 15 s: {part}"
        yield name, lambda folder, part=part: scenarios.frozen(folder, part, seconds=15.0, samples=2500)
    yield "wire held for 15 s, then broken", lambda folder: scenarios.parted(folder, seconds=15.0, samples=2500)
    for seed in range(rounds):
        name = f"killed at random eight times, seed {seed}"
        yield name, lambda folder, seed=seed: scenarios.killed_at_random(folder, seed=seed, kills=8, samples=3000)
        name = f"mangled, with a log, seed {seed}"
        yield name, lambda folder, seed=seed: scenarios.mangled_with_log(folder, seed=seed, samples=10_000)
        name = f"mangled, without a log, seed {seed}"
        yield name, lambda folder, seed=seed: scenarios.mangled_without_log(folder, seed=seed, samples=10_000)
        name = f"alerts told through 20 kills, seed {seed}"
        yield name, lambda folder, seed=seed: telling.told_through_kills(folder, seed=seed, kills=20)


def main() -> None:
    """Print a line a scenario; status 1 when a store was not exact."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--rounds", type=int, default=1, help="seeds of the random ones")
    parser.add_argument("--only", default="", help="scenarios whose name contains this")
    options = parser.parse_args()
    wrong = 0
    for name, act in every_scenario(options.rounds):
        if options.only not in name:
            continue
        began = time.perf_counter()
        with tempfile.TemporaryDirectory() as folder:
            try:
                act(Path(folder))
                outcome = "exact"
            except AssertionError as error:
                outcome, wrong = f"NOT exact: {str(error)[:300]}", wrong + 1
        print(f"{name:42s} {time.perf_counter() - began:5.1f} s  {outcome}", flush=True)
    if wrong:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
