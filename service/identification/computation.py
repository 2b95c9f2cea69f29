"""Computing an identification in a worker process, from arrays to quality and identification, without database or network."""

import logging
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from msgspec.structs import replace

from estimator.fit.identification import Identification
from estimator.identification.convention_trials import ConventionVerdict, with_named_conventions
from estimator.identification.pooling import combine
from estimator.identification.quality_gate import GatedIdentification, identify_gated
from estimator.machine.document import Machine, parse_machine
from estimator.machine.film_parameter_names import load_balance
from estimator.machine.under_conditions import require_celsius, under_conditions
from estimator.modes.nominal_critical_speeds import crossed_critical_speeds
from estimator.phasors.harmonic_ratio import Orders
from estimator.phasors.measurement import Measurement
from estimator.phasors.noise import error_size
from estimator.phasors.orbits import orbit_findings
from estimator.phasors.quality import Quality
from estimator.phasors.recorded_run import RecordedRun
from estimator.phasors.repeatability import EarlierRun, distances, repeatability_findings
from estimator.phasors.slow_roll import corrected
from estimator.updated_model.derived_quantities import Derived, derived_quantities
from service.identification.task import IdentificationOutcome, IdentificationTask
from service.workers.time_limit import limit_time, reserve_time
from storage.encoding.sample_blocks import Samples, decode, mean_conditions

logger = logging.getLogger(__name__)

KEPT_PART = 0.2
"""Part of a task's time that is kept for what follows when wrong conventions are tried [-]."""


def compute(task: IdentificationTask) -> IdentificationOutcome:
    """Assess the quality of the runs and identify. Raises the errors of `identify`, except NotEnoughData, and OutOfTime.

    A process that hangs where Python cannot interrupt it is ended some seconds after its time.
    """
    with limit_time(task.timeout_s):
        machine = parse_machine(task.document)
        runs = [decode(block) for block in task.runs]
        names = machine.condition_names
        for one in runs:
            require_celsius(machine, mean_conditions([one], names))
        judged = [_judged(under_conditions(machine, mean_conditions([one], names)), one, task) for one in runs]
        gated = [_with_findings(machine, one, _with_conventions(one, task), task) for one in judged]
        qualities = tuple(one.qualities[0] for one in gated)
        crossed = tuple(_crossed(machine, samples) for samples in runs)
        found = [one.identification for one in gated if one.identification is not None]
        if len(found) < len(gated):
            why = next(one.error for one in gated if one.identification is None)
            return IdentificationOutcome(qualities, None, why, crossed=crossed)
        result = found[0] if len(found) == 1 else combine(found)
        conditions = mean_conditions(runs, names)
        beginning = None if task.beginning is None else task.beginning[0]
        derived, why = _derived(under_conditions(machine, conditions), result, runs)
        return IdentificationOutcome(
            qualities,
            result,
            derived=derived,
            underived=why,
            conditions=conditions,
            beginning=beginning,
            crossed=crossed,
            load_balance=load_balance(result.coordinates),
        )


def _crossed(machine: Machine, run: Samples) -> list[float]:
    return crossed_critical_speeds(machine, lowest=float(run.speed.min()), highest=float(run.speed.max()))


def _derived(machine: Machine, result: Identification, runs: Sequence[Samples]) -> tuple[tuple[Derived, ...], str | None]:
    """Return the quantities derived from an identification, or none and the reason."""
    if not result.accepted:
        return (), None
    orders = [Orders(one.speed, np.where(one.usable, one.phasor, np.nan), one.second) for one in runs]
    turned = sum(int(one.direction.sum(dtype=np.int64)) for one in runs)
    try:
        return derived_quantities(machine, result, orders, direction=1 if turned > 0 else -1), None
    except Exception as error:  # noqa: BLE001 - whatever fails here, the identification stands
        return (), f"{type(error).__name__}: {error}"


@dataclass(frozen=True)
class _JudgedRun:
    """A run with its identification. described, without: document and phasors of the fit, without the slow roll."""

    described: Machine
    run: RecordedRun
    measurement: Measurement
    without: Measurement
    gated: GatedIdentification


def _judged(machine: Machine, samples: Samples, task: IdentificationTask) -> _JudgedRun:
    run, measurement = samples.recorded(machine.channels), samples.measurement()
    if task.steady:
        run = replace(run, time=None)
    described, without = machine, measurement
    if task.slow_roll is not None:
        described, without = corrected(machine, measurement, task.slow_roll)
    beginning = None if task.beginning is None else np.frombuffer(task.beginning[1], "<f8")
    gated = identify_gated(described, [run], [without], options=task.options, rules=task.rules, beginning=beginning)
    return _JudgedRun(described, run, measurement, without, gated)


def _with_conventions(one: _JudgedRun, task: IdentificationTask) -> ConventionVerdict:
    """Return an identification with the wrong conventions that would explain why it is refused.

    An error, or the end of the time, costs what is said of them, never the identification.
    """
    try:
        with reserve_time(KEPT_PART * task.timeout_s):
            return with_named_conventions(one.described, [one.run], [one.without], one.gated, rules=task.rules)
    except Exception:
        logger.exception("no conventions are tried")
        return ConventionVerdict(one.gated)


def _with_findings(
    machine: Machine, one: _JudgedRun, verdict: ConventionVerdict, task: IdentificationTask
) -> GatedIdentification:
    """Return an identification whose quality tells of the wiring and of the comparison with an earlier run."""
    quality = verdict.gated.qualities[0]
    if not verdict.named:  # a wrong convention turns orbits as well: then it is the reason
        good = replace(one.measurement, usable=one.measurement.usable & quality.usable)
        wiring = tuple(finding.words for finding in orbit_findings(machine, good))
        quality = replace(quality, findings=(*quality.findings, *wiring))
    if task.earlier is not None:
        quality = _compared(machine, one.run, quality, task.earlier)
    return replace(verdict.gated, qualities=(quality,))


def _compared(machine: Machine, run: RecordedRun, quality: Quality, earlier: tuple[str, bytes]) -> Quality:
    """Return a run's quality extended by the findings of its comparison with an earlier run."""
    name, block = earlier
    before = decode(block)
    error = error_size(machine.noise, np.abs(run.phasor), run.scatter)
    other = EarlierRun(name, before.speed, before.phasor, before.usable)
    found = distances(run.speed, run.phasor, error, quality.usable, other)
    return replace(quality, findings=(*quality.findings, *repeatability_findings(run.channels, found, name)))
