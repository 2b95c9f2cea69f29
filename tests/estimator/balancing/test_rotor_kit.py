"""Influence coefficients on the measured RK-4 rotor kit: known unbalances from conditions that took no part."""

import numpy as np

from benchmarks.calibration.measured_kit import held_out, kit_runs, runs_with_scatter, simulated_runs


def test_known_unbalances_are_found_within_their_intervals() -> None:
    """Two random splits. A weight per probe and speed alone gives 3.7 g mm: what points show together helps."""
    found = held_out(2)
    assert found.rms_magnitude < 2.8
    assert found.median_phase < 4.0
    assert found.coverage > 0.9
    assert 0.7 < np.mean(found.standardised**2) < 1.3, "no wider than their errors are"


def test_intervals_are_as_wide_as_errors_are_whatever_points_show_together() -> None:
    """Kits whose runs scatter as the measured one's do, and kits that settle anew at each start."""
    alike = [held_out(1, runs_with_scatter(seed)) for seed in range(12)]
    settling = [held_out(1, simulated_runs(seed, noise=0.5)) for seed in range(12)]
    for found in (alike, settling):
        assert 0.7 < np.mean([np.mean(one.standardised**2) for one in found]) < 1.3
        assert np.mean([one.coverage for one in found]) > 0.92


def test_the_kit_has_twenty_conditions_of_which_five_have_one_speed() -> None:
    runs = kit_runs()
    kept, left_out = runs.determined()
    assert (len(kept.names), left_out) == (20, ())
    assert sum(bool((abs(row) != abs(row)).any()) for row in runs.vector) == 5
