"""Influence coefficients on the measured RK-4 rotor kit: known unbalances from conditions that took no part."""

from benchmarks.calibration.measured_kit import held_out, kit_runs


def test_known_unbalances_are_found_within_their_intervals() -> None:
    """Two random splits. A weight per probe and speed alone gives 3.7 g mm: what points show together helps."""
    found = held_out(2)
    assert found.rms_magnitude < 2.8
    assert found.median_phase < 4.0
    assert found.coverage > 0.9


def test_the_kit_has_twenty_conditions_of_which_five_have_one_speed() -> None:
    runs = kit_runs()
    kept, left_out = runs.determined()
    assert (len(kept.names), left_out) == (20, ())
    assert sum(bool((abs(row) != abs(row)).any()) for row in runs.vector) == 5
