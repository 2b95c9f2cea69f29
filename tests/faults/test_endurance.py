"""Half its load for a while: nothing grows. `python -m benchmarks.faults.endurance` goes on for as long as is wanted.

A slow machine is given up to three minutes for what happens in one.
"""

import argparse
from pathlib import Path

import pytest

from benchmarks.faults import endurance

RATE = {"steady": 2500.0, "starts": 1000.0}
"""Of all machines together [1/s]: where each sample costs a share of runs and identifications, too, less is half the load."""
SAMPLES = 400
"""Of each sweep, so that a machine starts seven times in a minute."""
GROWTH_MB = 30.0
"""Between the first half and the second: on a busy machine the heap still settles in the first minutes (21 were seen), and a
minute does not tell a leak of an hour, but one of each sample would show: 48,000 samples of a kilobyte or so."""
POOLED = 10
"""Files that a pool may open in the second half of a minute; one left open by each run or answer would be hundreds."""
LOG_MB = 70.0


@pytest.mark.long
@pytest.mark.parametrize("kind", RATE)
def test_nothing_grows_at_half_load(tmp_path: Path, kind: str) -> None:
    starts, rate = kind == "starts", RATE[kind]
    options = argparse.Namespace(minutes=1.0, rate=rate, machines=10, starts=starts, samples=SAMPLES, hours_between=4.0)
    enough = {"samples": round(0.8 * rate * 60), "identifications": options.machines // 2 if starts else 0}
    found = endurance.measured(tmp_path, options, enough=enough)
    half = len(found.memory) // 2
    assert all(found.happened[what] >= count for what, count in enough.items()), (found.happened, enough)
    assert found.lost == 0
    assert max(found.memory[half:]) < max(found.memory[:half]) + GROWTH_MB
    assert max(found.files[half:]) <= max(found.files[:half]) + POOLED
    assert max(found.log) < LOG_MB
