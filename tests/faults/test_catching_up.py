"""A service that was away, and sources that went on: `python -m benchmarks.faults.catching_up` has more of them."""

import argparse
from pathlib import Path

import pytest

from benchmarks.faults import catching_up


@pytest.mark.long
def test_what_waits_in_many_logs_is_all_stored_once(tmp_path: Path) -> None:
    assert catching_up.measure(tmp_path, argparse.Namespace(sources=10, batches=40, size=10, channels=16))
