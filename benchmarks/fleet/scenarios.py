"""Changes of the machines of the simulated fleets, drawn from a seed: one function per scenario."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from benchmarks.fleet.amount import case_a1, case_a1_least_squares, example, misaligned_elements
from benchmarks.fleet.histories import (
    WEEKS_A_YEAR,
    BearingChanged,
    GainDrifted,
    History,
    MachineChange,
    Misaligned,
    OutliersBegan,
    ProbeLost,
    RunOutChanged,
    Seasonality,
    UnbalanceChanged,
    history,
)
from estimator.arrays import Floats
from estimator.machine.document import Machine
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.condensation import condense
from estimator.rotor.parameters import unknowns
from estimator.simulation.simulated_plant import Truth, speed_law, true_phasors

USUAL_BASELINE, SHORT_BASELINE = 10, 5
"""Runs known to be good."""
UNBALANCE_STEP = 0.5
GAIN_DRIFT = 0.1
DRIFT_WEEKS = 26
OUTLIER_PART = 0.05
BEARING_GROWTH = (0.15, 0.30)
"""Least and largest change of a bearing, up or down."""
RUN_OUT = 0.2
"""Run-out of a scratched shaft, part of the machine's largest amplitude at that probe at the document's values."""
SAMPLES = 60
"""Phasors of a run."""
LATEST_ONSET = 0.5
"""Part of the watched weeks in which a change begins."""

Draw = Callable[[Machine, int, int, np.random.Generator], list[MachineChange]]
"""(machine, first week, last week of the onset, rng) -> what befalls it."""


@dataclass(frozen=True)
class FleetScenario:
    """A kind of history. baseline: runs known to be good."""

    name: str
    draw: Draw
    baseline: int = USUAL_BASELINE

    def history(
        self, machine: Machine, *, seed: Sequence[int], seasonality: Seasonality, watched: int = WEEKS_A_YEAR
    ) -> History:
        """Return one machine's history of so many weeks after the baseline."""
        rng = np.random.default_rng(seed)
        first = self.baseline + 2
        changes = self.draw(machine, first, first + max(1, round(LATEST_ONSET * watched)), rng)
        return history(
            machine,
            changes,
            weeks=self.baseline + watched,
            baseline=self.baseline,
            seasonality=seasonality,
            rng=rng,
        )


def _nothing(_machine: Machine, _first: int, _last: int, _rng: np.random.Generator) -> list[MachineChange]:
    return []


def _unbalance(machine: Machine, first: int, last: int, rng: np.random.Generator) -> list[MachineChange]:
    disc = machine.discs[rng.integers(len(machine.discs))]
    turned = UNBALANCE_STEP * complex(np.exp(1j * rng.uniform(0.0, 2.0 * math.pi)))
    return [UnbalanceChanged(f"disc.{disc.id}", int(rng.integers(first, last)), 0, turned)]


def _gain(machine: Machine, first: int, last: int, rng: np.random.Generator) -> list[MachineChange]:
    channel = int(rng.integers(len(machine.probes)))
    by = GAIN_DRIFT * (1.0 if rng.random() < 0.5 else -1.0)
    return [GainDrifted(_probe(machine, channel), int(rng.integers(first, last)), DRIFT_WEEKS, channel, by)]


def _lost(machine: Machine, first: int, last: int, rng: np.random.Generator) -> list[MachineChange]:
    channel = int(rng.integers(len(machine.probes)))
    return [ProbeLost(_probe(machine, channel), int(rng.integers(first, last)), 0, channel)]


def _outliers(_machine: Machine, first: int, last: int, rng: np.random.Generator) -> list[MachineChange]:
    return [OutliersBegan("machine", int(rng.integers(first, last)), 0, OUTLIER_PART)]


def _everything(machine: Machine, first: int, last: int, rng: np.random.Generator) -> list[MachineChange]:
    """Draw an unbalance, outliers, and two probes of which one drifts and the other is lost."""
    changes = [
        *_unbalance(machine, first, last, rng),
        *_gain(machine, first, last, rng),
        *_outliers(machine, first, last, rng),
    ]
    while True:
        (lost,) = _lost(machine, first, last, rng)
        if lost.element != changes[1].element:
            return [*changes, lost]


def _run_out(machine: Machine, first: int, last: int, rng: np.random.Generator) -> list[MachineChange]:
    channel = int(rng.integers(len(machine.probes)))
    size = RUN_OUT * _largest_amplitudes(machine.id)[channel]
    by = complex(size * np.exp(1j * rng.uniform(0.0, 2.0 * math.pi)))
    return [RunOutChanged(_probe(machine, channel), int(rng.integers(first, last)), 0, channel, by)]


def _bearing(machine: Machine, first: int, last: int, rng: np.random.Generator) -> list[MachineChange]:
    bearing = machine.bearings[rng.integers(len(machine.bearings))]
    growth = rng.uniform(*BEARING_GROWTH) * (1.0 if rng.random() < 0.5 else -1.0)
    return [BearingChanged(f"bearing.{bearing.id}", int(rng.integers(first, last)), 0, float(growth))]


def _misaligned(growth: Callable[[], float], ramp: int) -> Draw:
    def draw(machine: Machine, first: int, last: int, rng: np.random.Generator) -> list[MachineChange]:
        coupling = machine.couplings[rng.integers(len(machine.couplings))]
        onset = int(rng.integers(first, last))
        return [Misaligned(f"coupling.{coupling.id}", onset, ramp, growth(), misaligned_elements(machine, coupling))]

    return draw


@cache
def _largest_amplitudes(machine_id: str) -> Floats:
    """Return the largest amplitude (m,) [m] of each channel of an example over its speed range, at the document's values."""
    machine = example(machine_id)
    _, speed = speed_law(machine, "run-down", duration=1.0, samples=SAMPLES)
    unknown = unknowns(machine, assemble_rotor(machine))
    truth = Truth(
        unknown,
        np.array([one.expected for one in unknown.coefficients]),
        np.array([one.nominal for one in unknown.unbalances], dtype=complex),
        dict.fromkeys(condense(machine, speed=speed[:1], direction=np.ones(1)).scale_names, 1.0),
    )
    return np.asarray(np.abs(true_phasors(machine, truth, speed)).max(axis=0))


def _probe(machine: Machine, channel: int) -> str:
    return f"probe.{machine.probes[channel].id}"


SCENARIOS = {
    one.name: one
    for one in (
        FleetScenario("healthy", _nothing),
        FleetScenario("short baseline", _nothing, baseline=SHORT_BASELINE),
        FleetScenario("outliers", _outliers),
        FleetScenario("unbalance step", _unbalance),
        FleetScenario("probe drifts", _gain),
        FleetScenario("probe lost", _lost),
        FleetScenario("all together", _everything, baseline=SHORT_BASELINE),
        FleetScenario("misalignment step", _misaligned(case_a1, 0)),
        FleetScenario("misalignment drift", _misaligned(case_a1, DRIFT_WEEKS)),
        FleetScenario("smaller misalignment step", _misaligned(case_a1_least_squares, 0)),
        FleetScenario("bearing step", _bearing),
        FleetScenario("run-out step", _run_out),
    )
}
