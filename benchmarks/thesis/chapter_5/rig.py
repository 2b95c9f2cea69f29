"""The simulated rig of Chapter 5 for the evidence: where it is measured, and what fits and regressions make of the data."""

import copy
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml

from benchmarks.documents import Document
from estimator.arrays import Complexes, Floats
from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.machine.document import Machine, parse_machine
from estimator.machine.parameter_description import is_direct
from estimator.phasors.measurement import Measurement
from estimator.phasors.noise import error_size
from estimator.rotor.condensation import CondensedTrain, condense
from estimator.rotor.response import response, sensitivity
from estimator.simulation.simulated_plant import noise
from estimator.thesis.flexible_train import flexible_train, full_response
from estimator.thesis.reduced_model import reduced_response, response_equations
from estimator.thesis.reduction import high_frequency_condensed
from estimator.thesis.regression import Regression, solve
from estimator.thesis.response_regression import speed_independent_regression
from estimator.thesis.rig import (
    SPEEDS_HZ,
    nominal_values,
)
from estimator.trends.parameter_vector import Point

ROOT = Path(__file__).parents[3]
RELATIVE_NOISE = 0.01
SETS = range(3)
"""Noise seeds of the three sets of measured data (§5.5)."""
START_SEED = 7000
START_SPAN = 0.5
"""Fits start from a document whose coefficients are off by a factor uniform in 1 ± this, and which knows no unbalance."""
COEFFICIENTS = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy", "k_phix", "k_phiy")
DETERMINED, LOST = 0.1, 1.0
"""A direction is called determined below, lost above this standard error; 1 is a factor e of a direct term."""
LARGEST_GROWTH = "bearing.B4.cyx"
KINDS: tuple[tuple[str, str, tuple[str, ...]], ...] = (
    ("bearing k direct", "bearing", ("kxx", "kyy")),
    ("bearing c direct", "bearing", ("cxx", "cyy")),
    ("coupling k direct", "coupling", ("kxx", "kyy")),
    ("coupling k_φ", "coupling", ("k_phix", "k_phiy")),
)


@dataclass(frozen=True)
class Campaign:
    """Speeds (S,) [Hz] and directions (S,) of a measurement, and the floor of its noise [m] beside RELATIVE_NOISE."""

    title: str
    speed_hz: Floats
    direction: Floats
    floor: float

    @property
    def speed(self) -> Floats:
        """Return the speeds [rad/s]."""
        return 2.0 * math.pi * self.speed_hz


def one_way(title: str, speed_hz: Sequence[float] | Floats, *, floor: float) -> Campaign:
    """Return the campaign with forward rotation only."""
    return Campaign(title, np.asarray(speed_hz, dtype=float), np.ones(len(speed_hz)), floor)


FLOOR = 5.0e-8
PRINTED = one_way("the eight printed speeds", SPEEDS_HZ, floor=0.0)
PRINTED_WITH_FLOOR = one_way("the eight printed speeds, noise floor 50 nm", SPEEDS_HZ, floor=FLOOR)
BOTH_WAYS = Campaign(
    "the eight printed speeds, both senses", np.tile(SPEEDS_HZ, 2), np.repeat([1.0, -1.0], len(SPEEDS_HZ)), 0.0
)
DENSE = one_way("100 speeds, 17 to 41 Hz", np.linspace(17.0, 41.0, 100), floor=0.0)
RESONANCES = one_way(
    "eight speeds, 140 to 158 and 190 to 220 Hz, floor 50 nm",
    np.concatenate([np.linspace(140.0, 158.0, 4), np.linspace(190.0, 220.0, 4)]),
    floor=FLOOR,
)
BELOW = one_way("200 speeds, 5 to 130 Hz, floor 50 nm", np.linspace(5.0, 130.0, 200), floor=FLOOR)
RUN_UP = one_way("200 speeds, 5 to 200 Hz, floor 50 nm", np.linspace(5.0, 200.0, 200), floor=FLOOR)
RUN_UP_WITHOUT_FLOOR = one_way("200 speeds, 5 to 200 Hz", np.linspace(5.0, 200.0, 200), floor=0.0)
CAMPAIGNS = {"printed": PRINTED, "resonances": RESONANCES, "run-up": RUN_UP}


@dataclass(frozen=True)
class Rig:
    """The rig's document and machine, its true coefficients (K,) and unbalances (P,), and the coefficients' names."""

    document: Document
    machine: Machine
    coefficients: Floats
    unbalances: Complexes
    names: tuple[str, ...]

    def train(self, campaign: Campaign) -> CondensedTrain:
        """Return the train condensed at the campaign's speeds."""
        return condense(self.machine, speed=campaign.speed, direction=campaign.direction)

    def measured(self, campaign: Campaign, *, seed: int, factors: Floats | None = None) -> Measurement:
        """Return one noisy data set, of a rig whose coefficients are multiplied by factors (K,)."""
        coefficients = self.coefficients * (1.0 if factors is None else factors)
        clean = response(self.train(campaign), coefficients=coefficients, excitations=self.unbalances)
        model = self.machine.noise.model_copy(update={"relative": RELATIVE_NOISE, "floor": campaign.floor})
        phasor = clean + noise(model, clean, np.random.default_rng(seed))
        shape = phasor.shape
        return Measurement(campaign.speed, campaign.direction, phasor, np.ones(shape, dtype=bool), np.full(shape, np.nan))


def load() -> Rig:
    """Load the rig of `examples/thesis-chapter-5-rig.yaml`."""
    document = yaml.safe_load((ROOT / "examples" / "thesis-chapter-5-rig.yaml").read_text(encoding="utf-8"))
    machine = parse_machine(document)
    coefficients, unbalances = nominal_values(machine)
    names = tuple(one.name for one in flexible_train(machine).unknowns.coefficients)
    return Rig(document, machine, coefficients, unbalances, names)


def wrong_machine(rig: Rig, *, floor: float, seed: int) -> Machine:
    """Return a machine that knows the rig's coefficients within ± 50 % and no unbalance."""
    rng = np.random.default_rng(START_SEED + seed)
    changed = copy.deepcopy(rig.document)
    for part in (*changed["bearings"], *changed["couplings"]):
        for name in COEFFICIENTS:
            if name in part:
                part[name] *= 1.0 + rng.uniform(-START_SPAN, START_SPAN)
    for disc in changed["discs"]:
        del disc["unbalance"]
    changed["noise"] = {"relative": RELATIVE_NOISE, "floor": floor}
    return parse_machine(changed)


def fitted(rig: Rig, campaign: Campaign, *, seed: int, factors: Floats | None = None) -> Identification:
    """Fit one data set by maximum likelihood; the document is the same wrong one for all sets."""
    machine = wrong_machine(rig, floor=campaign.floor, seed=0)
    return identify(machine, rig.measured(campaign, seed=seed, factors=factors), Options())


def regression(rig: Rig, campaign: Campaign, *, seed: int | None, own_model: bool) -> Regression:
    """Return Chapter 4's regression (Eq. 4.71, 5.3) on one data set with 1 % circular noise, or with none.

    own_model: the data come from the regression's own high-frequency reduction instead of the full model.
    """
    train = flexible_train(rig.machine)
    model = high_frequency_condensed(train, speed=campaign.speed, direction=campaign.direction)
    if own_model:
        clean = reduced_response(model, coefficients=rig.coefficients, unbalances=rig.unbalances)
    else:
        clean = full_response(
            train,
            coefficients=rig.coefficients,
            unbalances=rig.unbalances,
            speed=campaign.speed,
            direction=campaign.direction,
        )[:, train.bearing]
    if seed is not None:
        model_noise = rig.machine.noise.model_copy(update={"relative": RELATIVE_NOISE, "floor": campaign.floor})
        clean = clean + noise(model_noise, clean, np.random.default_rng(seed))
    return speed_independent_regression(
        response_equations(model, clean), train.unknowns, mean_speed=float(campaign.speed.mean()), damping_scaled=True
    )


def regressed(rig: Rig, campaign: Campaign, *, seed: int | None, own_model: bool) -> Floats:
    """Return values (K + 2P,) that the regression finds, its columns scaled to equal norm."""
    return solve(regression(rig, campaign, seed=seed, own_model=own_model), scaling="norm").values


def information_root(rig: Rig, campaign: Campaign) -> Floats:
    """Return rows (2Sm, K + 2P) whose product with themselves is the Fisher information at the truth.

    Direct terms count by their logarithm, cross-coupled ones in units of their element's direct terms, unbalances of the
    larger one.
    """
    train = rig.train(campaign)
    found = sensitivity(train, coefficients=rig.coefficients, excitations=rig.unbalances)
    unit = [
        abs(value) if one.direct else one.scale
        for one, value in zip(train.unknowns.coefficients, rig.coefficients, strict=True)
    ]
    slope = found.by_parameter * np.array([*unit, *[float(np.abs(rig.unbalances).max())] * (2 * rig.unbalances.size)])
    model = rig.machine.noise.model_copy(update={"relative": RELATIVE_NOISE, "floor": campaign.floor})
    size = error_size(model, np.abs(found.phasor), np.full(found.phasor.shape, np.nan))
    rows = (slope * (math.sqrt(2.0) / size)[..., None]).reshape(-1, slope.shape[-1])
    return np.concatenate([rows.real, rows.imag])


@dataclass(frozen=True)
class Bounds:
    """Cramér-Rao bounds: standard errors of the parameters (K + 2P,) and of the independent directions, ascending."""

    parameters: Floats
    directions: Floats


def bounds(rig: Rig, campaign: Campaign) -> Bounds:
    """Return the best that a campaign determines, without any prior; in the units of `information_root`."""
    _, values, right = np.linalg.svd(information_root(rig, campaign), full_matrices=False)
    return Bounds(np.sqrt(np.sum((right / values[:, None]) ** 2, axis=0)), 1.0 / values)


def logarithmic_point(outcome: Identification) -> Point:
    """Return the direct terms that a fit determined, as logarithms, with their covariance."""
    values = {one.name: one.value for one in outcome.estimates if one.value is not None and is_direct(one.name)}
    names = [name for name in outcome.coordinates if name in values]
    index = [outcome.coordinates.index(name) for name in names]
    return Point(tuple(names), np.log(np.array([values[name] for name in names])), outcome.covariance[np.ix_(index, index)])
