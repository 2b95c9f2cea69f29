"""The train at rest, condensed to its journals: what their films have to carry.

Loads are derived, never free. The film forces f on the journals at u obey S u = w + f: S is the stiffness of shafts and
couplings at the journals, which a rigid motion of the whole train does not strain; w is the weight carried there.
Pedestals with compliances D give way: u = p - D (f - f₀) for bearings at p, with f₀ the forces at rest, when the train was
aligned. So S becomes (1 + S D)⁻¹ S.
"""

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.errors import Invalid
from estimator.machine.document import Machine
from estimator.machine.parts import STATION_TOLERANCE
from estimator.machine.train_layout import shaft_begins
from estimator.rotor.assembly import Rotor, assemble_rotor, plane_columns
from estimator.rotor.parameters import unknowns
from estimator.rotor.shaft_element import NODE_DOFS, PLANE_DOFS
from estimator.rotor.system_matrices import system_matrices
from estimator.units import GRAVITY


class MissingFilm(Invalid):
    """Raised when the static loads are asked for of a train of which a bearing says nothing of its film."""


class UnsupportedShaft(Invalid):
    """Raised when shafts and couplings would fall although all journals are held."""


@dataclass(frozen=True)
class StaticSlopes:
    """Derivatives of a train at rest by the logarithms of C stiffnesses.

    Attributes:
        stiffness: Of the stiffness S (C, 2n, 2n) [N/m].
        weight: Of the forces w (C, 2n) [N].
        by_load: Of the change of w per unit of each static load (C, 2n, 2m) [-].
    """

    stiffness: Floats
    weight: Floats
    by_load: Floats


@dataclass(frozen=True)
class TrainStatics:
    """A train at rest over the x and y of its n journals, bearing by bearing.

    Attributes:
        bearings: Ids of the bearings (n,).
        stiffness: Stiffness S (2n, 2n) of shafts, couplings and pedestals [N/m].
        weight: Forces w (2n,) that arrive at the bearings when journals are held where all is straight [N].
        aligned: Positions (n, 2) of the bearings' centres at which no coupling carries shear or moment with the journals in
            them [m].
        by_load: Change of w per unit of the m static loads of the document, along x and along y of each (2n, 2m) [-].
        slopes: Derivatives by the logarithms of the stiffnesses of couplings and pedestals that are identified.
    """

    bearings: tuple[str, ...]
    stiffness: Floats
    weight: Floats
    aligned: Floats
    by_load: Floats
    slopes: StaticSlopes

    def film_force(self, position: Floats) -> Floats:
        """Compute the forces that films must exert for the journals to rest somewhere.

        Args:
            position: Positions (n, 2) of the journals, less what the pedestals give way [m].

        Returns:
            Forces (n, 2) [N].
        """
        return np.asarray((self.stiffness @ position.reshape(-1) - self.weight).reshape(-1, 2))


def static_stiffness(machine: Machine, *, couplings: Collection[str]) -> Floats:
    """Assemble the stiffness of shafts and pedestals and of some couplings, without bearings and seals.

    Args:
        machine: The machine.
        couplings: Ids of the couplings that act, with the stiffness that is expected of them.

    Returns:
        Stiffness (N, N) [N/m, N, N m].
    """
    listed = unknowns(machine, assemble_rotor(machine)).coefficients
    acting = {f"coupling.{one}" for one in couplings} | {f"pedestal.{one.id}" for one in machine.pedestals}
    values = [one.expected if one.element in acting else 0.0 for one in listed]
    return system_matrices(machine, coefficients=np.array(values)).stiffness


def train_load(machine: Machine, rotor: Rotor) -> Floats:
    """Assemble weight and static loads of a train, upwards and along +x positive.

    Args:
        machine: The machine.
        rotor: Its shafts and discs.

    Returns:
        Loads (N,) on all degrees of freedom [N, N m].
    """
    _, y_plane = plane_columns(rotor.size)
    upwards = y_plane @ np.tile([1.0, 0.0], rotor.plane_size // PLANE_DOFS)
    load = np.asarray(-GRAVITY * (rotor.mass @ upwards))
    for one in machine.static_loads:
        load[lateral_places(rotor, one.shaft, one.station)] += (one.force_x, one.force_y)
    return load


def lateral_places(rotor: Rotor, shaft: str, station: float) -> NDArray[np.intp]:
    """Return the places of x and y at a station among the degrees of freedom.

    Args:
        rotor: The shafts and discs.
        shaft: Id of the shaft.
        station: Distance from its driver-side end [m].

    Returns:
        The places (2,).
    """
    first = NODE_DOFS * rotor.node(shaft, station)
    return np.array([first, first + 1], dtype=np.intp)


def free_motion(stiffness: Floats, loads: Floats, held: NDArray[np.intp]) -> tuple[Floats, Floats]:
    """Compute the motion of all degrees of freedom while some are held (Guyan, AIAA J. 3 (1965) 380).

    Args:
        stiffness: Stiffness (N, N) [N/m, N, N m].
        loads: Loads (N, l) of l cases [N, N m].
        held: Places (k,) of those that are held.

    Returns:
        Motions (N, l) under the loads [m, rad], which move none that is held, and motions (N, k) per unit of each of these.

    Raises:
        UnsupportedShaft: Something would fall although they are held.
    """
    free = np.setdiff1d(np.arange(len(stiffness)), held)
    block = stiffness[np.ix_(free, free)]
    size = np.sqrt(np.abs(np.diag(block)))
    scaled = block / np.outer(size, size)
    if np.linalg.cond(scaled) > 1e14:
        raise UnsupportedShaft("a shaft is held neither by two bearings nor by a coupling: nothing carries its weight")
    right = np.column_stack([loads[free], -stiffness[np.ix_(free, held)]]) / size[:, None]
    solved = scipy.linalg.solve(scaled, right) / size[:, None]
    deflected, moved = np.zeros(loads.shape), np.zeros((len(stiffness), held.size))
    deflected[free], moved[free] = np.split(solved, [loads.shape[1]], axis=1)
    moved[held] = np.eye(held.size)
    return deflected, moved


def aligned_places(machine: Machine, rotor: Rotor, load: Floats, held: NDArray[np.intp]) -> Floats:
    """Derive where bearings stand when each shaft, sagging in its own bearings, is moved until couplings fit.

    A shaft that does not lie on two bearings of its own is one with its neighbours: couplings at its ends carry what they must
    with all bearings of these shafts in a line. The first shafts of a train stay; the others are moved as rigid bodies.

    Args:
        machine: The machine.
        rotor: Its shafts and discs.
        load: Loads (N,) at rest [N, N m].
        held: Places (2n,) of x and y of its n journals.

    Returns:
        Places (n, 2) of the bearings' centres [m].

    Raises:
        UnsupportedShaft: Something would fall although all journals are held.
    """
    carrying = [one for one in machine.couplings if not {one.driver, one.driven} <= _on_own_bearings(machine)]
    sag = free_motion(static_stiffness(machine, couplings=[one.id for one in carrying]), load[:, None], held)[0][:, 0]
    bodies = {shaft.id: frozenset({shaft.id}) for shaft in machine.shafts}
    for one in carrying:
        whole = bodies[one.driver] | bodies[one.driven]
        bodies |= dict.fromkeys(whole, whole)
    moved, begins = np.zeros(rotor.size), shaft_begins(machine)
    settled = set(bodies[machine.shafts[0].id])
    waiting = list(machine.couplings)
    while waiting:
        coupling = next((one for one in waiting if settled & {one.driver, one.driven}), None)
        if coupling is None:
            break  # another train beside the first: its own first shaft stays
        waiting.remove(coupling)
        if settled >= {coupling.driver, coupling.driven}:
            continue  # within a body, or the second of two couplings between the same
        still, other = (coupling.driver, coupling.driven) if coupling.driver in settled else (coupling.driven, coupling.driver)
        ends = {coupling.driver: rotor.end_node(coupling.driver), coupling.driven: rotor.first_node[coupling.driven]}
        here, there = (slice(NODE_DOFS * ends[one], NODE_DOFS * (ends[one] + 1)) for one in (still, other))
        for shaft in bodies[other]:
            away = begins[shaft] - begins[coupling.driven] + rotor.stations[shaft]
            _move(moved, rotor.first_node[shaft], away, (sag + moved)[here] - sag[there])
        settled |= bodies[other]
    return np.asarray(moved[held].reshape(-1, 2))


def _on_own_bearings(machine: Machine) -> set[str]:
    """Return the shafts that lie on two bearings of their own at least."""
    stations = {shaft.id: [one.station for one in machine.bearings if one.shaft == shaft.id] for shaft in machine.shafts}
    return {shaft for shaft, own in stations.items() if own and max(own) - min(own) > STATION_TOLERANCE}


def _move(moved: Floats, first: int, away: Floats, motion: Floats) -> None:
    """Move a shaft's nodes at some distances from a coupling as a rigid body that moves there by displacement and slopes."""
    x, y, about_x, about_y = motion
    for node, distance in enumerate(away, start=first):
        moved[NODE_DOFS * node : NODE_DOFS * (node + 1)] = (x + about_y * distance, y - about_x * distance, about_x, about_y)
