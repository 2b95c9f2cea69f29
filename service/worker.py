"""What runs in an identification process: arrays in, one identification out. No database, no network."""

import os
import signal
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from multiprocessing import parent_process
from multiprocessing.connection import wait
from types import FrameType
from typing import Any

import threadpoolctl

from estimator.gathering import combined
from estimator.identification import Identification, Options, identify
from estimator.machine import parse_machine
from estimator.slow_roll import SlowRoll, corrected
from storage.blocks import decode


@dataclass(frozen=True)
class Task:
    """One identification: the machine's document, its runs' sample blocks, the fit's options and its time limit [s].

    slow_roll: vectors that are subtracted first.
    """

    document: dict[str, Any]
    runs: Sequence[bytes]
    options: Options
    timeout_s: float
    slow_roll: SlowRoll | None = None


class OutOfTime(RuntimeError):
    """The identification took longer than allowed."""


def prepare() -> None:
    """Run once in each process: one BLAS thread, deaf to the terminal's Ctrl-C, gone when its parent is."""
    threadpoolctl.threadpool_limits(1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def compute(task: Task) -> Identification:
    """Identify. Raises what `identify` raises, and OutOfTime."""
    signal.signal(signal.SIGALRM, _out_of_time)
    signal.setitimer(signal.ITIMER_REAL, task.timeout_s)
    try:
        machine = parse_machine(task.document)
        results = []
        for block in task.runs:
            described, measurement = machine, decode(block).measurement()
            if task.slow_roll is not None:
                described, measurement = corrected(described, measurement, task.slow_roll)
            results.append(identify(described, measurement, task.options))
        return results[0] if len(results) == 1 else combined(results)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)


def _out_of_time(_number: int, _frame: FrameType | None) -> None:
    raise OutOfTime("the identification took longer than allowed")


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)
