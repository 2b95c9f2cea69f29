"""What runs in an identification process: arrays in, quality and identification out. No database, no network."""

import faulthandler
import os
import resource
import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from multiprocessing import parent_process
from multiprocessing.connection import wait
from types import FrameType
from typing import Any

import numpy as np
import threadpoolctl

from estimator.derived import Derived, derived_quantities
from estimator.gate import Gated, identify_gated
from estimator.gathering import combined
from estimator.identification import Identification, Options
from estimator.machine import Machine, parse_machine
from estimator.noise import error_size
from estimator.nominal_critical_speeds import crossed_critical_speeds
from estimator.orbit import orbit_findings
from estimator.quality import Quality
from estimator.recorded import Recorded
from estimator.repeatability import EarlierRun, distances, repeatability_findings
from estimator.rules import QualityRules
from estimator.second_order import Orders
from estimator.slow_roll import SlowRoll, corrected
from service.judgement import Judgement, Question
from service.judging import judged
from storage.blocks import Samples, decode, mean_conditions

NICENESS = 10
"""Storing and answering come before identifying, where there are fewer cores than work."""
GRACE_S = 10.0
"""How much longer than allowed a process may take to notice that its time is over."""


TASK_FORM = 1
"""Counts changes of Task and Outcome within a release: processes that differ in it do not open each other's."""


@dataclass(frozen=True)
class Task:
    """One identification: the machine's document, its runs' sample blocks, the fit's options and its time limit [s].

    rules: what may be left out. earlier: name and block of a run that a single run is compared with. slow_roll: vectors that
    are subtracted before the fit. beginning: id and `point` of an earlier identification, alike, to start from.
    """

    document: dict[str, Any]
    runs: Sequence[bytes]
    options: Options
    timeout_s: float
    rules: QualityRules | None = None
    earlier: tuple[str, bytes] | None = None
    slow_roll: SlowRoll | None = None
    beginning: tuple[int, bytes] | None = None


@dataclass(frozen=True)
class Outcome:
    """qualities: of the runs, in the task's order. identification: None where the data do not allow one, for `error`.

    derived: what follows from an accepted identification; underived: why nothing does after all. conditions: mean of each
    operating condition over the runs by name, None where it was not measured. beginning: id of the identification from which
    the fit started, if any. crossed: per run the critical speeds of the document's model that it crossed [r/min].
    """

    qualities: tuple[Quality, ...]
    identification: Identification | None
    error: str | None = None
    derived: tuple[Derived, ...] = ()
    underived: str | None = None
    conditions: dict[str, float | None] = field(default_factory=dict)
    beginning: int | None = None
    crossed: tuple[list[float], ...] = ()


class OutOfTime(RuntimeError):
    """The identification took longer than allowed."""


def prepare(memory_bytes: int) -> None:
    """Run once in each process: one BLAS thread, so much memory, behind everybody who waits for the processor, deaf to the
    terminal's Ctrl-C, gone when its parent is.
    """
    os.nice(NICENESS)
    resource.setrlimit(resource.RLIMIT_DATA, (memory_bytes, memory_bytes))
    threadpoolctl.threadpool_limits(1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def compute(task: Task) -> Outcome:
    """Judge the runs and identify. Raises what `identify` raises, except NotEnoughData, and OutOfTime.

    A process that hangs where Python cannot interrupt it ends some seconds after its time.
    """
    with limited(task.timeout_s):
        machine = parse_machine(task.document)
        runs = [decode(block) for block in task.runs]
        gated = [_gated(machine, samples, task) for samples in runs]
        qualities = tuple(one.qualities[0] for one in gated)
        crossed = tuple(_crossed(machine, samples) for samples in runs)
        found = [one.identification for one in gated if one.identification is not None]
        if len(found) < len(gated):
            why = next(one.error for one in gated if one.identification is None)
            return Outcome(qualities, None, why, crossed=crossed)
        result = found[0] if len(found) == 1 else combined(found)
        conditions = mean_conditions(runs, machine.condition_names)
        beginning = None if task.beginning is None else task.beginning[0]
        derived, why = _derived(machine, result, runs)
        return Outcome(
            qualities,
            result,
            derived=derived,
            underived=why,
            conditions=conditions,
            beginning=beginning,
            crossed=crossed,
        )


def judge(task: tuple[Question, float]) -> Judgement:
    """Answer a question about a machine's newest runs within so long [s]. Raises OutOfTime."""
    question, timeout_s = task
    with limited(timeout_s):
        return judged(question)


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """Keep to a time [s]. Raises OutOfTime; a process that hangs in native code ends some seconds after it."""
    if threading.current_thread() is not threading.main_thread():
        raise RuntimeError("a task needs a process of its own to keep to its time")
    signal.signal(signal.SIGALRM, _out_of_time)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    faulthandler.dump_traceback_later(seconds + GRACE_S, exit=True)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        faulthandler.cancel_dump_traceback_later()


def _crossed(machine: Machine, run: Samples) -> list[float]:
    return crossed_critical_speeds(machine, lowest=float(run.speed.min()), highest=float(run.speed.max()))


def _derived(machine: Machine, result: Identification, runs: Sequence[Samples]) -> tuple[tuple[Derived, ...], str | None]:
    """What follows from an identification, or why it does not."""
    if not result.accepted:
        return (), None
    orders = [Orders(one.speed, np.where(one.usable, one.phasor, np.nan), one.second) for one in runs]
    turned = sum(int(one.direction.sum(dtype=np.int64)) for one in runs)
    try:
        return derived_quantities(machine, result, orders, direction=1 if turned > 0 else -1), None
    except Exception as error:  # noqa: BLE001 - whatever is the matter here, the identification stands, out of time or not
        return (), f"{type(error).__name__}: {error}"


def _gated(machine: Machine, samples: Samples, task: Task) -> Gated:
    run, measurement = samples.recorded(machine.channels), samples.measurement()
    described, without = machine, measurement
    if task.slow_roll is not None:
        described, without = corrected(machine, measurement, task.slow_roll)
    beginning = None if task.beginning is None else np.frombuffer(task.beginning[1], "<f8")
    gated = identify_gated(described, [run], [without], options=task.options, rules=task.rules, beginning=beginning)
    quality = gated.qualities[0]
    good = replace(measurement, usable=measurement.usable & quality.usable)
    wiring = tuple(finding.words for finding in orbit_findings(machine, good))
    quality = replace(quality, findings=(*quality.findings, *wiring))
    if task.earlier is not None:
        quality = _compared(machine, run, quality, task.earlier)
    return replace(gated, qualities=(quality,))


def _compared(machine: Machine, run: Recorded, quality: Quality, earlier: tuple[str, bytes]) -> Quality:
    """With what a run shows against an earlier one."""
    name, block = earlier
    before = decode(block)
    error = error_size(machine.noise, np.abs(run.phasor), run.scatter)
    other = EarlierRun(name, before.speed, before.phasor, before.usable)
    found = distances(run.speed, run.phasor, error, quality.usable, other)
    return replace(quality, findings=(*quality.findings, *repeatability_findings(run.channels, found, name)))


def _out_of_time(_number: int, _frame: FrameType | None) -> None:
    raise OutOfTime("the identification took longer than allowed")


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)
