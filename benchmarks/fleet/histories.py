"""The true state of a simulated machine, week after week: scatter from run to run, seasons, and the changes that happen to it.

Every week each stiffness is off by 1 % and each damping by 5 %, independent and lognormal, and each unbalance by 1 %. Over the
year the stiffnesses rise and fall by up to 2 %, all elements together, or each by its own amount at its own time.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from estimator.arrays import Bools, Complexes, Floats
from estimator.machine.document import Machine
from estimator.quantities import Quantity
from estimator.rotor.parameters import Coefficient
from estimator.simulation.simulated_plant import Truth, draw_truth

STIFFNESS_SCATTER, DAMPING_SCATTER, UNBALANCE_SCATTER = 0.01, 0.05, 0.01
SEASON = 0.02
"""Largest amplitude of the stiffnesses' way through the year."""
WEEKS_A_YEAR = 52
DAMPING: frozenset[Quantity] = frozenset({"damping", "angular damping"})

Seasonality = Literal["together", "apart", "none"]


@dataclass(frozen=True)
class State:
    """One week's truth: the machine's, and of each channel gain (m,) [-], run-out (m,) [m] and whether it is lost (m,).

    outlier_part: outliers among the phasors [-].
    """

    truth: Truth
    gain: Complexes
    run_out: Complexes
    lost: Bools
    outlier_part: float


@dataclass(frozen=True)
class MachineChange(ABC):
    """Something that befalls one element of a machine from a week on.

    element: named as in identifications, such as coupling.C1 or probe.B1L. onset: week. ramp: weeks until it has its full
    size; 0 for a step.
    """

    element: str
    onset: int
    ramp: int

    kind = ""
    """Kind of finding that a diagnosis should report."""

    def progress(self, week: int) -> float:
        """Return the part of its full size that the change has reached, 0 to 1."""
        if week < self.onset:
            return 0.0
        return 1.0 if self.ramp == 0 else min(1.0, (week - self.onset + 1) / self.ramp)

    @abstractmethod
    def on(self, state: State, part: float) -> State:
        """Return the state with this part of the change."""


@dataclass(frozen=True)
class Misaligned(MachineChange):
    """Coefficients of a coupling and of its neighbouring bearings grow, all by one factor. stiffened: those elements."""

    growth: float
    stiffened: tuple[str, ...]
    kind = "misalignment"

    def on(self, state: State, part: float) -> State:
        """Return the state with this part of the change."""
        return _grown(state, self.stiffened, self.growth * part)


@dataclass(frozen=True)
class BearingChanged(MachineChange):
    """Growth of all coefficients of one bearing, or shrinkage where the growth is negative."""

    growth: float
    kind = "bearing"

    def on(self, state: State, part: float) -> State:
        """Return the state with this part of the change."""
        return _grown(state, (self.element,), self.growth * part)


@dataclass(frozen=True)
class UnbalanceChanged(MachineChange):
    """A disc's unbalance changes by a complex part of itself."""

    by: complex
    kind = "unbalance"

    def on(self, state: State, part: float) -> State:
        """Return the state with this part of the change."""
        truth = state.truth
        here = np.array([one.element == self.element for one in truth.unknowns.unbalances])
        return replace(state, truth=replace(truth, unbalances=truth.unbalances * (1.0 + here * self.by * part)))


@dataclass(frozen=True)
class GainDrifted(MachineChange):
    """A probe shows too much, or too little where `by` is negative. channel: its place among the machine's."""

    channel: int
    by: float
    kind = "sensor"

    def on(self, state: State, part: float) -> State:
        """Return the state with this part of the change."""
        gain = state.gain.copy()
        gain[self.channel] *= 1.0 + self.by * part
        return replace(state, gain=gain)


@dataclass(frozen=True)
class ProbeLost(MachineChange):
    """A probe delivers nothing any more."""

    channel: int
    kind = "sensor"

    def on(self, state: State, part: float) -> State:
        """Return the state with this part of the change."""
        lost = state.lost.copy()
        lost[self.channel] |= part > 0.0
        return replace(state, lost=lost)


@dataclass(frozen=True)
class RunOutChanged(MachineChange):
    """The shaft under a probe was scratched: the same vector [m] at every speed."""

    channel: int
    by: complex
    kind = "run_out"

    def on(self, state: State, part: float) -> State:
        """Return the state with this part of the change."""
        run_out = state.run_out.copy()
        run_out[self.channel] += self.by * part
        return replace(state, run_out=run_out)


@dataclass(frozen=True)
class OutliersBegan(MachineChange):
    """A part of all phasors is grossly wrong, whatever the channel."""

    of: float
    kind = "outliers"

    def on(self, state: State, part: float) -> State:
        """Return the state with this part of the change."""
        return replace(state, outlier_part=self.of * part)


@dataclass(frozen=True)
class Season:
    """A sine over the year on the logarithm of each stiffness: amplitude and phase [rad] (K,) per coefficient."""

    amplitude: Floats
    phase: Floats

    @classmethod
    def draw(cls, coefficients: Sequence[Coefficient], how: Seasonality, rng: np.random.Generator) -> "Season":
        """Draw a season of one machine: the same for all elements, or for each its own amplitude up to SEASON and its own
        phase."""
        names = list(dict.fromkeys(one.element for one in coefficients))
        place = np.array([names.index(one.element) for one in coefficients])
        if how == "apart":
            share, phase = rng.uniform(0.0, 1.0, len(names)), rng.uniform(0.0, 2.0 * math.pi, len(names))
        else:
            share = np.full(len(names), 1.0 if how == "together" else 0.0)
            phase = np.full(len(names), rng.uniform(0.0, 2.0 * math.pi))
        stiff = np.array([one.quantity not in DAMPING for one in coefficients])
        return cls(SEASON * share[place] * stiff, phase[place])

    def at(self, week: int) -> Floats:
        """Return the factors (K,) on the coefficients."""
        return np.asarray(np.exp(self.amplitude * np.sin(2.0 * math.pi * week / WEEKS_A_YEAR + self.phase)))


@dataclass(frozen=True)
class History:
    """A machine's weeks of truth and what befell it. baseline: how many of the first weeks are known to be good."""

    machine: Machine
    states: tuple[State, ...]
    changes: tuple[MachineChange, ...]
    baseline: int


def history(
    machine: Machine,
    changes: Sequence[MachineChange],
    *,
    weeks: int,
    baseline: int,
    seasonality: Seasonality,
    rng: np.random.Generator,
) -> History:
    """Return weekly truths of a machine near its document."""
    usual = draw_truth(machine, rng)
    season = Season.draw(usual.unknowns.coefficients, seasonality, rng)
    channels = len(machine.probes)
    states = []
    for week in range(weeks):
        now = _scattered(replace(usual, coefficients=usual.coefficients * season.at(week)), rng)
        state = State(
            now,
            np.ones(channels, dtype=complex),
            np.zeros(channels, dtype=complex),
            np.zeros(channels, dtype=bool),
            0.0,
        )
        for change in changes:
            part = change.progress(week)
            state = change.on(state, part) if part > 0.0 else state
        states.append(state)
    return History(machine, tuple(states), tuple(changes), baseline)


def _scattered(truth: Truth, rng: np.random.Generator) -> Truth:
    size = np.array([DAMPING_SCATTER if one.quantity in DAMPING else STIFFNESS_SCATTER for one in truth.unknowns.coefficients])
    coefficients = truth.coefficients * np.exp(size * rng.standard_normal(size.size))
    count = truth.unbalances.size
    turn = (rng.standard_normal(count) + 1j * rng.standard_normal(count)) / math.sqrt(2.0)
    return replace(truth, coefficients=coefficients, unbalances=truth.unbalances * (1.0 + UNBALANCE_SCATTER * turn))


def _grown(state: State, elements: tuple[str, ...], growth: float) -> State:
    truth = state.truth
    here = np.array([one.element in elements for one in truth.unknowns.coefficients])
    return replace(state, truth=replace(truth, coefficients=truth.coefficients * (1.0 + growth * here)))
