"""The plant simulator: machines that run up, hold and coast down week after week, published as a real source would.

Each machine follows a scenario. The true parameters of each run can be written to a file, for comparison with the estimates.
"""

import json
import logging
import math
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

import numpy as np
import zenoh

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.runs.segmentation import RunKind
from estimator.simulation.scenarios import Scenario
from estimator.simulation.simulated_gaps import simulated_gaps
from estimator.simulation.simulated_overall import simulated_overall
from estimator.simulation.simulated_plant import (
    Truth,
    draw_truth,
    drawn_conditions,
    measured_phasors,
    speed_law,
    truth_at_progress,
    truth_of_run,
    truth_under_conditions,
)
from estimator.simulation.simulated_second_order import second_parts, simulated_second
from estimator.units import METRES, PEAK, RADIANS, rad_per_s_to_rpm
from formats.recordings.recording import split
from formats.wire import LARGEST_AMPLITUDE, WIRE_SCHEMA, Key, SampleBatch, as_sent
from formats.wire.schema import ChannelTable
from service.sources.publisher import Source

logger = logging.getLogger(__name__)

RUN_UP_S, HOLD_S, RUN_DOWN_S = 1200.0, 60.0, 2400.0
"""Durations of a cycle's phases [s], slow enough for the steady state in which simulated phasors are computed."""
HOLD_SAMPLES = 6
BATCH_SAMPLES = 10
HEALTHY_PART = 0.5
"""Part of the cycles before a scenario begins to show."""


@dataclass(frozen=True)
class SimulationPlan:
    """Schedule of a simulation: cycles of run-up and run-down, `interval_s` apart in the machines' time.

    samples: per sweep. rate: samples per second and machine by the wall clock, without waiting between cycles; None publishes
    in real time. linger_s: how long the source stays to reply to replay queries after its last sample.
    """

    cycles: int
    interval_s: float
    samples: int
    rate: float | None
    seed: int
    linger_s: float


class TruthFile:
    """File of the true parameters of each run, one JSON line per run."""

    def __init__(self, file: TextIO | None) -> None:
        self._file = file
        self._lock = threading.Lock()

    def write(self, machine: Machine, kind: RunKind, last_time: int, truth: Truth) -> None:
        """Write one run, identified by its machine and the time of its last sample."""
        if self._file is None:
            return
        unbalances = {
            plane.name: [value.real, value.imag]
            for plane, value in zip(truth.unknowns.unbalances, truth.unbalances.tolist(), strict=True)
        }
        line = {"machine": machine.id, "kind": kind, "last_time": last_time}
        with self._lock:
            self._file.write(json.dumps(line | {"parameters": truth.parameters, "unbalances": unbalances}) + "\n")
            self._file.flush()


def simulate(
    session: zenoh.Session,
    machines: list[tuple[Machine, Scenario]],
    plan: SimulationPlan,
    truth_path: Path | None,
    stop: threading.Event,
) -> None:
    """Publish all machines concurrently, each from a thread of its own, until their scenarios end or `stop` is set.

    Raises ValueError, before anything is published, for a machine that cannot follow its scenario.
    """
    file = truth_path.open("w", encoding="utf-8") if truth_path is not None else None
    try:
        truths = TruthFile(file)
        seeds = np.random.SeedSequence(plan.seed).spawn(len(machines))
        lives = [
            _SimulatedMachine(session, machine, scenario, plan, truths, np.random.default_rng(seed), stop)
            for (machine, scenario), seed in zip(machines, seeds, strict=True)
        ]
        threads = [threading.Thread(target=life.live, name=life.machine.id) for life in lives]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    finally:
        if file is not None:
            file.close()


class _SimulatedMachine:
    """The life of one simulated machine: its drawn parameters, its scenario, its pace."""

    def __init__(
        self,
        session: zenoh.Session,
        machine: Machine,
        scenario: Scenario,
        plan: SimulationPlan,
        truths: TruthFile,
        rng: np.random.Generator,
        stop: threading.Event,
    ) -> None:
        self.machine = machine
        self._session = session
        self._scenario: Scenario = scenario
        self._plan = plan
        self._truths = truths
        self._rng = rng
        # Of their own: with or without overall levels and 2×, a seed draws the same machine and the same runs.
        self._overall_rng, self._second_rng = rng.spawn(2)
        self._second_phases = 2.0 * np.pi * self._second_rng.random(len(machine.channels))
        self._second_parts = second_parts(machine, scenario, 0.0)
        self._stop = stop
        self._truth = draw_truth(machine, rng)
        truth_at_progress(self._truth, machine, scenario, 1.0)  # raises when the scenario is impossible
        self._due = time.monotonic()
        self._conditions: Floats = np.empty(0)

    def live(self) -> None:
        """Publish all cycles."""
        plan, machine = self._plan, self.machine
        span_s = (plan.cycles - 1) * plan.interval_s + RUN_UP_S + HOLD_S + RUN_DOWN_S
        # Compressed scenarios end now; those in real time begin now.
        began = time.time() - (span_s if plan.rate is not None else 0.0)
        self._due = time.monotonic()
        with Source(self._session, Key(machine.plant, machine.id), name="simulator") as source:
            for cycle in range(plan.cycles):
                progress = max(0.0, (cycle + 1) / plan.cycles - HEALTHY_PART) / (1.0 - HEALTHY_PART)
                truth = truth_of_run(truth_at_progress(self._truth, machine, self._scenario, progress), self._rng)
                self._second_parts = second_parts(machine, self._scenario, progress)
                start = began + cycle * plan.interval_s
                self._conditions = drawn_conditions(machine, start, self._rng)
                truth = truth_under_conditions(truth, machine, self._conditions)
                if self._stop.wait(max(0.0, start - time.time())):
                    return
                logger.info(
                    "%s: cycle %d of %d, %s at %.0f %%", machine.id, cycle + 1, plan.cycles, self._scenario, 100 * progress
                )
                self._sweep(source, truth, "run-up", start, RUN_UP_S)
                self._hold(source, truth, start + RUN_UP_S)
                self._sweep(source, truth, "run-down", start + RUN_UP_S + HOLD_S, RUN_DOWN_S)
                if self._stop.is_set():
                    return
            self._stop.wait(plan.linger_s)

    def _sweep(self, source: Source, truth: Truth, kind: RunKind, start: float, duration: float) -> None:
        seconds, speed = speed_law(self.machine, kind, duration=duration, samples=self._plan.samples)
        phasors = measured_phasors(self.machine, truth, speed, self._rng)
        gaps = simulated_gaps(self.machine, truth, time=seconds, speed=speed, rng=self._rng)
        batch = self._batch(start + seconds, speed, phasors, gaps)
        self._truths.write(self.machine, kind, batch.time_ns[-1], truth)
        self._publish(source, batch)

    def _hold(self, source: Source, truth: Truth, start: float) -> None:
        """Publish samples at constant speed for a while."""
        _, sweep = speed_law(self.machine, "run-down", duration=1.0, samples=2)
        seconds = np.linspace(0.0, HOLD_S, HOLD_SAMPLES + 2)[1:-1]
        speed = np.full(HOLD_SAMPLES, sweep[0])
        phasors = measured_phasors(self.machine, truth, speed, self._rng)
        gaps = simulated_gaps(self.machine, truth, time=seconds, speed=speed, rng=self._rng)
        self._publish(source, self._batch(start + seconds, speed, phasors, gaps))

    def _batch(self, time_s: Floats, speed: Floats, phasors: Complexes, gaps: Floats | None) -> SampleBatch:
        parts, phases = self._second_parts, self._second_phases
        second = simulated_second(self.machine, phasors, parts=parts, phases=phases, rng=self._second_rng)
        overall = simulated_overall(phasors, second, self._overall_rng)
        return _batch(self.machine, time_s, speed, phasors, second, self._conditions, gaps, overall)

    def _publish(self, source: Source, batch: SampleBatch) -> None:
        for piece in split(batch, BATCH_SAMPLES):
            self._wait(piece)
            if self._stop.is_set():
                return
            source.publish(piece)

    def _wait(self, batch: SampleBatch) -> None:
        """Wait until a batch is due: by its own last sample's time, or at the plan's rate."""
        if self._plan.rate is None:
            self._stop.wait(max(0.0, batch.time_ns[-1] / 1e9 - time.time()))
            return
        # After a hitch the pace is taken up again, not caught up with.
        self._due = max(self._due, time.monotonic() - 1.0) + len(batch.time_ns) / self._plan.rate
        self._stop.wait(max(0.0, self._due - time.monotonic()))


def _batch(
    machine: Machine,
    time_s: Floats,
    speed: Floats,
    phasors: Complexes,
    second: Complexes,
    conditions: Floats,
    gaps: Floats | None,
    overall: Floats,
) -> SampleBatch:
    """Return a batch in the usual units of vibration monitors: rpm, µm peak-to-peak, degrees of lag, gaps in µm.

    phasors, second: 1× and 2× (S, m) [m]. conditions: (k,), constant over the samples. gaps: the shaft's places (S, m) [m],
    NaN of probes that send none. overall: levels (S, m), 0-to-peak [m].
    """
    told = dict(zip(machine.condition_names, conditions.tolist(), strict=True))
    return SampleBatch(
        schema=WIRE_SCHEMA,
        plant=machine.plant,
        machine=machine.id,
        source="",
        epoch=0,
        sequence=0,
        channels=list(machine.channels),
        speed_unit="rpm",
        amplitude_unit="um",
        amplitude_kind="peak-to-peak",
        phase_convention="lag",
        phase_unit="deg",
        direction=machine.rotation,
        time_ns=[round(s * 1e9) for s in time_s.tolist()],
        speed=[rad_per_s_to_rpm(value) for value in speed.tolist()],
        amplitude=(np.abs(phasors) / (METRES["um"] * PEAK["peak-to-peak"])).tolist(),
        phase=np.mod(-np.angle(phasors) / RADIANS["deg"], 360.0).tolist(),
        amplitude_2x=(np.abs(second) / (METRES["um"] * PEAK["peak-to-peak"])).tolist(),
        phase_2x=np.mod(-np.angle(second) / RADIANS["deg"], 360.0).tolist(),
        conditions={name: [value] * speed.size for name, value in told.items()} or None,
        # A monitor shows none where its probe cannot see that far.
        overall=_table(np.where(overall <= LARGEST_AMPLITUDE, overall, np.nan) / (METRES["um"] * PEAK["peak-to-peak"])),
        gap=None if gaps is None else _table(as_sent(gaps, machine)),
        gap_unit=None if gaps is None else "um",
    )


def _table(values: Floats) -> ChannelTable:
    """Return values with null for NaN."""
    return [[value if math.isfinite(value) else None for value in row] for row in values.tolist()]
