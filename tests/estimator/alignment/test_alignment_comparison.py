"""Comparison of alignment with a baseline: how often a healthy machine is said to have changed, what cannot be compared."""

import numpy as np

from estimator.alignment.alignment_change import changed_alignment
from estimator.alignment.alignment_comparison import AlignmentComparison
from estimator.alignment.run_change import run_change
from estimator.alignment.tolerance import tolerated_changes
from estimator.machine.alignment_rules import HealthyVariation
from tests.estimator.alignment.drawn_runs import MODEL, drawn_machine, drawn_run, fitted

TRIALS = 60


def healthy(seed: int) -> AlignmentComparison:
    """Comparison of a run of a healthy machine with another one as its baseline."""
    rng = np.random.default_rng(seed)
    machine = drawn_machine(rng)
    before, after = (fitted(drawn_run(machine, HealthyVariation(), rng), rng) for _ in range(2))
    change = run_change([before], after)
    assert change is not None
    return AlignmentComparison("C1", tolerated_changes(MODEL.machine, changed_alignment(change)), ())


def test_a_healthy_machine_is_seldom_said_to_have_changed_although_four_numbers_are_looked_at() -> None:
    found = [healthy(seed) for seed in range(TRIALS)]
    alone = [any(abs(one.value or 0.0) > one.half for one in each.changes) for each in found]
    told = ["has changed" in each.verdict for each in found]
    assert sum(told) <= 0.12 * TRIALS
    assert sum(alone) > 0.15 * TRIALS, "each number by itself at 95 % would have been told too often"
