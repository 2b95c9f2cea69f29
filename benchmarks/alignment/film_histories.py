"""Histories of machines on oil films, run after run: seasons of oil, pedestals that grow, and what happens to them.

Weekly run-downs. One supply oils all bearings, whose viscosities differ by 3 %. Films scatter by 1 % in stiffness and 5 % in
damping, the oil's weather by 5 % of viscosity (some 2 K); over the year the oil is up to 10 K warmer and colder, and the
second shaft's pedestals grow by 1 µm/K against the first's, with either sign. A third of the machines is misaligned by half
of what is allowed from the beginning. In every other machine the oil's temperature is sent. Baselines are of 5 to 8 runs.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np
import scipy.optimize

from estimator.alignment.tolerance import AllowedAlignment, allowed_alignment
from estimator.machine.document import Machine, parse_machine
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, with_pedestals
from tests.film_plant.misalignment import ONE_SUPPLY, moved
from tests.film_plant.motor_compressor import CouplingKind
from tests.film_plant.oil import walther
from tests.film_plant.plant import Plant
from tests.film_plant.plants import reference_plant
from tests.film_plant.train import ConstantOil, Train

Happening = Literal["healthy", "step", "beyond", "within", "wear", "unbalance", "gain", "bore", "face", "pedestal", "oil"]
HAPPENINGS: tuple[Happening, ...] = (
    "healthy",
    "step",
    "beyond",
    "within",
    "wear",
    "unbalance",
    "gain",
    "bore",
    "face",
    "pedestal",
)
"""Events of a history: nothing; the second shaft sinks by the step that is asked, by twice and by half of what is allowed; a
clearance grows by 15 %, an unbalance by half, a probe's gain by 10 %; the coupling's bore or face runs out by `RUN_OUTS`; of a
machine on pedestals the stiffness of one falls by 20 %. Beside another, the oil gets 10 K colder at once, too."""
PEDESTAL_SPREAD = 0.2
"""Spread of pedestals' numbers that documents state, and by which they are off [-]."""
RUN_OUTS: dict[Happening, dict[CouplingKind, tuple[float, float]]] = {
    "bore": {"rigid": (2e-6, 0.0), "flexible": (5e-6, 0.0)},
    "face": {"rigid": (0.0, 10e-6), "flexible": (0.0, 50e-6)},
}
"""Run-outs of a coupling that are asked to be seen: offset of its bore [m], angle of its face [rad]."""
STEPS: dict[CouplingKind, float] = {"rigid": 20e-6, "flexible": 100e-6}
"""Steps of the offset that are asked to be seen [m]."""
BELIEVED = replace(ONE_SUPPLY, elevation=150e-6, rigid_elevation=150e-6)
SEASON_K, GROWTH = 10.0, 1e-6
"""Amplitude of the oil's season [K], and growth of pedestals against each other [m/K]."""
SHORTEST_BASELINE, LONGEST_BASELINE = 5, 8
"""Fewest and most runs of a baseline."""
WEEKS_A_YEAR = 52
GRADE = 46


@dataclass(frozen=True)
class FilmHistory:
    """One machine's history.

    Attributes:
        seed: Seed of everything that is drawn; of even ones the plant is a motor and compressor, of odd ones a turbine and its
            generator.
        kind: Kind of its coupling.
        happening: What happens to it.
        onset: Week from which on it has happened.
        beside: What happens to it in the same week, besides.
    """

    seed: int
    kind: CouplingKind
    happening: Happening
    onset: int
    beside: Happening = "healthy"

    @property
    def causes(self) -> tuple[Happening, Happening]:
        """Return both things that happen."""
        return self.happening, self.beside

    @property
    def baseline(self) -> int:
        """Return of how many runs its baseline is."""
        return int(np.random.default_rng([self.seed, 5]).integers(SHORTEST_BASELINE, LONGEST_BASELINE + 1))

    @cached_property
    def sent(self) -> bool:
        """Return whether the oil's temperature is sent."""
        return self.seed // 2 % 2 == 1

    @cached_property
    def plant(self) -> Plant:
        """Return the plant as it begins: a third of them misaligned by half of what is allowed."""
        found = reference_plant(
            self.seed,
            self.kind,
            priors=ONE_SUPPLY,
            discrepancy=DiscrepancySize(),
            pedestals="pedestal" in self.causes,
        )
        left = 0.5 * self.allowed_by(found).offset if self.seed % 3 == 0 else 0.0
        return replace(found, train=moved(found.train, offset=np.array([0.0, left]), angle=np.zeros(2)))

    @cached_property
    def machine(self) -> Machine:
        """Return the machine that the plant's document describes."""
        return parse_machine(self.document)

    @cached_property
    def document(self) -> dict[str, Any]:
        """Return the plant's document, with the oil's temperature where it is sent."""
        said = film_document(self.plant, priors=BELIEVED)
        if "pedestal" in self.causes:
            said = with_pedestals(said, self.plant, spread=PEDESTAL_SPREAD, seed=self.seed)
        if self.sent:
            said["conditions"] = [{"name": "oil", "unit": "degC"}]
            for bearing in said["bearings"]:
                oil = {"iso_vg": GRADE, "temperature_c": self.mean_oil, "temperature_from": "oil"}
                bearing["film"]["oil"] = oil | {"supply": bearing["film"]["oil"]["supply"]}
        return said

    @cached_property
    def mean_oil(self) -> float:
        """Return the temperature at which the grade has the believed viscosity [°C]."""
        oil = self.plant.believed.bearings[0].oil
        assert isinstance(oil, ConstantOil)
        value = oil.value
        return float(scipy.optimize.brentq(lambda one: walther(GRADE, one) - value, 10.0, 130.0))

    def allowed_by(self, plant: Plant) -> AllowedAlignment:
        """Return what is allowed at the coupling of a plant."""
        return allowed_alignment(parse_machine(film_document(plant, priors=BELIEVED)), "C1")

    @cached_property
    def allowed(self) -> AllowedAlignment:
        """Return what is allowed at the coupling."""
        return allowed_alignment(self.machine, "C1")

    def warmer(self, week: int) -> float:
        """Return by how much the oil is warmer in a week than over the year [K]."""
        phase = np.random.default_rng([self.seed, 1]).uniform(0.0, 2.0 * math.pi)
        of_season = SEASON_K * math.sin(2.0 * math.pi * week / WEEKS_A_YEAR + phase)
        return of_season - (SEASON_K if week >= self.onset and "oil" in self.causes else 0.0)

    def offset(self, week: int) -> float:
        """Return by how much the coupling's vertical offset differs in a week from the beginning [m]."""
        sign = 1.0 if self.seed % 4 < 2 else -1.0
        grown = sign * GROWTH * self.warmer(week)
        return grown - (sum(_sunk(self, cause) for cause in self.causes) if week >= self.onset else 0.0)

    def conditions(self, week: int) -> dict[str, float | None]:
        """Return the operating conditions that are sent in a week."""
        return {"oil": self.mean_oil + self.warmer(week)} if self.sent else {}

    def plant_in(self, week: int) -> Plant:
        """Return the plant in a week, without the scatter of single runs."""
        thicker = walther(GRADE, self.mean_oil + self.warmer(week)) / walther(GRADE, self.mean_oil)
        train = moved(self.plant.train, offset=np.array([0.0, self.offset(week)]), angle=np.zeros(2))
        train = _thickened(train, thicker)
        for cause in self.causes if week >= self.onset else ():
            train = _changed(train, self, cause)
        return replace(self.plant, train=train)

    @property
    def number(self) -> int:
        """Return the place of the bearing, disc or probe that something happens to."""
        return _number_of(self, self.happening)

    @property
    def named(self) -> tuple[str, str] | None:
        """Return rule and element of the alert that what happens should raise; None for none."""
        return expected_alert(self, self.happening)


def expected_alert(history: FilmHistory, happening: Happening) -> tuple[str, str] | None:
    """Return rule and element of the alert that something should raise on a machine; None for none."""
    number = _number_of(history, happening)
    probes = history.machine.probes
    rules: dict[Happening, tuple[str, str]] = {
        "step": ("misalignment", "coupling.C1"),
        "beyond": ("misalignment", "coupling.C1"),
        "wear": ("wear", f"bearing.B{number + 1}"),
        "pedestal": ("pedestal", f"pedestal.P{number + 1}"),
        "unbalance": ("unbalance", f"disc.D{number + 1}"),
        "gain": ("sensor", f"probe.{probes[number % len(probes)].id}"),
        "bore": ("rotating_coupling", "coupling.C1"),
        "face": ("rotating_coupling", "coupling.C1"),
    }
    return rules.get(happening)


def _number_of(history: FilmHistory, happening: Happening) -> int:
    bearings = len(history.plant.train.bearings)
    many = {"wear": bearings, "pedestal": bearings, "unbalance": len(history.plant.train.discs)}
    return history.seed % many.get(happening, len(history.machine.probes))


def _changed(train: Train, history: FilmHistory, cause: Happening) -> Train:
    number = _number_of(history, cause)
    if cause == "wear":
        return _worn(train, number, 1.15)
    if cause == "pedestal":
        return _softened(train, number, 0.8)
    if cause == "unbalance":
        return _unbalanced(train, number, 1.5)
    if cause in RUN_OUTS:
        turned = np.exp(1j * np.random.default_rng([history.seed, 4]).uniform(0.0, 2.0 * math.pi))
        return _running_out(train, *(complex(turned * one) for one in RUN_OUTS[cause][history.kind]))
    return train


def _sunk(history: FilmHistory, cause: Happening) -> float:
    sizes: dict[Happening, float] = {
        "step": STEPS[history.kind],
        "beyond": 2.0 * history.allowed.offset,
        "within": 0.5 * history.allowed.offset,
    }
    return sizes.get(cause, 0.0)


def _thickened(train: Train, factor: float) -> Train:
    bearings = []
    for one in train.bearings:
        assert isinstance(one.oil, ConstantOil)
        bearings.append(replace(one, oil=ConstantOil(factor * one.oil.value)))
    return replace(train, bearings=tuple(bearings))


def _worn(train: Train, number: int, factor: float) -> Train:
    bearings = tuple(
        replace(one, clearance=factor * one.clearance) if place == number else one for place, one in enumerate(train.bearings)
    )
    return replace(train, bearings=bearings)


def _softened(train: Train, number: int, factor: float) -> Train:
    bearings = []
    for place, one in enumerate(train.bearings):
        assert one.pedestal is not None
        x, y = one.pedestal.stiffness
        softer = replace(one.pedestal, stiffness=(factor * x, factor * y))
        bearings.append(replace(one, pedestal=softer) if place == number else one)
    return replace(train, bearings=tuple(bearings))


def _unbalanced(train: Train, number: int, factor: float) -> Train:
    discs = tuple(
        replace(one, unbalance=factor * one.unbalance) if place == number else one for place, one in enumerate(train.discs)
    )
    return replace(train, discs=discs)


def _running_out(train: Train, offset: complex, angle: complex) -> Train:
    couplings = (replace(train.couplings[0], run_out=(offset, angle)), *train.couplings[1:])
    return replace(train, couplings=couplings)
