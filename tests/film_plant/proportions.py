"""Random trains as their documents would describe them: two shafts on four journal bearings, of industrial proportions."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from tests.film_plant.arrays import Floats
from tests.film_plant.film_table import KEPT_SLENDERNESS
from tests.film_plant.motor_compressor import CouplingKind
from tests.film_plant.oil import HeatedOil, walther
from tests.film_plant.statics import aligned_elevations
from tests.film_plant.train import Bearing, ConstantOil, Coupling, Disc, Oil, Pedestal, Shaft, Train

PRESSURES = (0.4e6, 1.1e6)
"""Specific pressures that bearings are drawn for [Pa]."""
FASTEST_SURFACE = 50.0
"""Highest speed of a journal's surface [m/s]."""
OTHER_SLENDERNESS = (0.5, 0.8)
"""Slenderness of bearings whose bore is not plain, or will be said to be [-]."""


@dataclass(frozen=True)
class _ShaftDraw:
    """A shaft alone: its pieces, discs, bearings and what it can run at [rad/s]."""

    shaft: Shaft
    discs: tuple[Disc, ...]
    bearings: tuple[Bearing, ...]
    critical: float


@dataclass(frozen=True)
class Design:
    """Kind of a train.

    Attributes:
        coupling: Kind of the coupling; None draws it.
        profile: Bore of all bearings.
        slenderness: L/D that bearings are drawn from [-].
        pedestals: Whether the bearings stand on pedestals with resonances inside the speed range.
        heated: Whether a heat balance gives the viscosity.
    """

    coupling: CouplingKind | None = None
    profile: str = "plain"
    slenderness: Sequence[float] = KEPT_SLENDERNESS
    pedestals: bool = False
    heated: bool = False


def believed_train(rng: np.random.Generator, design: Design) -> tuple[Train, CouplingKind, float]:
    """Draw a train as its document describes it, with the kind of its coupling and its highest speed [rad/s]."""
    kind: CouplingKind = design.coupling or ("flexible" if rng.random() < 0.7 else "rigid")
    diameter = float(np.exp(rng.uniform(np.log(0.06), np.log(0.15))))
    grade = int(rng.choice([32, 46]))
    inlet = rng.uniform(40.0, 48.0)
    oil: Oil = HeatedOil(grade, inlet) if design.heated else ConstantOil(walther(grade, inlet + rng.uniform(12.0, 25.0)))
    draws = [
        _shaft(rng, number, diameter * (1.0 if number == 0 else rng.uniform(0.85, 1.1)), oil, design) for number in (0, 1)
    ]
    fastest = min(rng.uniform(1.15, 1.75) * min(one.critical for one in draws), 2 * FASTEST_SURFACE / diameter)
    bearings = tuple(one for draw in draws for one in draw.bearings)
    if design.pedestals:
        bearings = tuple(standing(one, fastest, rng) for one in bearings)
    train = Train(
        tuple(one.shaft for one in draws),
        tuple(one for draw in draws for one in draw.discs),
        bearings,
        (coupling_of(rng, kind, diameter / 0.08),),
        refinement=2,
    )
    return placed(train), kind, float(fastest)


def placed(train: Train) -> Train:
    """The train with its bearings where no coupling carries anything."""
    level = aligned_elevations(train)
    bearings = tuple(replace(one, elevation=(0.0, float(y))) for one, (_, y) in zip(train.bearings, level, strict=True))
    return replace(train, bearings=bearings)


def _shaft(rng: np.random.Generator, number: int, diameter: float, oil: Oil, design: Design) -> _ShaftDraw:
    """Draw a shaft on two bearings with two discs between them."""
    slenderness = float(rng.choice(design.slenderness))
    body, span = diameter * rng.uniform(1.4, 1.8), diameter * rng.uniform(10.0, 14.0)
    outer, inner = diameter * rng.uniform(0.8, 1.4), diameter * rng.uniform(1.3, 2.0)
    if number == 1:
        outer, inner = inner, outer
    # The free end lies outwards, the coupling inwards; necks of a tenth of the span at each bearing.
    neck = 0.1 * span
    cuts = np.sort([rng.uniform(0.3, 0.45), rng.uniform(0.55, 0.7)]) * span
    pieces = (
        (outer, diameter),
        (neck, diameter),
        (cuts[0] - neck, body),
        (cuts[1] - cuts[0], body),
        (span - neck - cuts[1], body),
        (neck, diameter),
        (inner, diameter),
    )
    shaft_mass = 7850.0 * np.pi / 4 * sum(length * d**2 for length, d in pieces)
    total = max(2 * rng.uniform(*PRESSURES) * slenderness * diameter**2 / 9.81, 1.4 * shaft_mass)
    shares = rng.uniform(0.42, 0.58)
    discs = tuple(
        disc_of(number, float(outer + cut), float(share * (total - shaft_mass)), body, span)
        for cut, share in zip(cuts, (shares, 1.0 - shares), strict=True)
    )
    bearings = tuple(
        Bearing(
            number,
            float(station),
            diameter,
            slenderness * diameter,
            float(diameter / 2 * rng.uniform(1e-3, 2e-3)),
            oil,
            design.profile,
        )
        for station in (outer, outer + span)
    )
    sag = 9.81 * total * 0.75 * span**3 / (48 * 2.06e11 * np.pi / 64 * body**4)
    shaft = Shaft(tuple((float(length), float(d)) for length, d in pieces))
    return _ShaftDraw(shaft, discs, bearings, float(np.sqrt(9.81 / sag)))


def disc_of(shaft: int, station: float, mass: float, body: float, span: float) -> Disc:
    """A disc of a mass as a solid steel cylinder of a sixth of the span in length."""
    length = span / 6
    radius = np.sqrt(mass / (7850.0 * np.pi * length) + body**2 / 4)
    polar = mass * (radius**2 + body**2 / 4) / 2
    return Disc(shaft, station, mass, float(polar / 2 + mass * length**2 / 12), float(polar))


def coupling_of(rng: np.random.Generator, kind: CouplingKind, size: float) -> Coupling:
    """A coupling for a shaft of `size` times 80 mm."""
    half = (5.5 * size**3, 0.012 * size**5, 0.02 * size**5)
    if kind == "rigid":
        lateral, slowed, angular = 3e9 * size, 1e4 * size, 3e7 * size**3
        return Coupling(lateral * np.eye(2), slowed * np.eye(2), angular, angular, half)
    lateral, slowed, angular = (
        one * float(np.exp(0.3 * rng.standard_normal())) for one in (1.2e6 * size, 300.0 * size, 2e4 * size**3)
    )
    return Coupling(lateral * np.eye(2), slowed * np.eye(2), angular, angular, half)


def standing(bearing: Bearing, fastest: float, rng: np.random.Generator) -> Bearing:
    """The bearing on a pedestal whose own frequencies with its mass lie between 0.5 and 1.3 of the highest speed."""
    mass = 7850.0 * (2.2 * bearing.diameter) ** 3 * rng.uniform(0.8, 1.5)
    frequency = np.array([rng.uniform(0.5, 0.8), rng.uniform(0.8, 1.3)]) * fastest
    stiffness = mass * frequency**2
    damping = 2 * rng.uniform(0.03, 0.08) * mass * frequency
    sides = (float(mass), float(mass))
    return replace(bearing, pedestal=Pedestal(sides, _pair(stiffness), _pair(damping)))


def _pair(values: Floats) -> tuple[float, float]:
    """Values (2,) as a pair."""
    return float(values[0]), float(values[1])
