"""Rubbish by the hundred thousand through decoding and write path into a store: what was rejected why, what memory it cost.

After each part of the cases all that is in the store is looked at: nothing that no shaft does may be there for a fit to find.

    python -m benchmarks.faults.fuzz [--cases 1000000]
"""

import argparse
import gc
import time
from pathlib import Path

import psutil

from benchmarks.chain import measure_in_a_folder
from storage.database.engine import Database
from storage.machines import machines
from tests.faults.fuzzing import CASES_AT_ONCE, Fuzzed
from tests.plant import machine

LARGEST_GROWTH_MB = 50.0
CHECKED_EVERY = 20
"""Parts after which the store is looked at."""
WARM_UP = 3
"""Parts before memory is compared: caches fill."""


def measure(folder: Path, cases: int) -> bool:
    """Send the cases and print the figures; return whether memory stayed within what is allowed."""
    database = Database(f"sqlite:///{folder / 'fuzz.db'}")
    with database.transaction() as session:
        machines.create(session, machine())
    fuzzed, process = Fuzzed(database), psutil.Process()
    began, before, largest, part = time.perf_counter(), 0.0, 0.0, 0
    while fuzzed.cases < cases:
        part += 1
        fuzzed.run(min(CASES_AT_ONCE, cases - fuzzed.cases), number=part)
        gc.collect()
        memory = process.memory_info().rss / 1e6
        if part <= WARM_UP:
            before = memory
        largest = max(largest, memory - before)
        if part % CHECKED_EVERY == 0:
            fuzzed.check()
            rate = fuzzed.cases / (time.perf_counter() - began)
            print(f"  {fuzzed.cases} cases, {rate:.0f}/s, memory {memory:.0f} MB", flush=True)
    fuzzed.check()
    database.close()
    print(f"{fuzzed.cases} cases in {time.perf_counter() - began:.0f} s; no crash; samples taken {fuzzed.taken}")
    for name, count in fuzzed.kinds.most_common():
        print(f"  sent      {name:22s} {count:9d}")
    for name, count in fuzzed.reasons.most_common():
        print(f"  rejected  {name:22s} {count:9d}")
    print(f"  memory grew by {largest:.1f} MB after {WARM_UP * CASES_AT_ONCE} cases; asked: below {LARGEST_GROWTH_MB:.0f} MB")
    return largest < LARGEST_GROWTH_MB


def main() -> None:
    """Print the figures; status 1 when memory grew too much."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--cases", type=int, default=1_000_000)
    options = parser.parse_args()
    measure_in_a_folder(lambda folder: measure(folder, options.cases))


if __name__ == "__main__":
    main()
