"""Reduction of a long train's mesh to the shapes that its slow motions need: eigenvalue problems of a fraction of the size.

Component mode synthesis with free interfaces (MacNeal, Comput. Struct. 1 (1971) 581, doi:10.1016/0045-7949(71)90031-9;
Rubin, AIAA J. 13 (1975) 995, doi:10.2514/3.60497): the plane modes of the shafts and discs without bearings and couplings
up to several times the highest frequency of interest, and the deflection under a load at each degree of freedom that a
coefficient acts at, so that a bearing may have any stiffness. Beside them the deflections under the gyroscopic moments and
the internal damping that come with the modes, and under those that these deflections bring with them: a heavy wheel that
overhangs needs both. Both bending planes have the same shapes: the reduced matrices look like
those of a shorter train.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
import scipy.linalg

from estimator.arrays import Complexes, Floats
from estimator.machine import Machine
from estimator.parameters import dense, unknowns
from estimator.remembered import remembered
from estimator.rotor import PlaneMatrices, Rotor, assemble_rotor
from estimator.shaft import NODE_DOFS, PLANE_DOFS

Numbers = TypeVar("Numbers", Floats, Complexes)

SMALL = 200
"""Degrees of freedom up to which a mesh is left as it is."""
HIGHEST_MODE = 6.0
"""Free modes up to this multiple of the highest frequency of interest are taken."""
HIGHEST_TURNED = 1.5
"""What gyroscopic moments and internal damping do in free modes up to this multiple of it is taken."""
MOST_MODES = 160
"""Free modes that are taken at most; a document that needs more is refused where it enters."""
SMALLEST_PART = 1e-6
"""A shape that is so nearly made of the others is left out."""


@dataclass(frozen=True)
class Basis:
    """Shapes (N/2, k) of one bending plane, k even; None: every degree of freedom is one.

    A motion is written over 2k coordinates, in the order of a train with k/2 nodes: (x, y, θx, θy) of each.
    """

    plane: Floats | None

    @property
    def shapes(self) -> Floats:
        """The motion (N, 2k) of all degrees of freedom that each coordinate is. Raises ValueError where each is its own."""
        if self.plane is None:
            raise ValueError("every degree of freedom is a coordinate of its own")
        return self.expanded(np.eye(2 * self.plane.shape[1]))

    def onto(self, vectors: Numbers) -> Numbers:
        """What vectors (N, n) of forces do to the coordinates, (2k, n)."""
        if self.plane is None:
            return vectors
        return _joined(*(self.plane.T @ part for part in in_planes(vectors)))

    def expanded(self, shapes: Numbers) -> Numbers:
        """The motion (N, n) of all degrees of freedom from that of the coordinates (2k, n)."""
        if self.plane is None:
            return shapes
        return _joined(*(self.plane @ part for part in in_planes(shapes)))

    def coordinates(self, shapes: Numbers) -> Numbers:
        """The coordinates (2k, n) of motions (N, n), as nearly as they have any."""
        if self.plane is None:
            return shapes
        inverse = np.linalg.pinv(self.plane)
        return _joined(*(inverse @ part for part in in_planes(shapes)))

    def reduced(self, rotor: Rotor) -> Rotor:
        """The rotor over the coordinates."""
        plane = self.plane
        if plane is None:
            return rotor

        def onto(part: PlaneMatrices) -> PlaneMatrices:
            return PlaneMatrices(*(plane.T @ matrix @ plane for matrix in (part.mass, part.gyroscopic, part.stiffness)))

        return replace(rotor, discs=onto(rotor.discs), materials={name: onto(one) for name, one in rotor.materials.items()})


EVERYTHING = Basis(None)
"""No reduction."""


@remembered
def modal_basis(machine: Machine, highest: float) -> Basis:
    """Shapes in which modes of a machine up to a frequency [rad/s], at spin speeds of that size, are as on its whole mesh.

    Whatever its coefficients are. A mesh that is small anyway is left as it is.
    """
    rotor = assemble_rotor(machine)
    if rotor.size <= SMALL:
        return EVERYTHING
    shapes = _shapes(machine, rotor, highest)
    return Basis(shapes) if shapes.shape[1] < rotor.plane_size else EVERYTHING


def _shapes(machine: Machine, rotor: Rotor, highest: float) -> Floats:
    """Independent shapes (N/2, k), orthogonal with the masses."""
    mass = rotor.discs.mass + sum(part.mass for part in rotor.materials.values())
    stiffness = rotor.discs.stiffness + sum(part.stiffness for part in rotor.materials.values())
    loads = _unit_loads(machine, rotor)
    squares, free = scipy.linalg.eigh(stiffness, mass, subset_by_value=(-np.inf, (HIGHEST_MODE * highest) ** 2))
    squares, free = squares[:MOST_MODES], free[:, :MOST_MODES]
    slow = free[:, squares < (HIGHEST_TURNED * highest) ** 2]
    # Free shafts have no flexibility of their own: they rest on springs as soft as their masses at that frequency.
    held = scipy.linalg.cho_factor(stiffness + highest**2 * mass)
    deflected = scipy.linalg.cho_solve(held, loads)
    gyroscopic = rotor.discs.gyroscopic + sum(part.gyroscopic for part in rotor.materials.values())
    turned = scipy.linalg.cho_solve(held, gyroscopic @ slow)
    along = [gyroscopic @ turned, *(part @ np.concatenate([slow, deflected], axis=1) for part in _uneven_damping(rotor))]
    together = np.concatenate([free, deflected, turned, scipy.linalg.cho_solve(held, np.concatenate(along, axis=1))], axis=1)
    root = np.linalg.cholesky(mass)
    weighted = root.T @ together
    weighted = weighted / np.linalg.norm(weighted, axis=0)
    orthogonal, size, _ = np.linalg.svd(weighted, full_matrices=True)
    kept = int(np.count_nonzero(size > SMALLEST_PART * size[0]))
    kept += kept % 2  # any one more: their number is even
    return np.asarray(scipy.linalg.solve_triangular(root, orthogonal[:, :kept], trans="T", lower=True))


def _uneven_damping(rotor: Rotor) -> Iterator[Floats]:
    """Stiffness (N/2, N/2) of each material with internal damping, where that is not the same everywhere."""
    if len(set(rotor.internal.values())) > 1:
        yield from (part.stiffness for name, part in rotor.materials.items() if rotor.internal[name] > 0.0)


def _unit_loads(machine: Machine, rotor: Rotor) -> Floats:
    """A unit load (N/2, n) at each plane degree of freedom that a coefficient acts at."""
    pairs = [pair for one in unknowns(machine, rotor).coefficients for pair in one.pairs]
    acting = dense([vector for pair in pairs for vector in pair], rotor.size)
    touched = np.flatnonzero(np.any(np.concatenate(in_planes(acting), axis=1), axis=1))
    return np.asarray(np.eye(rotor.plane_size)[:, touched])


def in_planes(vectors: Numbers) -> tuple[Numbers, Numbers]:
    """Vectors over (x, y, θx, θy) per node as such over (displacement, slope) per node of the x-z and of the y-z plane."""
    x, y, about_x, about_y = (vectors[dof::NODE_DOFS] for dof in range(NODE_DOFS))
    return _alternating(x, about_y), _alternating(y, -about_x)


def _joined(x_plane: Numbers, y_plane: Numbers) -> Numbers:
    """The opposite of `_planes`."""
    whole = np.empty((2 * len(x_plane), x_plane.shape[1]), dtype=x_plane.dtype)
    whole[0::NODE_DOFS], whole[3::NODE_DOFS] = x_plane[0::PLANE_DOFS], x_plane[1::PLANE_DOFS]
    whole[1::NODE_DOFS], whole[2::NODE_DOFS] = y_plane[0::PLANE_DOFS], -y_plane[1::PLANE_DOFS]
    return whole


def _alternating(displacement: Numbers, slope: Numbers) -> Numbers:
    return np.stack([displacement, slope], axis=1).reshape(-1, displacement.shape[1])
