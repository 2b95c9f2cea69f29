"""Routers started again, partitions short and long; `python -m benchmarks.faults --only part` has more and longer ones."""

from pathlib import Path

import pytest

from tests.faults import gaps, network_partitions


@pytest.mark.long
def test_a_router_that_starts_again_loses_nothing(tmp_path: Path) -> None:
    network_partitions.router_restarted(tmp_path, times=3, seed=1)


@pytest.mark.long
def test_a_partition_loses_nothing(tmp_path: Path) -> None:
    network_partitions.parted(tmp_path, times=1, seconds=5.0)


@pytest.mark.long
def test_a_plant_goes_on_alone_for_an_hour_and_the_centre_catches_up(tmp_path: Path) -> None:
    network_partitions.plant_parted_from_centre(
        tmp_path, samples=network_partitions.HOUR_SAMPLES, seconds=network_partitions.HOUR_S
    )


@pytest.mark.long
def test_no_alert_comes_of_gaps_in_the_runs_of_a_healthy_machine(tmp_path: Path) -> None:
    gaps.runs_with_gaps(tmp_path, gaps=2, seconds=1.5, seed=3)
