"""Half its load for a while: nothing grows. `python -m benchmarks.faults.endurance` goes on for as long as is wanted."""

import argparse
from pathlib import Path

import pytest

from benchmarks.faults import endurance

RATE = 2500.0
GROWTH_MB = 30.0
"""Between the first half and the second: on a busy machine the heap still settles in the first minutes (21 were seen), and a
minute does not tell a leak of an hour, but one of each sample would show: 75,000 samples of a kilobyte or so."""
POOLED = 10
"""Files that a pool may open in the second half of a minute; one left open by each run or answer would be hundreds."""
LOG_MB = 70.0


@pytest.mark.long
@pytest.mark.parametrize("starts", [False, True], ids=["steady", "starts"])
def test_nothing_grows_at_half_load(tmp_path: Path, starts: bool) -> None:
    options = argparse.Namespace(minutes=1.0, rate=RATE, machines=10, starts=starts, samples=1000, hours_between=4.0)
    found = endurance.measured(tmp_path, options)
    half = len(found.memory) // 2
    assert found.stored > 0.8 * RATE * 60
    assert found.lost == 0
    assert max(found.memory[half:]) < max(found.memory[:half]) + GROWTH_MB
    assert max(found.files[half:]) <= max(found.files[:half]) + POOLED
    assert max(found.log) < LOG_MB
    assert not starts or found.happened["identifications"] > options.machines / 2
