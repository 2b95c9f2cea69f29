"""The task and the outcome of a calibration, as they travel between the service and a worker process.

They are pickled: a change of them, or of this module's name, requires a new `service.workers.dask_task.TASK_FORM`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from estimator.arrays import Complexes


@dataclass(frozen=True)
class StoredCalibrationRun:
    """A run of the store in a calibration.

    block: its samples. added: known unbalances (P,) [kg m]. mounting: name of the mounting that it belongs to. steady: whether
    its samples are dwells at constant speed.
    """

    name: str
    block: bytes
    added: Complexes
    mounting: str
    steady: bool


@dataclass(frozen=True)
class CalibrationTask:
    """One calibration: the machine's document, its runs, the seed of random starts, and the time limit [s]."""

    document: dict[str, Any]
    runs: Sequence[StoredCalibrationRun]
    seed: int
    timeout_s: float


@dataclass(frozen=True)
class CalibrationOutcome:
    """Result of a calibration task.

    document: the calibrated machine's. remarks: what the runs left open. starts, unique: as in `Calibrated`.
    """

    accepted: bool
    verdict: str
    remarks: tuple[str, ...]
    starts: int
    unique: bool
    document: dict[str, Any]
