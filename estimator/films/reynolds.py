"""Reynolds' equation of a finite pad with rupture of the film.

The oil is incompressible and of one viscosity. With the angle θ around the journal, ζ = 2 z / L along it, and pressure in
μ ω (R/c)²,

    ∂/∂θ(h³ ∂p/∂θ) + (D/L)² ∂/∂ζ(h³ ∂p/∂ζ) = 6 ∂h/∂θ + 12 ∂h/∂(ω t),    p ≥ 0,

where p > 0; elsewhere the right side is larger. Pressure and its gradient vanish at the edge of the film (Reynolds', Swift's
and Stieber's condition). Forces are in μ ω R L (R/c)²: a Sommerfeld number S = μ N L D (R/c)²/W (N in
rev/s) is one over π times the force in this unit.

Discretisation: cells around the pad that are exact in the limit of a long one, and even polynomials along it, both in weak
form, so that matrix and damping are symmetric. Which nodes carry pressure is found exactly, by a primal-dual active set
(M. Hintermüller, K. Ito, K. Kunisch, SIAM J. Optim. 13 (2003) 865, doi:10.1137/S1052623401383558) from coarse meshes to finer
ones. The force is then accurate to second order in the width of a cell, and smooth. A perturbation would jump whenever a node
changes sides, since its gradient does not vanish at the edge: the edge is therefore located inside its cell, from pressure
and residual on its two sides (`edge_conductance`).
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg.lapack import dpbsv

from estimator.arrays import Bools, Floats
from estimator.films.axial_nodes import axial_nodes
from estimator.films.pad import FULL_ARC
from estimator.films.pad_mesh import CircumferentialTerms, PadMesh, circumferential_terms, pad_mesh, term_changes

AROUND = 240
"""Cells around a pad: forces are within 0.2 % of those of ten times as many, up to an eccentricity of 0.95."""
COARSEST = 60
"""Cells of a mesh whose film is found without that of a coarser one."""
MOST_CHANGES = 500
"""Most changes of the set of nodes that carry pressure."""


class FilmNotFound(ArithmeticError):
    """Raised when the nodes that carry pressure are not found."""


def axial_count(slenderness: float) -> int:
    """Choose the number of nodes along half of a pad, more where the pressure falls in a thin layer at its ends.

    Args:
        slenderness: Length over diameter [-].

    Returns:
        The number.
    """
    return 6 + max(0, math.ceil(2.2 * math.log2(slenderness)))


@dataclass(frozen=True)
class PadFilm:
    """Film between a pad and the journal at one position, in the frame of the journal's direction (radial, tangential).

    Attributes:
        eccentricity: Eccentricity ε of the journal from the pad's centre of curvature [c].
        direction: Direction of the journal from there, from the middle of the pad [rad].
        pressure: Pressure (n - 1, m) over ε at the inner nodes around and at those along half of the pad [μ ω (R/c)²].
        force_over_eccentricity: Force on the journal over ε (2,) [μ ω R L (R/c)²].
        radial_damping: Radial force against a radial speed [μ R L (R/c)²/c].
    """

    eccentricity: float
    direction: float
    pressure: Floats
    force_over_eccentricity: Floats
    radial_damping: float

    @property
    def force(self) -> Floats:
        """Return the force on the journal (2,); shape (component,) with components (radial, tangential) [μ ω R L (R/c)²]."""
        return self.eccentricity * self.force_over_eccentricity

    @property
    def damping(self) -> Floats:
        """Return the damping (2, 2) [μ R L (R/c)²/c].

        A journal that whirls at half its speed drags no oil in: this gives the tangential column, symmetry the rest.
        """
        radial, tangential = 2.0 * self.force_over_eccentricity
        return np.array([[self.radial_damping, radial], [radial, tangential]])


class PadSolver:
    """Solver of Reynolds' equation on pads of one geometry."""

    def __init__(
        self, *, arc: float, slenderness: float, around: int = AROUND, along: int | None = None, rupture: bool = True
    ) -> None:
        """Prepare the solver.

        Args:
            arc: Arc of the pad; one of 2π turns with the journal, so that its edges stay in one direction from it [rad].
            slenderness: Length over diameter of the journal [-].
            around: Cells around the pad.
            along: Nodes along half of the pad; None for as many as its slenderness asks for.
            rupture: Whether the film ruptures where the pressure would be negative.
        """
        self._arc, self._slenderness, self._around, self._rupture = arc, slenderness, around, rupture
        self._axial = axial_nodes(axial_count(slenderness) if along is None else along)

    def solve(self, eccentricity: float, direction: float = 0.0) -> PadFilm:
        """Solve for the film at one position of the journal.

        Args:
            eccentricity: Eccentricity from the centre of curvature, also 0, where the ratios to it have a limit [c].
            direction: Direction of the journal from there, from the middle of the pad; 0 for a pad of 360° into which oil
                comes where the film is thickest [rad].

        Returns:
            The film.
        """
        system = self._system(eccentricity, direction)
        pressure, active = self._film(system, eccentricity, direction)
        squeezed = system.solution(active, 6.0 * system.terms.sine, self._edge(system, pressure, active))
        damping = -2.0 * system.force(squeezed)[0]
        return PadFilm(eccentricity, direction, pressure, system.force(pressure), float(damping))

    def stiffness(self, film: PadFilm) -> Floats:
        """Compute the stiffness at one position by a perturbation of first order.

        Args:
            film: The film there.

        Returns:
            Stiffness (2, 2), in the frame of the journal's direction [μ ω R L (R/c)²/c].
        """
        system = self._system(film.eccentricity, film.direction)
        active = film.pressure > 0.0 if self._rupture else np.ones(film.pressure.shape, dtype=bool)
        edge = self._edge(system, film.pressure, active)
        columns = [
            -system.force(system.perturbed(film.eccentricity * film.pressure, active, -shape(system.mesh.angle), edge))
            for shape in (np.cos, np.sin)
        ]
        if self._arc == FULL_ARC:  # its edges turn with the journal, and so does the force
            radial, tangential = film.force_over_eccentricity
            columns[1] = np.array([tangential, -radial])
        return np.stack(columns, axis=1)

    def _system(self, eccentricity: float, direction: float) -> "_System":
        mesh = pad_mesh(arc=self._arc, cells=self._around, eccentricity=eccentricity, direction=direction)
        axial = self._axial
        return _System(mesh, circumferential_terms(mesh), axial.weights, axial.stiffness / self._slenderness**2)

    def _film(self, system: "_System", eccentricity: float, direction: float) -> tuple[Floats, Bools]:
        """Return the pressure over ε, and where it is positive."""
        outflow = -6.0 * system.terms.cosine
        active = np.ones(system.shape, dtype=bool)
        if not self._rupture:
            return system.solution(active, -outflow), active
        if self._coarser is not None:
            found = self._coarser._film(self._coarser._system(eccentricity, direction), eccentricity, direction)[1]
            place = np.arange(1, self._around) * self._coarser._around / self._around
            active = found[np.clip(np.rint(place).astype(int) - 1, 0, len(found) - 1)]
        for _ in range(MOST_CHANGES):
            pressure = system.solution(active, -outflow)
            residual = system.residual(pressure, -outflow)
            following = np.where(active, pressure > 0.0, residual < 0.0)
            if np.array_equal(following, active):
                return pressure, active
            active = following
        raise FilmNotFound(
            f"a pad of {math.degrees(self._arc):g}°, L/D {self._slenderness:g}, the journal at {eccentricity:g} clearances, "
            f"{math.degrees(direction):g}°: after {MOST_CHANGES} changes nodes still change sides"
        )

    def _edge(self, system: "_System", pressure: Floats, active: Bools) -> Floats:
        if not self._rupture:
            return np.zeros(system.shape)
        return edge_conductance(
            system.links, pressure=pressure, residual=system.residual(pressure, 6.0 * system.terms.cosine), active=active
        )

    @cached_property
    def _coarser(self) -> "PadSolver | None":
        if self._around <= COARSEST:
            return None
        cells, along = max(self._around // 4, COARSEST // 2), self._axial.weights.size
        return PadSolver(arc=self._arc, slenderness=self._slenderness, around=cells, along=along)


def edge_conductance(links: Floats, *, pressure: Floats, residual: Floats, active: Bools) -> Floats:
    """Compute the conductance that a cell with the film's edge in it has beyond that to its far node.

    Near the edge p = κ d²/2, where d is the distance and κ the source over h³. Equating the discrete equation at the last
    node with pressure to that of this parabola puts the edge at d = (1/2 + τ) Δ behind the node. Δ is the width of the cell,
    and τ = p/(κ Δ²) goes from 0 to 1 while the edge passes the cell. κ Δ² follows from the residual at the first node
    without pressure. Where p = 0 at the distance d instead of Δ, the conductance is Δ/d times as large.

    Args:
        links: Conductances (n, m) of the cells [-].
        pressure: Pressure (n - 1, m) at the inner nodes [any unit].
        residual: Residual (n - 1, m) there, 0 where there is pressure [that unit].
        active: Where there is pressure (n - 1, m).

    Returns:
        Additional conductances (n - 1, m) of the nodes with pressure beside the edge [-].
    """
    added = np.zeros(pressure.shape)
    for own, other, cell in ((slice(1, None), slice(None, -1), links[1:-1]), (slice(None, -1), slice(1, None), links[1:-1])):
        edge = active[own] & ~active[other]
        flow = cell * pressure[own]
        passed = flow / np.where(edge, flow + residual[other], 1.0)
        added[own] += np.where(edge, cell * (1.0 / (0.5 + passed) - 1.0), 0.0)
    return added


@dataclass(frozen=True)
class _System:
    """Reynolds' equation on the nodes of one mesh, without the choice of those that carry pressure."""

    mesh: PadMesh
    terms: CircumferentialTerms
    axial_weights: Floats
    axial_stiffness: Floats

    @property
    def shape(self) -> tuple[int, int]:
        return self.terms.breadth.size, self.axial_weights.size

    @cached_property
    def links(self) -> Floats:
        return self.terms.conductance[:, None] * self.axial_weights

    @cached_property
    def _bands(self) -> Floats:
        """Return the lower bands of the matrix (m + 1, n - 1, m), in which nodes along the pad follow one another."""
        count = self.axial_weights.size
        bands = np.zeros((count + 1, *self.shape))
        for offset in range(count):
            bands[offset, :, : count - offset] = self.terms.breadth[:, None] * np.diagonal(self.axial_stiffness, offset)
        bands[0] += self.links[:-1] + self.links[1:]
        bands[count, :-1] = -self.links[1:-1]
        return bands

    def solution(self, active: Bools, inflow: Floats, edge: Floats | None = None) -> Floats:
        """Return the pressure (n - 1, m) of an inflow per unit of length (n - 1,) at the nodes that carry pressure."""
        return self._solved(active, inflow[:, None] * self.axial_weights, edge)

    def _solved(self, active: Bools, right: Floats, edge: Floats | None) -> Floats:
        pressure = np.zeros(self.shape)
        rows = np.flatnonzero(active.any(axis=1))
        if not rows.size:
            return pressure
        part, count = slice(rows[0], rows[-1] + 1), self.axial_weights.size
        carries = active[part].ravel().astype(float)
        bands = self._bands[:, part].copy()
        if edge is not None:
            bands[0] += edge[part]
        bands = bands.reshape(count + 1, -1) * carries
        for offset in range(1, count + 1):
            bands[offset, :-offset] *= carries[offset:]
        bands[0] += 1.0 - carries
        _, found, failed = dpbsv(bands, right[part].ravel() * carries, lower=1, overwrite_ab=1)
        if failed:
            raise FilmNotFound("Reynolds' equation has a singular matrix: is the film thinner than nothing?")
        pressure[part] = found.reshape(-1, count)
        return pressure

    def residual(self, pressure: Floats, inflow: Floats) -> Floats:
        """Return outflow less inflow (n - 1, m) of each node."""
        return _outflow(self.links, self.terms.breadth, self.axial_stiffness, pressure) - inflow[:, None] * self.axial_weights

    def perturbed(self, pressure: Floats, active: Bools, change: Floats, edge: Floats) -> Floats:
        """Return the change of the pressure (n - 1, m) with the film's thickness (n, 3)."""
        terms = term_changes(self.mesh, change)
        links = terms.conductance[:, None] * self.axial_weights
        right = -terms.outflow[:, None] * self.axial_weights
        right -= _outflow(links, terms.breadth, self.axial_stiffness, pressure)
        return self._solved(active, right, edge)

    def force(self, pressure: Floats) -> Floats:
        """Return the force on the journal (2,), -∫∫ p (cos, sin) dθ dζ, through the fluxes that are adjoint to the sources."""
        over_length = pressure @ self.axial_weights
        return np.array([-(over_length @ self.terms.sine), over_length @ self.terms.cosine])


def _outflow(links: Floats, breadth: Floats, axial_stiffness: Floats, pressure: Floats) -> Floats:
    """Return the outflow from each inner node (n - 1, m) at a pressure."""
    flow = links[1:-1] * (pressure[1:] - pressure[:-1])
    outflow = breadth[:, None] * (pressure @ axial_stiffness)
    outflow[:-1] -= flow
    outflow[1:] += flow
    outflow[0] += links[0] * pressure[0]
    outflow[-1] += links[-1] * pressure[-1]
    return outflow
