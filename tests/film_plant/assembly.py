"""Matrices of a train without its films: shafts, discs, coupling halves, couplings, pedestals.

Each node has (x, βx, y, βy): a displacement and the section's slope in either plane; pedestals follow, (x, y) each. With the
slopes as rotations about the axes, θy = βx and θx = -βy.
"""

from dataclasses import dataclass

import numpy as np

from tests.film_plant.arrays import Complexes, Floats, Indices
from tests.film_plant.beam import element
from tests.film_plant.train import Coupling, Train

DOFS = 4
"""Degrees of freedom of a node."""
SAME_PLACE = 1e-9
"""Largest distance of two stations that are one [m]."""


@dataclass(frozen=True)
class Matrices:
    """M q̈ + (C + ω G) q̇ + K q = f, without films.

    Attributes:
        mass: (N, N).
        damping: (N, N).
        gyroscopic: (N, N) per unit of speed.
        stiffness: (N, N).
        journals: Degrees of freedom x and y of each journal (n, 2).
        pedestals: Those of each pedestal (n, 2); -1 where there is none.
        weight: Force of gravity on the shafts, and steady forces on discs (N,) [N, N m]; pedestals stand where gravity has put
            them.
        unbalance: Complex sums (N,) of unbalance [kg m]: the force is ω² times it, x(t) = Re(X e^{jωt}).
        turning: Forces and moments (N,) that turn with the shafts at any speed [N, N m].
    """

    mass: Floats
    damping: Floats
    gyroscopic: Floats
    stiffness: Floats
    journals: Indices
    pedestals: Indices
    weight: Floats
    unbalance: Complexes
    turning: Complexes


def node_stations(train: Train) -> list[Floats]:
    """Stations of the nodes of each shaft [m]: ends of pieces and of their parts, and all stations that carry something."""
    found = []
    for number, shaft in enumerate(train.shafts):
        ends = np.cumsum([0.0, *(length for length, _ in shaft.pieces)])
        parts = [a + (b - a) * np.arange(train.refinement) / train.refinement for a, b in zip(ends, ends[1:], strict=False)]
        used = [one.station for one in train.discs if one.shaft == number]
        used += [one.station for one in train.bearings if one.shaft == number]
        places = np.sort(np.concatenate([*parts, ends[-1:], used]))
        found.append(places[np.concatenate([[True], np.diff(places) > SAME_PLACE])])
    return found


class _Assembler:
    """Matrices that are being added up."""

    def __init__(self, train: Train) -> None:
        self.stations = node_stations(train)
        self.first = np.cumsum([0, *(len(one) for one in self.stations)])
        size = DOFS * int(self.first[-1]) + 2 * sum(one.pedestal is not None for one in train.bearings)
        self.mass, self.damping, self.gyroscopic, self.stiffness = np.zeros((4, size, size))
        self.shaft_dofs = DOFS * int(self.first[-1])

    def dof(self, shaft: int, station: float) -> int:
        """First degree of freedom of the node at a station."""
        places = self.stations[shaft]
        nearest = int(np.argmin(np.abs(places - station)))
        if abs(places[nearest] - station) > 2 * SAME_PLACE:
            raise ValueError(f"no node at station {station} m of shaft {shaft}")
        return DOFS * int(self.first[shaft] + nearest)

    def ends(self, number: int) -> tuple[int, int]:
        """First degrees of freedom of the two nodes that coupling `number` joins."""
        return DOFS * int(self.first[number + 1] - 1), DOFS * int(self.first[number + 1])

    def add_shafts(self, train: Train) -> None:
        """Add the shafts' elements."""
        for number, (shaft, places) in enumerate(zip(train.shafts, self.stations, strict=True)):
            ends = np.cumsum([length for length, _ in shaft.pieces])
            for k, (a, b) in enumerate(zip(places, places[1:], strict=False)):
                piece = shaft.pieces[int(np.searchsorted(ends, (a + b) / 2))]
                one = element(b - a, piece[1], train.material)
                x = DOFS * int(self.first[number] + k) + np.array([0, 1, 4, 5])
                for plane in (x, x + 2):
                    self.mass[np.ix_(plane, plane)] += one.translation + one.rotation
                    self.stiffness[np.ix_(plane, plane)] += one.stiffness
                # A thin slice's polar inertia is twice that about a diameter.
                self.gyroscopic[np.ix_(x, x + 2)] += 2 * one.rotation
                self.gyroscopic[np.ix_(x + 2, x)] -= 2 * one.rotation

    def add_rigid(self, dof: int, mass: float, diametral: float, polar: float) -> None:
        """Add a rigid body to a node."""
        here = dof + np.arange(DOFS)
        self.mass[here, here] += [mass, diametral, mass, diametral]
        self.gyroscopic[dof + 1, dof + 3] += polar
        self.gyroscopic[dof + 3, dof + 1] -= polar

    def add_coupling(self, number: int, coupling: Coupling) -> None:
        """Add a coupling with its halves."""
        driver, driven = self.ends(number)
        both = (driver, driven)
        for dof in both:
            self.add_rigid(dof, *coupling.half)
        for i, row in enumerate(both):
            for j, column in enumerate(both):
                sign = 1.0 if i == j else -1.0
                block = np.ix_((row, row + 2), (column, column + 2))
                self.stiffness[block] += sign * coupling.stiffness
                self.damping[block] += sign * coupling.damping
                self.stiffness[row + 1, column + 1] += sign * coupling.k_phiy
                self.stiffness[row + 3, column + 3] += sign * coupling.k_phix


def assemble(train: Train) -> Matrices:
    """Assemble the matrices of a train."""
    parts = _Assembler(train)
    parts.add_shafts(train)
    size = len(parts.mass)
    unbalance = np.zeros(size, dtype=complex)
    for disc in train.discs:
        dof = parts.dof(disc.shaft, disc.station)
        parts.add_rigid(dof, disc.mass, disc.diametral_inertia, disc.polar_inertia)
        # u cos(ωt + δ) along x, u sin(ωt + δ) along y.
        unbalance[[dof, dof + 2]] += np.array([1.0, -1j]) * disc.unbalance
    turning = np.zeros(size, dtype=complex)
    for number, coupling in enumerate(train.couplings):
        parts.add_coupling(number, coupling)
        turning += _pull_of_run_out(size, *parts.ends(number), coupling)
    weight = -train.gravity * parts.mass @ _up(size, parts.shaft_dofs)
    for disc in train.discs:
        dof = parts.dof(disc.shaft, disc.station)
        weight[[dof, dof + 2]] += disc.force
    journals = np.array([[0, 2]]) + np.array([[parts.dof(one.shaft, one.station)] for one in train.bearings])
    pedestals = np.full(journals.shape, -1)
    last = parts.shaft_dofs
    for number, bearing in enumerate(train.bearings):
        if bearing.pedestal is not None:
            here = np.array([last, last + 1])
            pedestals[number] = here
            last += 2
            parts.mass[here, here] = bearing.pedestal.mass
            parts.stiffness[here, here] = bearing.pedestal.stiffness
            parts.damping[here, here] = bearing.pedestal.damping
    return Matrices(
        parts.mass, parts.damping, parts.gyroscopic, parts.stiffness, journals, pedestals, weight, unbalance, turning
    )


def _pull_of_run_out(size: int, driver: int, driven: int, coupling: Coupling) -> Complexes:
    """Forces and moments (N,) with which a coupling pulls the ends of its shafts to where it is free of load."""
    offset, slope = coupling.run_out
    pull = np.zeros(DOFS, dtype=complex)
    pull[[0, 2]] = coupling.stiffness @ np.array([1.0, -1j]) * offset
    pull[[1, 3]] = np.array([coupling.k_phiy, coupling.k_phix]) * np.array([1.0, -1j]) * slope
    found = np.zeros(size, dtype=complex)
    found[driven : driven + DOFS], found[driver : driver + DOFS] = pull, -pull
    return found


def _up(size: int, shaft_dofs: int) -> Floats:
    """A rise (N,) of all shafts by one unit."""
    found = np.zeros(size)
    found[2:shaft_dofs:DOFS] = 1.0
    return found
