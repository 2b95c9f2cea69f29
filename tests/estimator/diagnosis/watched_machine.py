"""A simulated motor-pump, run after run, through the real fit: what the tests of the diagnosis share."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import yaml

from estimator.arrays import Complexes
from estimator.diagnosis.finding_kind import Cause
from estimator.diagnosis.observation import Observation, observation_of
from estimator.diagnosis.run_windows import RunWindows
from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.machine.coupling_neighbours import neighbouring_bearings
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import Measurement
from estimator.simulation.simulated_plant import Truth, draw_truth, measured_phasors, speed_law
from tests.estimator.trains import ROOT

SAMPLES = 60
BASELINE = 6
Edit = Callable[[Complexes, np.random.Generator], None]
"""Changes phasors (S, m) in place, as a fault of a measuring chain does."""


@cache
def motor_pump() -> Machine:
    return parse_machine(yaml.safe_load((ROOT / "examples" / "motor-pump.yaml").read_text(encoding="utf-8")))


@cache
def true_machine() -> Truth:
    return draw_truth(motor_pump(), np.random.default_rng(11))


def grown(factors: dict[str, float], unbalances: dict[int, complex] | None = None) -> Truth:
    """The machine with all coefficients of some elements, and some unbalances, times a factor."""
    truth = true_machine()
    factor = np.array([factors.get(one.element, 1.0) for one in truth.unknowns.coefficients])
    unbalance = truth.unbalances.copy()
    for place, times in (unbalances or {}).items():
        unbalance[place] *= times
    return replace(truth, coefficients=truth.coefficients * factor, unbalances=unbalance)


def misaligned(growth: float) -> Truth:
    """The coupling and the bearings beside it grown."""
    coupling = motor_pump().couplings[0]
    elements = [f"coupling.{coupling.id}", *(f"bearing.{one}" for one in neighbouring_bearings(motor_pump(), coupling))]
    return grown(dict.fromkeys(elements, 1.0 + growth))


def measured(truth: Truth, seed: int, edit: Edit | None = None) -> Measurement:
    """One coast-down: 1 % run-to-run scatter of stiffnesses, 5 % of dampings, the document's noise, then the edit."""
    rng = np.random.default_rng([5, seed])
    size = np.array([0.05 if "damping" in one.quantity else 0.01 for one in truth.unknowns.coefficients])
    varied = replace(truth, coefficients=truth.coefficients * np.exp(size * rng.standard_normal(size.size)))
    _, speed = speed_law(motor_pump(), "run-down", duration=1200.0, samples=SAMPLES)
    phasor = measured_phasors(motor_pump(), varied, speed, rng)
    if edit is not None:
        edit(phasor, rng)
    return Measurement.of(speed=speed, phasor=phasor, direction=motor_pump().direction)


@cache
def first_run() -> Identification:
    return identify(motor_pump(), measured(true_machine(), 0))


def run(truth: Truth, seed: int, edit: Edit | None = None) -> Identification:
    """A run, identified as the service does: from the first good one's point."""
    # What a fault makes hopeless is not begun again and again.
    return identify(motor_pump(), measured(truth, seed, edit), Options(starts=2), beginning=first_run().point)


def says(identification: Identification) -> Observation:
    return observation_of(identification, motor_pump().channels)


@cache
def watch() -> RunWindows:
    """A watch over the healthy machine."""
    runs = [first_run(), *(run(true_machine(), seed) for seed in range(1, BASELINE))]
    return RunWindows.from_baseline(motor_pump(), [says(one) for one in runs])


@cache
def healthy(count: int) -> tuple[Observation, ...]:
    """Runs of the healthy machine after its baseline."""
    return tuple(says(run(true_machine(), 100 + seed)) for seed in range(count))


def after(truth: Truth, *, count: int = 2, seed: int = 200, edit: Edit | None = None) -> tuple[Observation, ...]:
    """Runs after something has happened."""
    return tuple(says(run(truth, seed + number, edit)) for number in range(count))


def gain(channel: int, factor: complex) -> Edit:
    def edit(phasor: Complexes, _rng: np.random.Generator) -> None:
        phasor[:, channel] *= factor

    return edit


def run_out(channel: int, size: complex) -> Edit:
    def edit(phasor: Complexes, _rng: np.random.Generator) -> None:
        phasor[:, channel] += size

    return edit


def lost(channel: int) -> Edit:
    def edit(phasor: Complexes, _rng: np.random.Generator) -> None:
        phasor[:, channel] = np.nan

    return edit


def scattered(part: float) -> Edit:
    def edit(phasor: Complexes, rng: np.random.Generator) -> None:
        hit = rng.random(phasor.shape) < part
        phasor[hit] *= 1.0 + rng.choice([-1.0, 1.0], hit.sum()) * rng.uniform(0.3, 1.0, hit.sum())

    return edit


def delay(runs: int) -> Any:
    """The same delay for every cause."""
    return lambda _kind, _element: runs


def cause_with(agreement: tuple[float, ...], *, names: tuple[str, ...]) -> Cause:
    """A cause of which each run of a window says so much."""
    change, covariance = np.full(len(names), 0.1), 1e-4 * np.eye(len(names))
    return Cause("coupling", "coupling.C1", sum(agreement), names, change, covariance, 4.0, agreement)
