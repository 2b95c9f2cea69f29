"""Reduction of a long train's mesh to the shapes that its slow motions need: eigenvalue problems of a fraction of the size.

Component mode synthesis with free interfaces (MacNeal, Comput. Struct. 1 (1971) 581, doi:10.1016/0045-7949(71)90031-9;
Rubin, AIAA J. 13 (1975) 995, doi:10.2514/3.60497). The shapes are the plane modes of the shafts and discs without bearings and
couplings, up to several times the highest frequency of interest, and the deflection under a load at each degree of freedom
that a coefficient acts at, so that a bearing may have any stiffness. Further shapes are the deflections under the gyroscopic
moments and the internal damping of the modes, and under those of these deflections: a heavy overhung wheel needs both. Both
bending planes have the same shapes, so that the reduced matrices look like those of a shorter train.
"""

from collections.abc import Iterator
from typing import TypeVar

import numpy as np
import scipy
from msgspec import Struct
from msgspec.structs import replace

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.rotor.assembly import PlaneMatrices, Rotor, assemble_rotor
from estimator.rotor.identity_cache import cached_by_identity
from estimator.rotor.parameters import dense, unknowns
from estimator.rotor.shaft_element import NODE_DOFS, PLANE_DOFS

Entries = TypeVar("Entries", Floats, Complexes)

SMALL = 200
"""Degrees of freedom up to which a mesh is left as it is."""
HIGHEST_MODE = 6.0
"""Highest free mode that is kept, as a multiple of the highest frequency of interest [-]."""
HIGHEST_TURNED = 1.5
"""Highest free mode whose gyroscopic moments and internal damping are kept, as a multiple of the highest frequency of interest
[-].
"""
MAXIMUM_MODES = 160
"""Most free modes that are kept; a document that needs more is refused where it enters."""
SMALLEST_PART = 1e-6
"""Singular value, over the largest, up to which a shape is left out as a combination of the others [-]."""


class Basis(Struct, frozen=True, eq=False):
    """Shapes of one bending plane that span the motions of a train.

    A motion is written over 2k coordinates, in the order of a train with k/2 nodes: (x, y, θx, θy) of each.

    Attributes:
        plane: Shapes (N/2, k), k even, of any scale [m, rad per unit of a coordinate]; None: every degree of freedom is a
            coordinate.
    """

    plane: Floats | None

    @property
    def shapes(self) -> Floats:
        """Return the motion (N, 2k) of all degrees of freedom per unit of each coordinate [m, rad].

        Raises:
            ValueError: Every degree of freedom is a coordinate of its own.
        """
        if self.plane is None:
            raise ValueError("every degree of freedom is a coordinate of its own")
        return self.expanded(np.eye(2 * self.plane.shape[1]))

    def project(self, vectors: Entries) -> Entries:
        """Project forces on the coordinates.

        Args:
            vectors: Forces (N, n) on all degrees of freedom [N, N m].

        Returns:
            Generalised forces (2k, n) on the coordinates [N m per unit of a coordinate].
        """
        if self.plane is None:
            return vectors
        return _joined(*(self.plane.T @ part for part in in_planes(vectors)))

    def expanded(self, shapes: Entries) -> Entries:
        """Expand motions of the coordinates to all degrees of freedom.

        Args:
            shapes: Motions (2k, n) of the coordinates [unit of the coordinates].

        Returns:
            Motions (N, n) of all degrees of freedom [m, rad].
        """
        if self.plane is None:
            return shapes
        return _joined(*(self.plane @ part for part in in_planes(shapes)))

    def coordinates(self, shapes: Entries) -> Entries:
        """Compute the coordinates of motions, in the sense of least squares.

        Source: standard result: least squares by the pseudo-inverse.

        Args:
            shapes: Motions (N, n) of all degrees of freedom [m, rad].

        Returns:
            Motions (2k, n) of the coordinates [unit of the coordinates].
        """
        if self.plane is None:
            return shapes
        inverse = np.linalg.pinv(self.plane)
        return _joined(*(inverse @ part for part in in_planes(shapes)))

    def reduced(self, rotor: Rotor) -> Rotor:
        """Project a rotor on the coordinates.

        Args:
            rotor: The rotor over all degrees of freedom.

        Returns:
            The rotor over the coordinates.
        """
        plane = self.plane
        if plane is None:
            return rotor

        def project(part: PlaneMatrices) -> PlaneMatrices:
            return PlaneMatrices(*(plane.T @ matrix @ plane for matrix in (part.mass, part.gyroscopic, part.stiffness)))

        return replace(
            rotor, discs=project(rotor.discs), materials={name: project(one) for name, one in rotor.materials.items()}
        )


EVERYTHING = Basis(None)
"""Basis without reduction: every degree of freedom is a coordinate."""


def modal_basis(machine: Machine, highest: float) -> Basis:
    """Compute shapes in which the modes of a machine up to a frequency are as on its whole mesh.

    As `reduced_basis`, but a mesh that is small anyway is left as it is: results on it are exact.

    Args:
        machine: The machine.
        highest: Highest frequency [rad/s].

    Returns:
        The basis.
    """
    return EVERYTHING if assemble_rotor(machine).size <= SMALL else reduced_basis(machine, highest)


@cached_by_identity
def reduced_basis(machine: Machine, highest: float) -> Basis:
    """Compute shapes in which the modes of a machine up to a frequency are nearly as on its whole mesh.

    This holds whatever the machine's coefficients are, at spin speeds up to that size. Component mode synthesis (MacNeal 1971,
    Rubin 1975; module's docstring).

    Source: free-interface modes of MacNeal, Comput. Struct. 1 (1971) 581, doi:10.1016/0045-7949(71)90031-9, and Rubin, AIAA J.
    13 (1975) 995, doi:10.2514/3.60497.

    Args:
        machine: The machine.
        highest: Highest frequency [rad/s].

    Returns:
        The basis.
    """
    rotor = assemble_rotor(machine)
    shapes = _shapes(machine, rotor, highest)
    return Basis(shapes) if shapes.shape[1] < rotor.plane_size else EVERYTHING


def _shapes(machine: Machine, rotor: Rotor, highest: float) -> Floats:
    """Compute independent shapes (N/2, k), orthogonal with the masses."""
    mass = rotor.discs.mass + sum(part.mass for part in rotor.materials.values())
    for pedestal in machine.pedestals:
        # Nearly all of its mass is a coefficient: shapes scaled by the rest would be too large to be told apart.
        place = PLANE_DOFS * rotor.pedestal_node[pedestal.id]
        mass[place, place] += (pedestal.mxx + pedestal.myy) / 2
    stiffness = rotor.discs.stiffness + sum(part.stiffness for part in rotor.materials.values())
    loads = _unit_loads(machine, rotor)
    squares, free = scipy.linalg.eigh(stiffness, mass, subset_by_value=(-np.inf, (HIGHEST_MODE * highest) ** 2))
    squares, free = squares[:MAXIMUM_MODES], free[:, :MAXIMUM_MODES]
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
    length = np.linalg.norm(weighted, axis=0)
    weighted = weighted[:, length > 0.0] / length[length > 0.0]  # pedestals have no gyroscopic moments
    orthogonal, size, _ = np.linalg.svd(weighted, full_matrices=True)
    kept = int(np.count_nonzero(size > SMALLEST_PART * size[0]))
    kept += kept % 2  # any one more: their number is even
    return np.asarray(scipy.linalg.solve_triangular(root, orthogonal[:, :kept], trans="T", lower=True))


def _uneven_damping(rotor: Rotor) -> Iterator[Floats]:
    """Yield the stiffness (N/2, N/2) of each material with internal damping, where that is not the same everywhere."""
    if len(set(rotor.internal.values())) > 1:
        yield from (part.stiffness for name, part in rotor.materials.items() if rotor.internal[name] > 0.0)


def _unit_loads(machine: Machine, rotor: Rotor) -> Floats:
    """Build a unit load (N/2, n) at each plane degree of freedom that a coefficient acts at."""
    pairs = [pair for one in unknowns(machine, rotor).coefficients for pair in one.pairs]
    acting = dense([vector for pair in pairs for vector in pair], rotor.size)
    touched = np.flatnonzero(np.any(np.concatenate(in_planes(acting), axis=1), axis=1))
    return np.asarray(np.eye(rotor.plane_size)[:, touched])


def in_planes(vectors: Entries) -> tuple[Entries, Entries]:
    """Divide vectors over (x, y, θx, θy) per node into the two bending planes.

    Args:
        vectors: Vectors (N, n) [any unit].

    Returns:
        Vectors (N/2, n) over (displacement, slope) per node of the x-z plane and of the y-z plane [unit of the argument].
    """
    x, y, about_x, about_y = (vectors[dof::NODE_DOFS] for dof in range(NODE_DOFS))
    return _alternating(x, about_y), _alternating(y, -about_x)


def _joined(x_plane: Entries, y_plane: Entries) -> Entries:
    """Join vectors of the two planes to vectors over (x, y, θx, θy) per node: the opposite of `in_planes`."""
    whole = np.empty((2 * len(x_plane), x_plane.shape[1]), dtype=x_plane.dtype)
    whole[0::NODE_DOFS], whole[3::NODE_DOFS] = x_plane[0::PLANE_DOFS], x_plane[1::PLANE_DOFS]
    whole[1::NODE_DOFS], whole[2::NODE_DOFS] = y_plane[0::PLANE_DOFS], -y_plane[1::PLANE_DOFS]
    return whole


def _alternating(displacement: Entries, slope: Entries) -> Entries:
    return np.stack([displacement, slope], axis=1).reshape(2 * len(displacement), displacement.shape[1])
