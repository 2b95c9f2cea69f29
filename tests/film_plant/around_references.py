"""Trains drawn around two references, a motor and compressor and a turbine and its generator: as the same design would turn
out for another machine of the kind.

Lengths, masses, clearances, oil and couplings differ by up to 15 to 20 % from their reference's, diameters by up to 8 %:
bending goes with their fourth power.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from tests.film_plant.motor_compressor import CouplingKind, motor_compressor
from tests.film_plant.proportions import placed
from tests.film_plant.train import ConstantOil, Coupling, Disc, Shaft, Train
from tests.film_plant.turbine_generator import turbine_generator

LENGTH, DIAMETER, MASS, CLEARANCE, OIL, COUPLING = 0.15, 0.08, 0.15, 0.15, 0.15, 0.2
"""Largest differences from the reference [-]."""
SPEED = 0.05
"""Largest difference of the highest speed [-]."""


@dataclass(frozen=True)
class ReferenceTrain:
    """A reference: its name, its train by the kind of its coupling, and its speed range [r/min]."""

    name: str
    train: Callable[[CouplingKind], Train]
    slowest: float
    fastest: float


MOTOR_COMPRESSOR = ReferenceTrain("motor-compressor", motor_compressor, 700.0, 4600.0)
TURBINE_GENERATOR = ReferenceTrain("turbine-generator", turbine_generator, 600.0, 3780.0)


def train_around(reference: ReferenceTrain, kind: CouplingKind, rng: np.random.Generator) -> Train:
    """Draw a train around a reference, as its document describes it, aligned."""
    train = reference.train(kind)
    shafts, stations = zip(*(_shaft(one, rng) for one in train.shafts), strict=True)
    thicker = [float(_factor(rng, DIAMETER)) for _ in shafts]
    wider = float(_factor(rng, CLEARANCE))
    oil = float(_factor(rng, OIL))
    bearings = []
    for one in train.bearings:
        assert isinstance(one.oil, ConstantOil)
        size = thicker[one.shaft]
        bearings.append(
            replace(
                one,
                station=stations[one.shaft](one.station),
                diameter=size * one.diameter,
                length=size * one.length,
                clearance=wider * size * one.clearance,
                oil=ConstantOil(oil * one.oil.value),
            )
        )
    found = replace(
        train,
        shafts=tuple(_thicker(one, size) for one, size in zip(shafts, thicker, strict=True)),
        discs=tuple(_heavier(replace(one, station=stations[one.shaft](one.station)), rng) for one in train.discs),
        bearings=tuple(bearings),
        couplings=tuple(_stiffer(one, rng) for one in train.couplings),
        refinement=2,
    )
    return placed(found)


def _factor(rng: np.random.Generator, part: float) -> float:
    return float(rng.uniform(1.0 - part, 1.0 + part))


def _shaft(shaft: Shaft, rng: np.random.Generator) -> tuple[Shaft, Callable[[float], float]]:
    """A shaft with other lengths, and where a station of the old one lies on it."""
    pieces = tuple((_factor(rng, LENGTH) * length, diameter) for length, diameter in shaft.pieces)
    before = np.cumsum([0.0, *(length for length, _ in shaft.pieces)])
    after = np.cumsum([0.0, *(length for length, _ in pieces)])
    return Shaft(pieces), lambda station: float(np.interp(station, before, after))


def _thicker(shaft: Shaft, size: float) -> Shaft:
    return Shaft(tuple((length, size * diameter) for length, diameter in shaft.pieces))


def _heavier(disc: Disc, rng: np.random.Generator) -> Disc:
    more = _factor(rng, MASS)
    return replace(
        disc,
        mass=more * disc.mass,
        diametral_inertia=more * disc.diametral_inertia,
        polar_inertia=more * disc.polar_inertia,
        unbalance=more * disc.unbalance,
    )


def _stiffer(coupling: Coupling, rng: np.random.Generator) -> Coupling:
    lateral, slowed, angular = (_factor(rng, COUPLING) for _ in range(3))
    return replace(
        coupling,
        stiffness=lateral * coupling.stiffness,
        damping=slowed * coupling.damping,
        k_phix=angular * coupling.k_phix,
        k_phiy=angular * coupling.k_phiy,
    )
