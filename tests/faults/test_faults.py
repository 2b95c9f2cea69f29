"""Kill, freeze, cut, mangle: whatever happens between probe and store, it holds what was measured, once; losses are counted.

These are the short forms; `python -m benchmarks.faults` runs every order of kills, longer and more of them.
"""

from pathlib import Path

from tests.faults import scenarios


def test_all_parts_killed_one_after_the_other(tmp_path: Path) -> None:
    scenarios.killed_in_turn(tmp_path, ("service", "edge", "router"), samples=400)


def test_a_service_frozen_for_twelve_seconds(tmp_path: Path) -> None:
    scenarios.frozen(tmp_path, "service", seconds=12.0, samples=1300)


def test_a_wire_that_holds_everything_back_and_then_breaks(tmp_path: Path) -> None:
    scenarios.parted(tmp_path, seconds=3.0, samples=500)


def test_mangled_messages_are_healed_from_the_log(tmp_path: Path) -> None:
    mangler = scenarios.mangled_with_log(tmp_path, seed=1, samples=1000)
    assert min(mangler.twice, mangler.swapped, mangler.flipped) > 3
    assert len(mangler.intact) < 1000


def test_of_a_source_without_a_log_exactly_what_never_came_is_lost(tmp_path: Path) -> None:
    mangler = scenarios.mangled_without_log(tmp_path, seed=2, samples=1000)
    assert min(mangler.twice, mangler.swapped, mangler.flipped) > 3
    assert len(mangler.intact) < 1000
