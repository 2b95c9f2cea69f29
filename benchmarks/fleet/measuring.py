"""A simulated machine as the service sees it: each week's phasors, and the real estimator's fit of them."""

import math
import pickle
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import TypeVar

import numpy as np
import threadpoolctl

from benchmarks.fleet.amount import example
from benchmarks.fleet.histories import WEEKS_A_YEAR, History, Seasonality, State
from benchmarks.fleet.scenarios import SAMPLES, SCENARIOS
from estimator.arrays import Complexes, Floats
from estimator.fit.identification import Identification
from estimator.fit.identify import identify
from estimator.machine.document import Machine
from estimator.phasors.measurement import Measurement
from estimator.simulation.simulated_plant import noise, speed_law, true_phasors

SPEED_SCATTER = 0.002
"""Run-downs are not sampled at the same speeds every week: relative rms."""
SMALLEST_OUTLIER, LARGEST_OUTLIER = 0.2, 1.0
"""An outlier is off by such a part of its amplitude: twenty times the noise and more."""
PROCESSES = 2
Outcome = TypeVar("Outcome")


@dataclass(frozen=True)
class Ordered:
    """One machine's history to simulate and identify. machine: an example's name. number: number of the machine in its
    fleet."""

    machine: str
    scenario: str
    seasonality: Seasonality
    seed: int
    number: int
    watched: int = WEEKS_A_YEAR

    @property
    def seeds(self) -> tuple[int, ...]:
        """Return the seeds of this machine's own random numbers; another scenario's machines have others."""
        return (self.seed, self.number, *(ord(letter) for letter in f"{self.machine} {self.scenario} {self.seasonality}"))


@dataclass(frozen=True)
class Watched:
    """A history with the identification of each week."""

    ordered: Ordered
    history: History
    identifications: tuple[Identification, ...]


def watched(ordered: Ordered) -> Watched:
    """Simulate and identify one machine's history. Every fit starts from the first one's end."""
    scenario = SCENARIOS[ordered.scenario]
    history = scenario.history(
        example(ordered.machine), seed=ordered.seeds, seasonality=ordered.seasonality, watched=ordered.watched
    )
    rng = np.random.default_rng((*ordered.seeds, 1))
    found: list[Identification] = []
    for state in history.states:
        beginning = found[0].point if found else None
        found.append(identify(history.machine, measured(history.machine, state, rng), beginning=beginning))
    return Watched(ordered, history, tuple(found))


def kept(ordered: Ordered, folder: Path) -> Watched:
    """Return the watched history from a folder, computing and storing it first when missing: judging needs no new fits."""
    words = (ordered.scenario, ordered.machine, ordered.seasonality, ordered.seed, ordered.number, ordered.watched)
    path = folder / ("_".join(map(str, words)).replace(" ", "-") + ".pickle")
    if not path.exists():
        folder.mkdir(parents=True, exist_ok=True)
        part = path.with_suffix(".part")
        part.write_bytes(pickle.dumps(watched(ordered)))
        part.replace(path)
    found = pickle.loads(path.read_bytes())
    assert isinstance(found, Watched)
    return found


def each(function: Callable[[Ordered], Outcome], orders: Sequence[Ordered], *, processes: int = PROCESSES) -> list[Outcome]:
    """Return the results of a function for each order, in order, computed in processes of one BLAS thread each; 1: in this
    one."""
    if processes == 1:
        with threadpoolctl.threadpool_limits(1):
            return [function(order) for order in orders]
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn"), initializer=_one_thread) as pool:
        return list(pool.map(function, orders))


def measured(machine: Machine, state: State, rng: np.random.Generator) -> Measurement:
    """Return one week's run-down through the channels as they are, with the document's noise and the outliers."""
    _, speed = speed_law(machine, "run-down", duration=1.0, samples=SAMPLES)
    speed = speed * np.exp(SPEED_SCATTER * rng.standard_normal(SAMPLES))
    shown = state.gain * true_phasors(machine, state.truth, speed) + _turned(state.run_out, machine)
    phasor = shown + noise(machine.noise, shown, rng)
    phasor = _with_outliers(phasor, state.outlier_part, rng)
    phasor[:, state.lost] = complex(math.nan, math.nan)
    return Measurement.of(speed=speed, phasor=phasor, direction=float(machine.direction))


def _turned(run_out: Complexes, machine: Machine) -> Complexes:
    return run_out if machine.direction > 0 else np.conj(run_out)


def _with_outliers(phasor: Complexes, part: float, rng: np.random.Generator) -> Complexes:
    hit = rng.random(phasor.shape) < part
    size: Floats = rng.uniform(SMALLEST_OUTLIER, LARGEST_OUTLIER, phasor.shape)
    turn = np.exp(1j * rng.uniform(0.0, 2.0 * math.pi, phasor.shape))
    return np.asarray(phasor * (1.0 + hit * size * turn))


def _one_thread() -> None:
    threadpoolctl.threadpool_limits(1)
