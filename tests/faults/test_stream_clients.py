"""Clients of the event stream that never read cost others nothing: `benchmarks.faults.stream_clients` has a thousand."""

from pathlib import Path

import pytest

from tests.faults.stream_clients import followed

LARGEST_GROWTH_MB = 200.0


@pytest.mark.long
def test_clients_that_never_read_cost_little_and_nobody_misses_anything(tmp_path: Path) -> None:
    found = followed(tmp_path, clients=60, stuck=6, events=1000)
    assert found.growth_mb < LARGEST_GROWTH_MB
