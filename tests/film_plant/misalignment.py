"""Misalignment of a plant's second shaft, and what its coupling's offset and angle truly are; levers of its own."""

from dataclasses import dataclass, replace

import numpy as np

from tests.film_plant.arrays import Floats
from tests.film_plant.motor_compressor import CouplingKind
from tests.film_plant.plant import Plant
from tests.film_plant.plants import Alteration, Priors
from tests.film_plant.train import Train

SETTLED = Priors(elevation=10e-6, rigid_elevation=5e-6)
"""Error of each bearing by itself in plants whose second shaft is misaligned."""
ONE_SUPPLY = replace(SETTLED, common_oil=True, viscosity_difference=0.03)
"""The same where one supply oils all bearings, whose viscosities differ by 3 % beside what they have in common."""


@dataclass(frozen=True)
class Misalignment:
    """Standard deviations of a second shaft's misalignment in each plane: offset at the coupling [m], angle [rad]."""

    offset: float
    angle: float


LEFT: dict[CouplingKind, Misalignment] = {"flexible": Misalignment(100e-6, 100e-6), "rigid": Misalignment(40e-6, 50e-6)}
"""Alignment errors that couplings of a kind are left with, and distances by which they move later."""


def moved(train: Train, *, offset: Floats, angle: Floats) -> Train:
    """The train with its second shaft's bearings moved along x and y: by offsets (2,) [m] and angles (2,) [rad]."""
    bearings = tuple(
        replace(one, elevation=(one.elevation[0] + float(way[0]), one.elevation[1] + float(way[1]))) if one.shaft == 1 else one
        for one, way in ((one, offset + angle * one.station) for one in train.bearings)
    )
    return replace(train, bearings=bearings)


def drawn(train: Train, size: Misalignment, rng: np.random.Generator) -> Train:
    """The train with its second shaft moved by what is drawn."""
    return moved(train, offset=size.offset * rng.standard_normal(2), angle=size.angle * rng.standard_normal(2))


def left_off(kind: CouplingKind) -> Alteration:
    """The alteration of a plant whose coupling is left off by what is drawn."""

    def alter(train: Train, rng: np.random.Generator, _: float) -> Train:
        return drawn(train, LEFT[kind], rng)

    return alter


def true_alignment(plant: Plant) -> dict[str, complex]:
    """Offset [m] and angle [rad] of the coupling in each plane by name: of lines through each shaft's two bearings."""
    off = plant.train.elevations - plant.believed.elevations
    found: dict[str, complex] = {}
    for plane, axis in (("vertical", 1), ("horizontal", 0)):
        offset, angle = _alignment_of(plant, off[:, axis])
        found[f"coupling.C1.offset_{plane}"], found[f"coupling.C1.angle_{plane}"] = complex(offset), complex(angle)
    return found


def spread_of_elevations(plant: Plant, kind: CouplingKind) -> float:
    """Least spread of single elevations [m] by which offset and angle of the coupling vary as much as they are left off."""
    each = [_alignment_of(plant, raised) for raised in np.eye(len(plant.train.bearings))]
    offset, angle = np.linalg.norm(each, axis=0)
    return float(max(LEFT[kind].offset / offset, LEFT[kind].angle / angle))


def _alignment_of(plant: Plant, elevation: Floats) -> tuple[float, float]:
    """Offset [m] and angle [rad] of the coupling for the elevations (n,) of the bearings in one plane [m]."""
    stations = np.array([one.station for one in plant.train.bearings])
    lines = {}
    for shaft, end in {0: plant.train.shafts[0].length, 1: 0.0}.items():
        own = [k for k, one in enumerate(plant.train.bearings) if one.shaft == shaft]
        slope, height = np.polyfit(stations[own], elevation[own], 1)
        lines[shaft] = height + slope * end, slope
    return float(lines[1][0] - lines[0][0]), float(lines[1][1] - lines[0][1])
