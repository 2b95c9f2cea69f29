"""A turbine and its generator, designed here: 3600 r/min, some 1.5 MW, on four plain bearings, either kind of coupling.

Rotors of 0.6 and 1.5 t, at 0.6 and 0.7 MPa in their bearings; both pass their first bending critical speed.
"""

import numpy as np

from tests.film_plant.motor_compressor import CouplingKind
from tests.film_plant.train import Bearing, ConstantOil, Coupling, Disc, Shaft, Train

OIL = ConstantOil(0.010)
TURBINE = Shaft(((0.15, 0.09), (0.15, 0.09), (0.15, 0.14), *(4 * ((0.25, 0.14),)), (0.15, 0.14), (0.15, 0.09), (0.2, 0.09)))
GENERATOR = Shaft(((0.25, 0.12), (0.2, 0.12), (0.2, 0.19), *(4 * ((0.3, 0.19),)), (0.2, 0.19), (0.2, 0.12), (0.2, 0.12)))
WHEEL, POLE = (145.0, 2.4, 4.5), (380.0, 9.7, 9.2)
"""Mass [kg], diametral and polar inertia [kg m²] of a wheel, and of a third of the generator's core."""
HALF = (12.0, 0.05, 0.09)
"""The same of half a coupling."""
COUPLINGS: dict[CouplingKind, tuple[float, float, float]] = {"flexible": (3e6, 600.0, 6e4), "rigid": (5e9, 2e4, 6e7)}
"""Lateral stiffness [N/m] and damping [N s/m], and angular stiffness [N m/rad], of each kind of coupling."""


def turbine_generator(kind: CouplingKind) -> Train:
    """The train with a coupling of a kind, its bearings on one line."""
    discs = [Disc(0, station, *WHEEL, 0.003) for station in (0.7, 0.95, 1.2)]
    discs += [Disc(1, station, *POLE, 0.006) for station in (0.95, 1.25, 1.55)]
    bearings = [Bearing(0, station, 0.09, 0.054, 90e-6, OIL) for station in (0.15, 1.75)]
    bearings += [Bearing(1, station, 0.12, 0.084, 120e-6, OIL) for station in (0.25, 2.25)]
    lateral, slowed, angular = COUPLINGS[kind]
    coupling = Coupling(lateral * np.eye(2), slowed * np.eye(2), angular, angular, HALF)
    return Train((TURBINE, GENERATOR), tuple(discs), tuple(bearings), (coupling,))
