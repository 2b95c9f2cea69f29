"""Random trains of other proportions: one to three shafts, overhung discs, other bores, other loads, soft pedestals."""

from dataclasses import dataclass

import numpy as np

from tests.film_plant.film_table import KEPT_SLENDERNESS
from tests.film_plant.motor_compressor import CouplingKind
from tests.film_plant.oil import walther
from tests.film_plant.proportions import OTHER_SLENDERNESS, coupling_of, disc_of, placed, standing
from tests.film_plant.train import Bearing, ConstantOil, Disc, Oil, Shaft, Train

PRESSURES = (0.3e6, 2.0e6)
"""Specific pressures that bearings are drawn for [Pa]."""
SPEEDS_RPM = (1500.0, 12_000.0)
"""Lowest and highest top speed of a train [r/min]."""
FASTEST_SURFACE = 80.0
"""Highest speed of a journal's surface [m/s]."""
BORES: dict[str, tuple[float, ...]] = {
    "plain": KEPT_SLENDERNESS,
    "grooved": OTHER_SLENDERNESS,
    "elliptical": OTHER_SLENDERNESS,
    "three_lobe": OTHER_SLENDERNESS,
    "four_lobe": OTHER_SLENDERNESS,
    "five_pads": (0.5,),
}
"""Bores, with the L/D at which the plant has tables of them [-]."""
OVERHUNG, ON_PEDESTALS = 0.4, 0.35
"""Part of the trains with a disc beyond a bearing, and of those on soft pedestals [-]."""


@dataclass(frozen=True)
class _Part:
    """A shaft alone with its discs and bearings, and its first critical speed on rigid bearings [rad/s]."""

    shaft: Shaft
    discs: tuple[Disc, ...]
    bearings: tuple[Bearing, ...]
    critical: float


def other_train(rng: np.random.Generator) -> tuple[Train, CouplingKind, float]:
    """Draw a train as its document describes it, with the kind of its couplings and its highest speed [rad/s]."""
    count = int(rng.choice([1, 2, 3]))
    kind: CouplingKind = "flexible" if rng.random() < 0.6 else "rigid"
    diameter = float(np.exp(rng.uniform(np.log(0.05), np.log(0.22))))
    grade, temperature = int(rng.choice([32, 46, 68])), rng.uniform(48.0, 70.0)
    oil = ConstantOil(walther(grade, temperature))
    bore = str(rng.choice(list(BORES)))
    overhung = rng.random() < OVERHUNG
    parts = [
        _part(rng, number, diameter * rng.uniform(0.8, 1.1), oil, bore, overhung=overhung and number == count - 1)
        for number in range(count)
    ]
    top = rng.uniform(1.15, 2.0) * min(one.critical for one in parts)
    largest = max(one.diameter for part in parts for one in part.bearings)
    low, high = (np.pi / 30 * speed for speed in SPEEDS_RPM)
    fastest = float(max(low, min(top, 2 * FASTEST_SURFACE / largest, high)))
    bearings = tuple(one for part in parts for one in part.bearings)
    if rng.random() < ON_PEDESTALS:
        bearings = tuple(standing(one, fastest, rng) for one in bearings)
    couplings = tuple(coupling_of(rng, kind, diameter / 0.08) for _ in range(count - 1))
    discs = tuple(one for part in parts for one in part.discs)
    train = Train(tuple(one.shaft for one in parts), discs, bearings, couplings, refinement=2)
    return placed(train), kind, fastest


def _part(rng: np.random.Generator, number: int, diameter: float, oil: Oil, bore: str, *, overhung: bool) -> _Part:
    """Draw a shaft on two bearings with one to three discs, of which the last may be overhung at the driven end."""
    slenderness = float(rng.choice(BORES[bore]))
    body, span = diameter * rng.uniform(1.2, 2.0), diameter * rng.uniform(7.0, 16.0)
    ends = diameter * rng.uniform(0.7, 2.2, 2)
    if overhung:
        ends[1] = diameter * rng.uniform(2.0, 3.0)
    inner = int(rng.choice([1, 2, 3]))
    neck = 0.1 * span
    cuts = span * (np.arange(inner) + 1.0 + rng.uniform(-0.15, 0.15, inner)) / (inner + 1.0)
    edges = np.concatenate([[neck], cuts, [span - neck]])
    pieces = [(float(ends[0]), diameter), (neck, diameter), *((float(one), body) for one in np.diff(edges))]
    pieces += [(neck, diameter), (float(ends[1]), diameter)]
    shaft_mass = 7850.0 * np.pi / 4 * sum(length * d**2 for length, d in pieces)
    total = max(2 * rng.uniform(*PRESSURES) * slenderness * diameter**2 / 9.81, 1.3 * shaft_mass)
    stations = ends[0] + cuts
    shares = rng.uniform(0.5, 1.0, inner)
    if overhung:
        stations, shares = np.append(stations, ends[0] + span + 0.8 * ends[1]), np.append(shares, 0.25)
    masses = (total - shaft_mass) * shares / shares.sum()
    discs = tuple(
        disc_of(number, float(station), float(mass), body, span) for station, mass in zip(stations, masses, strict=True)
    )
    clearance = float(diameter / 2 * rng.uniform(1e-3, 2e-3))
    bearings = tuple(
        Bearing(number, float(station), diameter, slenderness * diameter, clearance, oil, bore)
        for station in (ends[0], ends[0] + span)
    )
    return _Part(Shaft(tuple(pieces)), discs, bearings, _critical(float(total), span, body))


def _critical(mass: float, span: float, body: float) -> float:
    """First critical speed of a shaft on rigid bearings by its sag [rad/s]."""
    sag = 9.81 * mass * 0.75 * span**3 / (48 * 2.06e11 * np.pi / 64 * body**4)
    return float(np.sqrt(9.81 / sag))
