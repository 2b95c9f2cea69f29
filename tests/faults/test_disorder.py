"""Duplicates, other orders, late samples and lost ones change neither the store nor the estimates; gaps are counted exactly.

`python -m benchmarks.faults --only disorder` runs a longer one.
"""

from pathlib import Path

from tests.faults import disorder


def test_a_spoiled_stream_gives_what_the_clean_one_gives(tmp_path: Path) -> None:
    said = disorder.spoiled_stream(tmp_path, rate=0.5, sweeps=2, seed=5)
    assert "the same store" in said
