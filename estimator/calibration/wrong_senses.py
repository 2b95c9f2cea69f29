"""Senses that runs of a calibration may have wrong: in which way angles of weights are counted, and the sign of phases.

Each is undone on all runs, which are calibrated again. With chains of any phase the one is nearly the other: both are named
then. Derived here.
"""

from collections.abc import Callable, Sequence

import numpy as np
from msgspec.structs import replace

from estimator.calibration.calibration_runs import CalibrationRun
from estimator.phasors.measurement import Measurement

WEIGHTS = "the angles of the weights counted the other way round (`disc_scale`)"


def explaining_senses(runs: Sequence[CalibrationRun], accepted: Callable[[Sequence[CalibrationRun]], bool]) -> str:
    """Find the wrong senses without which runs that no model explains are explained.

    Args:
        runs: The runs.
        accepted: Function that calibrates with some runs and returns whether that is accepted.

    Returns:
        The senses in words; empty where none explains the runs.
    """
    senses = {
        WEIGHTS: _with_weights_turned,
        "the opposite sign of the phases (`phase_convention`)": _with_phases_turned,
    }
    if all(run.measurement.added is None or np.isrealobj(np.real_if_close(run.measurement.added)) for run in runs):
        del senses[WEIGHTS]  # weights at 0° and 180° only have no sense
    right = [words for words, undone in senses.items() if accepted([_changed(run, undone) for run in runs])]
    return f"it fits with {' or with '.join(right)}" if right else ""


def _changed(run: CalibrationRun, undone: Callable[[Measurement], Measurement]) -> CalibrationRun:
    return replace(run, measurement=undone(run.measurement))


def _with_weights_turned(measurement: Measurement) -> Measurement:
    return replace(measurement, added=None if measurement.added is None else np.conj(measurement.added))


def _with_phases_turned(measurement: Measurement) -> Measurement:
    return replace(measurement, phasor=np.conj(measurement.phasor))
