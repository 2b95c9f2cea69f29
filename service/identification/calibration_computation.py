"""Computing a calibration in a worker process, from stored runs to a calibrated document, without database or network."""

import hashlib
import logging
from collections.abc import Sequence

import numpy as np
from msgspec.structs import replace

from estimator.calibration.calibrate import Calibrated, calibrate, with_named_senses
from estimator.calibration.calibrated_document import calibrated_document
from estimator.calibration.calibration_runs import CalibrationRun
from estimator.machine.document import Machine, parse_machine
from estimator.machine.under_conditions import require_celsius, under_conditions
from estimator.phasors.quality import assess
from service.identification.calibration_task import CalibrationOutcome, CalibrationTask, StoredCalibrationRun
from service.workers.time_limit import limit_time, reserve_time
from storage.encoding.sample_blocks import Samples, decode, mean_conditions

logger = logging.getLogger(__name__)

KEPT_PART = 0.2
"""Part of a task's time that is kept for what follows when other senses are tried [-]."""


def compute_calibration(task: CalibrationTask) -> CalibrationOutcome:
    """Calibrate a machine from stored runs. Raises the errors of `calibrate`, and OutOfTime.

    Run-outs are found as the probes show them: slow-roll vectors are not subtracted, and a later fit moves the calibration by
    those that it subtracts (`estimator.phasors.slow_roll.corrected`).
    """
    with limit_time(task.timeout_s):
        machine = parse_machine(task.document)
        held = [decode(one.block) for one in task.runs]
        runs = [_run(machine, one, samples) for one, samples in zip(task.runs, held, strict=True)]
        for one in held:
            require_celsius(machine, mean_conditions([one], machine.condition_names))
        as_it_ran = under_conditions(machine, mean_conditions(held, machine.condition_names))
        found = _with_senses(as_it_ran, runs, calibrate(as_it_ran, runs, seed=task.seed), task)
        calibration = found.machine.calibration
        assert calibration is not None
        document = calibrated_document(machine, found.machine, calibration)
        return CalibrationOutcome(
            found.accepted,
            found.verdict,
            found.remarks,
            found.starts,
            found.unique,
            document.model_dump(mode="json", exclude_none=True),
        )


def _with_senses(machine: Machine, runs: Sequence[CalibrationRun], found: Calibrated, task: CalibrationTask) -> Calibrated:
    """Return a calibration with the wrong senses that would explain why it is refused.

    An error, or the end of the time, costs what is said of them, never the calibration.
    """
    try:
        with reserve_time(KEPT_PART * task.timeout_s):
            return with_named_senses(machine, runs, found, seed=task.seed)
    except Exception:
        logger.exception("no other senses are tried")
        return found


def _run(machine: Machine, one: StoredCalibrationRun, samples: Samples) -> CalibrationRun:
    measurement = samples.measurement()
    if not one.steady:
        usable = assess(samples.recorded(machine.channels), noise=machine.noise, rules=machine.quality).usable
        measurement = replace(measurement, usable=measurement.usable & usable)
    added = np.tile(one.added, (measurement.speed.size, 1))
    checksum = hashlib.sha256(one.block).hexdigest()
    names = (one.mounting,) * measurement.speed.size
    return CalibrationRun(one.name, replace(measurement, added=added), names, one.steady, checksum)
