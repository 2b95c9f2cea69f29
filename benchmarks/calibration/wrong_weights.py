"""Simulated calibrations whose mountings differ by some four tenths of what the trial weights do: right and wrong weights.

Right runs shall be accepted, wrong ones refused: angles counted the other way round, weights of two discs exchanged, weights
of every third run in another unit, and each loaded run stated with the weights of the next.
"""

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from msgspec.structs import replace

from benchmarks.calibration.simulated_trains import MountedTrain
from benchmarks.fluid_film.report_line import ReportLine
from estimator.arrays import Complexes
from estimator.calibration.calibrate import calibrate
from estimator.calibration.calibration_runs import CalibrationRun

RUNS, SPEEDS = 20, 40
RIGHT, WRONG = 60, 10
"""Right sets of runs, and wrong ones of each kind."""
SHORT_RIGHT, SHORT_WRONG = 20, 5
MOST_REFUSED, LEAST_REFUSED = 0.05, 0.9
OTHER_UNIT = 25.4
"""Factor between g in and g mm [-]."""

StatedWeights = Sequence[Complexes]


def _counted_otherwise(put: StatedWeights) -> StatedWeights:
    return [one.conj() for one in put]


def _of_other_discs(put: StatedWeights) -> StatedWeights:
    return [one[:, [1, 0, *range(2, one.shape[1])]] for one in put]


def _in_another_unit(put: StatedWeights) -> StatedWeights:
    return [one * (OTHER_UNIT if number % 3 == 1 else 1.0) for number, one in enumerate(put)]


def _of_the_next_run(put: StatedWeights) -> StatedWeights:
    return [put[0], *put[2:], put[1]]


KINDS: dict[str, Callable[[StatedWeights], StatedWeights]] = {
    "angles counted the other way round": _counted_otherwise,
    "weights of two discs exchanged": _of_other_discs,
    "weights of every third run in another unit": _in_another_unit,
    "each run with the weights of the next": _of_the_next_run,
}


def wrong_weights(short: bool) -> Iterator[ReportLine]:
    """Yield how many right sets of runs are refused, and how many wrong ones of each kind."""
    count = SHORT_RIGHT if short else RIGHT
    refused = sum(is_refused(seed) for seed in range(count))
    what = f"motor-pump, {RUNS} sweeps, mountings differ by some 40 % of what weights do"
    yield ReportLine(f"{what}: right ones refused", "<= 5 %", f"{refused} of {count}", refused <= MOST_REFUSED * count)
    count = SHORT_WRONG if short else WRONG
    for words, wrong in KINDS.items():
        refused = sum(is_refused(seed, wrong) for seed in range(count))
        yield ReportLine(f"    {words}: refused", ">= 90 %", f"{refused} of {count}", refused >= LEAST_REFUSED * count)


def is_refused(seed: int, wrong: Callable[[StatedWeights], StatedWeights] | None = None) -> bool:
    """Return whether a simulated train's calibration is refused, with its weights as they were or stated wrongly."""
    plant = MountedTrain("motor-pump", seed)
    runs = plant.runs(RUNS, SPEEDS)
    if wrong is not None:
        runs = stated(runs, wrong([np.asarray(one.measurement.added) for one in runs]))
    return not calibrate(plant.machine, runs).accepted


def stated(runs: Sequence[CalibrationRun], put: StatedWeights) -> list[CalibrationRun]:
    """Return runs with the weights of each (S, P) stated as given [kg m]."""
    return [replace(one, measurement=replace(one.measurement, added=said)) for one, said in zip(runs, put, strict=True)]
