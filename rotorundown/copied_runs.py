"""Runs that hold the same samples: to count one twice would halve its errors."""

from collections.abc import Sequence

import numpy as np

from rotorundown.runs import MachineRun


def copied_run(runs: Sequence[MachineRun]) -> tuple[MachineRun, MachineRun] | None:
    """Return the first two runs of which one is a copy of the other.

    Args:
        runs: Runs of one machine.

    Returns:
        The two; None where every run has samples of its own.
    """
    for number, run in enumerate(runs):
        for other in runs[:number]:
            one, two = run.recorded, other.recorded
            if np.array_equal(one.speed, two.speed) and np.array_equal(one.phasor, two.phasor, equal_nan=True):
                return other, run
    return None


def copy_words(pair: tuple[MachineRun, MachineRun]) -> str:
    """Return that one of two runs is a copy, with their names."""
    return f"runs '{pair[0].name}' and '{pair[1].name}' hold the same samples: one is a copy, and tells nothing new"
