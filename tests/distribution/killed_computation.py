"""Computations that end their own process as long as a file is there, whose path the environment names.

Imported by the worker processes of `tests.distribution.dask_worker` with `killing=1`, as one of their tasks' modules.
"""

import multiprocessing
import os
import signal
from pathlib import Path

from service.identification import computation
from service.identification.task import IdentificationOutcome, IdentificationTask

FILE = "RUNDOWN_TEST_KILLING_FILE"
_compute = computation.compute


def killed_compute(task: IdentificationTask) -> IdentificationOutcome:
    """Compute as ever, unless the file is there: then this process is gone."""
    if Path(os.environ[FILE]).exists():
        os.kill(os.getpid(), signal.SIGKILL)
    return _compute(task)


if multiprocessing.current_process().name != "MainProcess":  # in those that compute, not in the worker that begins them
    computation.compute = killed_compute
