"""Runs said to be of one mounting that were taken in several: each has an unbalance and run-outs of its own.

Where nobody said so, what differs between them is taken for noise, or for gains. The same runs with a mounting for each set of
weights are calibrated again; what decides is the marginal likelihood, as of exchanges. Derived here.
"""

from collections.abc import Sequence

from msgspec.structs import replace

from estimator.calibration.calibration_runs import CalibrationRun

CLEAR = 15.0
"""Logarithm of the ratio of likelihoods from which on mountings are doubted [-]: far beyond chance, by a factor of 10⁶."""
WORDS = "a mounting of its own for each set of weights (`mounting`)"


def with_own_mountings(runs: Sequence[CalibrationRun]) -> list[CalibrationRun] | None:
    """Separate each set of weights of a mounting into a mounting of its own.

    Args:
        runs: The runs, with their weights.

    Returns:
        The runs; None where each mounting has one set of weights already.
    """
    found = [replace(run, mounting=_by_weights(run, number)) for number, run in enumerate(runs)]
    before = {name for run in runs for name in run.mounting}
    return found if len({name for run in found for name in run.mounting}) > len(before) else None


def mounting_text(gain: float) -> str:
    """State that runs of one mounting agree far better with several.

    Args:
        gain: Logarithm of the likelihood with several over that with one [-].

    Returns:
        A sentence; empty where it is not far better.
    """
    if gain < CLEAR:
        return ""
    return (
        f"runs said to be of one mounting do not agree with one unbalance, and would with {WORDS}: was the machine "
        "taken apart, or did it stand, between them?"
    )


def _by_weights(run: CalibrationRun, number: int) -> tuple[str, ...]:
    """Return a name (S,) for each stretch of samples of a run with the same mounting and weights."""
    added = run.measurement.added
    names: list[str] = []
    stretch, before = 0, None
    for row, mounting in enumerate(run.mounting):
        now = (mounting, b"" if added is None else added[row].tobytes())
        stretch += before is not None and now != before
        before = now
        names.append(f"{mounting}/{number}/{stretch}")
    return tuple(names)
