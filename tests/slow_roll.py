"""Machines with a slow roll, for tests of the API: a small one over it, and a train whose channels have a run-out."""

from typing import Any

import numpy as np
import yaml
from sqlalchemy.orm import Session

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine, parse_machine
from estimator.simulation.simulated_plant import draw_truth, measured_phasors, speed_law
from service.runs.collector import Collector
from storage.database.engine import Database
from storage.machines import machines
from storage.measurements import runs
from tests.api_in_process import Api
from tests.estimator.trains import ROOT
from tests.identification import forward_samples
from tests.plant import (
    SECOND,
    START,
    arrived,
    batch,
    sweep_rpm,
)
from tests.prompt_writer import PromptWriter

PUMP = "/machines/pump-7/slow-roll"
TRAIN = "thesis-chapter-3"
RUN_OUT = 2e-4 * np.exp(1j * np.arange(8))
"""Run-out of each channel of the train [m]."""


def slow_roll_and_run_down(plant: Database) -> Api:
    """Return an API over a machine with a slow roll and a run-down: 100 µm peak-to-peak at 30° lag on all channels."""
    writer = PromptWriter(plant, Collector())
    slow = [*sweep_rpm(200.0, 290.0, 30), *sweep_rpm(2990.0, 310.0), *sweep_rpm(250.0, 100.0, 6)]
    # From slow roll to speed takes an hour: no shaft jumps.
    times = [START + i * SECOND for i in range(30)] + [START + (3600 + i) * SECOND for i in range(46)]
    writer.store([arrived(batch(slow, time_ns=times))], [])
    return Api(plant)


def given(**changes: Any) -> dict[str, Any]:
    one = {"amplitude_um_pp": 40.0, "phase_lag_deg": 30.0, "standard_error_um_pp": 1.0}
    return {"vectors": {"B2X": one}, **changes}


def train_with_run_out(database: Database) -> int:
    """Create the Chapter 3 train, with one run-down whose channels all have a large run-out; return the run's number."""
    described = yaml.safe_load((ROOT / "examples" / f"{TRAIN}.yaml").read_text())
    described["noise"] = {"relative": 0.01, "floor": 1e-6}
    machine = parse_machine(described)
    with database.transaction() as session:
        machines.create(session, machine)
        return stored_run(session, machine)


def with_run_out(machine: Machine, *, duration: float, samples: int) -> tuple[Floats, Floats, Complexes]:
    """Times [s], speeds [rad/s] and phasors [m] of a run-down with the run-out."""
    rng = np.random.default_rng(1)
    seconds, speed = speed_law(machine, "run-down", duration=duration, samples=samples)
    return seconds, speed, measured_phasors(machine, draw_truth(machine, rng), speed, rng) + RUN_OUT


def stored_run(session: Session, machine: Machine) -> int:
    """Store a closed run-down of the train; return its number."""
    seconds, speed, phasor = with_run_out(machine, duration=300.0, samples=100)
    held = forward_samples(START + seconds * 1e9, speed, phasor)
    row = runs.open_run(session, machine.id, revision=1, kind="run-down", direction=1, time_first=START)
    runs.close(row, samples=held, state=runs.CLOSED, reason="the speed left the speed range")
    return row.id
