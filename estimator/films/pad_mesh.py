"""Mesh around one pad, and Reynolds' equation on it in the sense of rotation.

Angles run from the middle of the pad. Lengths across the film are in clearances c, pressures in μ ω (R/c)². The film between
the journal at eccentricity ε in direction φ and the pad is h = 1 - ε cos(θ - φ) thick. The flow per unit of length is 6 h less
h³ ∂p/∂θ (A. Z. Szeri, Fluid Film Lubrication, 2nd ed. 2011, chapter 2).
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats

_GAUSS_PLACES = np.array([-np.sqrt(0.6), 0.0, np.sqrt(0.6)]) / 2.0 + 0.5
_GAUSS_WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18.0
_FINER = 4


@dataclass(frozen=True)
class PadMesh:
    """Three points of Gauss's rule in each of n cells around a pad, finer where the film is thin.

    Attributes:
        angle: Angles (n, 3) from the direction of the journal [rad].
        weight: Weights (n, 3) of the points in integrals over the angle [rad].
        share: Values (n, 3) of the linear function that is 0 at the leading and 1 at the trailing node of the cell [-].
        thickness: Thickness (n, 3) of the film [c].
    """

    angle: Floats
    weight: Floats
    share: Floats
    thickness: Floats


@dataclass(frozen=True)
class CircumferentialTerms:
    """Terms of Reynolds' equation between n + 1 nodes, the outer two at ambient pressure.

    Flow through a cell is its conductance times the difference of pressure, plus the mean of the source's potential over the
    cell, weighted by h⁻³. Both are exact where the pressure does not change along the axis.

    Attributes:
        conductance: 1/∫ h⁻³ dθ over each cell (n,) [-].
        breadth: ∫ h³ dθ of each inner node (n - 1,), weighted by the node's linear function [-].
        cosine: Net outflow (n - 1,) from each inner node of a flow of cos of the angle from the journal's direction [-].
        sine: Net outflow (n - 1,) of a flow of its sine [-].
    """

    conductance: Floats
    breadth: Floats
    cosine: Floats
    sine: Floats


@dataclass(frozen=True)
class TermChanges:
    """First-order changes of the terms of Reynolds' equation with the film's thickness.

    Attributes:
        conductance: Of the conductances (n,) [-].
        breadth: Of the breadths (n - 1,) [-].
        outflow: Of the net outflow of the journal's drag, 6 h, from each inner node (n - 1,) [-].
    """

    conductance: Floats
    breadth: Floats
    outflow: Floats


def pad_mesh(*, arc: float, cells: int, eccentricity: float, direction: float) -> PadMesh:
    """Lay the mesh for one position of the journal.

    Half of the cells are spread evenly, half in proportion to 1/h, so that the thinnest place is resolved and the mesh changes
    smoothly with the position.

    Args:
        arc: Arc of the pad [rad].
        cells: Number of cells n.
        eccentricity: Eccentricity from the centre of curvature [c].
        direction: Direction of the journal from there [rad].

    Returns:
        The mesh.
    """
    even = np.linspace(-arc / 2.0, arc / 2.0, _FINER * cells + 1)
    density = 1.0 / (1.0 - eccentricity * np.cos(even - direction))
    density = density + density.mean()
    count = np.concatenate([[0.0], np.cumsum(density[1:] + density[:-1])])
    node = np.interp(np.linspace(0.0, count[-1], cells + 1), count, even)
    width = np.diff(node)[:, None]
    angle = node[:-1, None] + width * _GAUSS_PLACES - direction
    return PadMesh(
        angle, width * _GAUSS_WEIGHTS, np.broadcast_to(_GAUSS_PLACES, angle.shape), 1.0 - eccentricity * np.cos(angle)
    )


def circumferential_terms(mesh: PadMesh) -> CircumferentialTerms:
    """Integrate the terms of Reynolds' equation over the cells.

    Args:
        mesh: The mesh.

    Returns:
        The terms.
    """
    resistance = mesh.weight / mesh.thickness**3
    total = resistance.sum(axis=1)
    cosine, sine = ((resistance * one(mesh.angle)).sum(axis=1) / total for one in (np.cos, np.sin))
    return CircumferentialTerms(1.0 / total, _breadth(mesh, mesh.thickness**3), np.diff(cosine), np.diff(sine))


def term_changes(mesh: PadMesh, change: Floats) -> TermChanges:
    """Compute the changes of the terms of Reynolds' equation with the thickness of the film.

    Args:
        mesh: The mesh.
        change: Change (n, 3) of the thickness [c].

    Returns:
        The changes.
    """
    cubed = (mesh.weight / mesh.thickness**3).sum(axis=1)
    squared = (mesh.weight / mesh.thickness**2).sum(axis=1)
    cubed_change = -3.0 * (mesh.weight * change / mesh.thickness**4).sum(axis=1)
    squared_change = -2.0 * (mesh.weight * change / mesh.thickness**3).sum(axis=1)
    drag = 6.0 * (squared_change - squared * cubed_change / cubed) / cubed
    return TermChanges(-cubed_change / cubed**2, _breadth(mesh, 3.0 * mesh.thickness**2 * change), np.diff(drag))


def _breadth(mesh: PadMesh, integrand: Floats) -> Floats:
    weighted = mesh.weight * integrand
    trailing, leading = (weighted * mesh.share).sum(axis=1), (weighted * (1.0 - mesh.share)).sum(axis=1)
    return np.asarray(trailing[:-1] + leading[1:])
