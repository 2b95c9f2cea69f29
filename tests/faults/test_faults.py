"""Kill, freeze, cut, mangle: whatever happens between probe and store, it holds what was measured, once; losses are counted.

These are the short forms; `python -m benchmarks.faults` runs every order of kills, longer and more of them.
"""

from pathlib import Path

import pytest

from tests.faults import alert_deliveries, scenarios


@pytest.mark.long
def test_a_chain_that_is_frozen_parted_and_killed(tmp_path: Path) -> None:
    scenarios.frozen_parted_killed(tmp_path, samples=2000)


def test_mangled_messages_are_healed_from_the_log(tmp_path: Path) -> None:
    mangler = scenarios.mangled_with_log(tmp_path, seed=1, samples=800)
    assert min(mangler.twice, mangler.swapped, mangler.flipped) > 3
    assert len(mangler.intact) < 800


def test_of_a_source_without_a_log_exactly_what_never_came_is_lost(tmp_path: Path) -> None:
    mangler = scenarios.mangled_without_log(tmp_path, seed=2, samples=800)
    assert min(mangler.twice, mangler.swapped, mangler.flipped) > 3
    assert len(mangler.intact) < 800


@pytest.mark.long
def test_alerts_are_reported_though_the_service_is_killed(tmp_path: Path) -> None:
    told = alert_deliveries.deliveries_through_kills(tmp_path, seed=1, kills=2)
    assert told.events > 10
    assert told.heard > 10
