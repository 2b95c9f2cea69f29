"""A rotor train as the film plant describes it. SI; stations are distances from a shaft's driver-side end [m].

x is horizontal, y up, and the train turns from +x to +y.
"""

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from tests.film_plant.arrays import Floats
from tests.film_plant.supports import OwnCoefficients


@dataclass(frozen=True)
class Material:
    """Young's modulus [N/m²], density [kg/m³] and Poisson's ratio [-] of all shafts."""

    young: float = 2.06e11
    density: float = 7850.0
    poisson: float = 0.3


@dataclass(frozen=True)
class Shaft:
    """Pieces (length, diameter) of a solid shaft [m] from the driver's side."""

    pieces: tuple[tuple[float, float], ...]

    @property
    def length(self) -> float:
        """Length of the shaft [m]."""
        return sum(length for length, _ in self.pieces)


@dataclass(frozen=True)
class Disc:
    """A rigid disc: shaft's number, station [m], mass [kg], inertias [kg m²], unbalance from the mark [kg m], force on it [N].

    The force is steady, along x and y.
    """

    shaft: int
    station: float
    mass: float
    diametral_inertia: float
    polar_inertia: float
    unbalance: complex = 0j
    force: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Pedestal:
    """Mass [kg], stiffness [N/m] and damping [N s/m] that carry a bearing, along x and along y."""

    mass: tuple[float, float]
    stiffness: tuple[float, float]
    damping: tuple[float, float]


class Oil(Protocol):
    """Viscosity of the oil in a bearing."""

    def viscosity(self, bearing: "Bearing", *, speed: float, eccentricity: float) -> float:
        """Effective viscosity at a speed [rad/s] and an eccentricity [-] in units of Pa s."""
        ...


@dataclass(frozen=True)
class ConstantOil:
    """Oil of one viscosity [Pa s]."""

    value: float

    def viscosity(self, bearing: "Bearing", *, speed: float, eccentricity: float) -> float:  # noqa: ARG002
        """The viscosity [Pa s]."""
        return self.value


@dataclass(frozen=True)
class Bearing:
    """A journal bearing.

    Attributes:
        shaft: Number of the shaft.
        station: Station [m].
        diameter: Journal's diameter [m].
        length: [m].
        clearance: Radius with which the bore is machined less the journal's [m].
        oil: The oil.
        profile: Name of the bore, see `profile.PROFILES`.
        elevation: Place of the bearing's centre, x and y [m].
        pedestal: What carries it; None for rigid ground.
        own: Its coefficients where it is no film; None of one that is.
    """

    shaft: int
    station: float
    diameter: float
    length: float
    clearance: float
    oil: Oil
    profile: str = "plain"
    elevation: tuple[float, float] = (0.0, 0.0)
    pedestal: Pedestal | None = None
    own: OwnCoefficients | None = None

    @property
    def slenderness(self) -> float:
        """Length over diameter [-]."""
        return self.length / self.diameter

    def force_unit(self, *, viscosity: float, speed: float) -> float:
        """Unit of the film's force at a viscosity [Pa s] and a speed [rad/s], μωRL(R/c)² [N]."""
        radius = self.diameter / 2
        return float(viscosity * speed * radius * self.length * (radius / self.clearance) ** 2)


@dataclass(frozen=True)
class Coupling:
    """A coupling between the end of one shaft and the start of the next.

    Attributes:
        stiffness: kxx, kxy, kyx, kyy (2, 2) [N/m].
        damping: cxx, cxy, cyx, cyy (2, 2) [N s/m].
        k_phix: Moment about x per relative slope about x [N m/rad]: bending in the y-z plane.
        k_phiy: Moment about y per relative slope about y [N m/rad].
        half: Mass [kg] and inertias (diametral, polar) [kg m²] of each half.
        run_out: Offset [m] and slope [rad] of the driven shaft's end over the driver's at which it is free of load; both turn
            with the shafts.
    """

    stiffness: Floats
    damping: Floats
    k_phix: float
    k_phiy: float
    half: tuple[float, float, float]
    run_out: tuple[complex, complex] = (0j, 0j)


@dataclass(frozen=True)
class Train:
    """A train: coupling k joins shafts k and k + 1. Pieces of shafts are divided into `refinement` elements."""

    shafts: tuple[Shaft, ...]
    discs: tuple[Disc, ...]
    bearings: tuple[Bearing, ...]
    couplings: tuple[Coupling, ...]
    material: Material = field(default=Material())
    gravity: float = 9.81
    refinement: int = 1

    @property
    def clearances(self) -> Floats:
        """Clearances of the bearings (n,) [m]."""
        return np.array([one.clearance for one in self.bearings])

    @property
    def elevations(self) -> Floats:
        """Places of the bearings' centres (n, 2) [m]."""
        return np.array([one.elevation for one in self.bearings])

    @property
    def on_films(self) -> list[int]:
        """Numbers of the bearings that are films."""
        return [number for number, one in enumerate(self.bearings) if one.own is None]
