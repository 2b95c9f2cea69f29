"""Elimination of shaft degrees of freedom in forward and backward whirl.

With P = X + jY and Q = X - jY of the plane coordinates, a rotor that is the same in every direction across its axis obeys
two separate systems of half the size: one whirls with the rotation (forward), one against it (backward; complex coordinates,
Genta, Dynamics of Rotating Systems, Springer 2005). At the spin speed ω

    A_f = K - ω² (M - G) + jω C,      A_b = K - ω² (M + G) + jω (C + 2 C_internal)

with M, G, K of one bending plane, C the external damping; internal damping does not act in forward synchronous whirl.
What turns with the shaft excites forward whirl only.

An element joins neighbouring nodes only, so that A has few bands. Many degrees of freedom are eliminated as a banded
system, speed by speed, in time and memory that grow with their number; a few as a dense one at many speeds at a time.
"""

from functools import cached_property
from typing import Any

import numpy as np
import scipy
from msgspec import Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.rotor.assembly import Rotor
from estimator.rotor.parameters import Excitation, ScaleFactor
from estimator.rotor.scaled_rotor import ScaledRotor

FloatsOrComplexes = NDArray[np.float64] | NDArray[np.complex128]

BLOCK = 256
"""Number of speeds eliminated at a time."""
FEWEST_BANDED = 100
"""Number of plane degrees of freedom above which those eliminated are taken as a banded system."""
BANDS = 3
"""Number of bands of A on either side of its diagonal: (displacement, slope) of one node and the next."""
LARGEST_TRANSFER = 1e8
"""Largest motion of an eliminated degree of freedom per motion of a retained one [-]: beyond it eight digits are lost."""


class SingularCondensation(ValueError):
    """Raised when a speed falls on a natural frequency of the part that is eliminated."""


class _Side(Struct, frozen=True, eq=False):
    """One sense of whirl after elimination: transfer (S, e, r), own forces' response (S, e, E), stiffness (S, r, r).

    Transfer and response have e = 0 where they were not kept.
    """

    transfer: FloatsOrComplexes
    response: FloatsOrComplexes
    stiffness: FloatsOrComplexes
    force: FloatsOrComplexes

    def pick(self, which: slice) -> "_Side":
        """Return this side at some of the speeds."""
        return _Side(self.transfer[which], self.response[which], self.stiffness[which], self.force[which])


class GivenShafts(Struct, frozen=True, eq=False):
    """Shafts whose dynamic stiffness and forces are given.

    Attributes:
        stiffness: Dynamic stiffness (S, n, n) [N/m, N, N m].
        forces: Forces (S, n, 2E) per real and imaginary part of each excitation [N, N m per unit].
    """

    stiffness: Complexes
    forces: Complexes

    def known(self) -> Complexes:
        """Return a copy of the dynamic stiffness, to be changed as one likes.

        Returns:
            Dynamic stiffness (S, n, n) [N/m, N, N m].
        """
        return self.stiffness.copy()

    def force(self) -> Complexes:
        """Return the forces per real and imaginary part of each excitation.

        Returns:
            Forces (S, n, 2E) [N, N m per unit].
        """
        return self.forces

    def pick(self, which: slice) -> "GivenShafts":
        """Return these shafts at some of the speeds.

        Args:
            which: The speeds to keep.

        Returns:
            The shafts at these speeds.
        """
        return GivenShafts(self.stiffness[which], self.forces[which])


class WhirlElimination(Struct, frozen=True, eq=False):
    """The eliminated part of a train at S speeds, for given scale factors of E and ρ.

    Attributes:
        rotor: The rotor.
        retained: Plane degrees of freedom that stay (r,).
        acting: Forces (2r, E) that act on retained degrees of freedom [N, N m per unit].
        excitations: The E excitations.
        speed: Speeds (S,) [rad/s].
        direction: Sense of rotation (S,), +1 or -1 [-].
        reusable: Whether everything is kept that derivatives by scale factors need.
        factors: Scale factor by name [-]; 1 where none is given.
        forward: Forward whirl after elimination.
        backward: Backward whirl after elimination.
    """

    rotor: Rotor
    retained: NDArray[np.intp]
    acting: Floats
    excitations: tuple[Excitation, ...]
    speed: Floats
    direction: Floats
    reusable: bool
    factors: dict[str, float]
    forward: _Side
    backward: _Side

    @classmethod
    def of(
        cls,
        rotor: Rotor,
        *,
        retained: NDArray[np.intp],
        acting: Floats,
        excitations: tuple[Excitation, ...],
        speed: Floats,
        direction: Floats,
        reusable: bool,
        factors: dict[str, float] | None = None,
    ) -> "WhirlElimination":
        """Eliminate the degrees of freedom that are not retained.

        Args:
            rotor: The rotor.
            retained: Plane degrees of freedom that stay (r,).
            acting: Forces (2r, E) that act on retained degrees of freedom [N, N m per unit].
            excitations: The E excitations.
            speed: Speeds (S,) [rad/s].
            direction: Sense of rotation (S,), +1 or -1 [-].
            reusable: Whether everything is kept that derivatives by scale factors need.
            factors: Scale factor by name [-]; 1 where none is given.

        Returns:
            The eliminated part.

        Raises:
            SingularCondensation: A speed makes the elimination impossible.
        """
        scales = factors or {}
        plan = _Plan(ScaledRotor(rotor, excitations, scales), retained)
        return cls(
            rotor=rotor,
            retained=retained,
            acting=acting,
            excitations=excitations,
            speed=speed,
            direction=direction,
            reusable=reusable,
            factors=scales,
            forward=plan.side(speed, whirl=1, keep=reusable),
            backward=plan.side(speed, whirl=-1, keep=reusable),
        )

    def scaled(self, factors: dict[str, float]) -> "WhirlElimination":
        """Eliminate for other scale factors.

        Args:
            factors: Scale factor by name [-].

        Returns:
            The eliminated part.

        Raises:
            SingularCondensation: A speed makes the elimination impossible.
        """
        return WhirlElimination.of(
            self.rotor,
            retained=self.retained,
            acting=self.acting,
            excitations=self.excitations,
            speed=self.speed,
            direction=self.direction,
            reusable=True,
            factors=factors,
        )

    def pick(self, which: slice) -> "WhirlElimination":
        """Return the eliminated part at some of the speeds.

        Args:
            which: The speeds to keep.

        Returns:
            The part at these speeds.
        """
        return replace(
            self,
            speed=self.speed[which],
            direction=self.direction[which],
            forward=self.forward.pick(which),
            backward=self.backward.pick(which),
        )

    def known(self) -> Complexes:
        """Assemble the dynamic stiffness over the retained degrees of freedom: x-z plane, then y-z plane.

        Returns:
            Dynamic stiffness (S, 2r, 2r) [N/m, N, N m].
        """
        mean = (self.forward.stiffness + self.backward.stiffness) / 2
        across = 0.5j * self.direction[:, None, None] * (self.forward.stiffness - self.backward.stiffness)
        size = self.retained.size
        whole = np.empty((self.speed.size, 2 * size, 2 * size), dtype=complex)
        whole[:, :size, :size] = whole[:, size:, size:] = mean
        whole[:, :size, size:], whole[:, size:, :size] = across, -across
        return whole

    def force(self) -> Complexes:
        """Assemble the forces per real and imaginary part of each excitation: their mirror image against +x to +y.

        Returns:
            Forces (S, 2r, 2E) [N, N m per unit].
        """
        size = self.retained.size
        along = np.concatenate([self.forward.force, -1j * self.direction[:, None, None] * self.forward.force], axis=1)
        along = along + self.acting
        whole = np.empty((self.speed.size, 2 * size, 2 * len(self.excitations)), dtype=complex)
        whole[:, :, 0::2] = along
        whole[:, :, 1::2] = 1j * self.direction[:, None, None] * along
        return whole

    def scale_force(self, scale: ScaleFactor, displacement: Complexes, excitations: Complexes) -> Complexes:
        """Compute -(∂Z/∂ ln s) q + (∂F/∂ ln s) u for a scale factor s.

        Args:
            scale: The scale factor.
            displacement: Motion q (S, 2r) of the retained degrees of freedom [m, rad].
            excitations: Excitations u (E,) or (S, E) [SI].

        Returns:
            Forces (S, 2r) [N, N m].
        """
        size = self.retained.size
        turned = np.where(self.direction[:, None] > 0, excitations, np.conj(excitations))
        x_plane, y_plane = displacement[:, :size], displacement[:, size:]
        sense = 1j * self.direction[:, None]
        plan = _Plan(ScaledRotor(self.rotor, self.excitations, self.factors), self.retained)
        forward = plan.scale_force(scale, self.forward, self.speed, x_plane + sense * y_plane, 2 * turned, whirl=1)
        backward = plan.scale_force(scale, self.backward, self.speed, x_plane - sense * y_plane, 0 * turned, whirl=-1)
        return np.concatenate([(forward + backward) / 2, (forward - backward) / (2 * sense)], axis=1)


class _Plan(Struct, frozen=True, eq=False, dict=True):
    """Division of a scaled rotor's degrees of freedom into retained and eliminated ones, and the elimination of these."""

    scaled: ScaledRotor
    retained: NDArray[np.intp]

    @cached_property
    def eliminated(self) -> NDArray[np.intp]:
        """Return the plane degrees of freedom that go (e,)."""
        return np.setdiff1d(np.arange(self.scaled.rotor.plane_size), self.retained)

    @cached_property
    def _forward(self) -> "_BandedSystem":
        return _BandedSystem(self.scaled.matrices(1), self.eliminated, self.retained)

    @cached_property
    def _backward(self) -> "_BandedSystem":
        return _BandedSystem(self.scaled.matrices(-1), self.eliminated, self.retained)

    def _system(self, whirl: int) -> "_BandedSystem":
        return self._forward if whirl > 0 else self._backward

    @property
    def banded(self) -> bool:
        """Return whether so many degrees of freedom go that their bands pay."""
        return self.eliminated.size > FEWEST_BANDED

    def side(self, speed: Floats, *, whirl: int, keep: bool) -> _Side:
        """Eliminate in one sense of whirl, in blocks of speeds."""
        if self.banded:
            return self._banded_side(speed, whirl=whirl)
        matrices = self.scaled.matrices(whirl)
        blocks = [self._block(matrices, speed[i : i + BLOCK], whirl, keep) for i in range(0, speed.size, BLOCK)]
        return _Side(*(np.concatenate(parts) for parts in zip(*blocks, strict=True)))

    def _block(
        self, matrices: tuple[Floats, Floats, Floats], speed: Floats, whirl: int, keep: bool
    ) -> tuple[FloatsOrComplexes, FloatsOrComplexes, FloatsOrComplexes, FloatsOrComplexes]:
        inner, outer = self.eliminated, self.retained

        def part(rows: NDArray[np.intp], columns: NDArray[np.intp]) -> FloatsOrComplexes:
            stiffness, inertia, damping = (matrix[np.ix_(rows, columns)] for matrix in matrices)
            real = stiffness - (speed**2)[:, None, None] * inertia
            return real + 1j * speed[:, None, None] * damping if np.any(damping) else real

        own, across, kept = part(inner, inner), part(inner, outer), part(outer, outer)
        shapes = self.scaled.shapes(speed)
        if whirl < 0:
            shapes = shapes[:, :, :0]
        inside = np.concatenate([across, shapes[:, inner]], axis=2)
        solved = _solve(own, inside, speed, self.scaled.transfer_unit(inner, outer))
        transfer, response = solved[:, :, : outer.size], solved[:, :, outer.size :]
        stiffness = kept - across.swapaxes(1, 2) @ transfer
        force = shapes[:, outer] - across.swapaxes(1, 2) @ response
        if not keep:
            transfer, response = transfer[:, :0], response[:, :0]
        return transfer, response, stiffness, force

    def _banded_side(self, speed: Floats, *, whirl: int) -> _Side:
        inner, outer = self.eliminated, self.retained
        system = self._system(whirl)
        scale = self.scaled.transfer_unit(inner, outer)
        forced = len(self.scaled.excitations) if whirl > 0 else 0
        stiffness = np.empty((speed.size, outer.size, outer.size), dtype=system.dtype)
        force = np.empty((speed.size, outer.size, forced), dtype=system.dtype)
        for place, omega in enumerate(speed):
            shapes = self.scaled.shapes(speed[[place]])[0, :, :forced]
            across = system.across(omega)
            solved = system.solved(np.concatenate([across, shapes[inner]], axis=1), omega, scale)
            condensed = across.T @ solved
            stiffness[place] = system.kept(omega) - condensed[:, : outer.size]
            force[place] = shapes[outer] - condensed[:, outer.size :]
        return _Side(np.empty((speed.size, 0, outer.size)), np.empty((speed.size, 0, forced)), stiffness, force)

    def _motion(self, side: _Side, speed: Floats, retained: Complexes, excitations: Complexes, *, whirl: int) -> Complexes:
        """Compute the motion (S, e) of the eliminated degrees of freedom.

        It follows that of the retained ones (S, r) and excitations (S, E).
        """
        if not self.banded:
            moved = -(side.transfer @ retained[:, :, None])[:, :, 0]
            return moved + (side.response @ excitations[:, :, None])[:, :, 0] if whirl > 0 else moved
        inner, system = self.eliminated, self._system(whirl)
        moved = np.empty((speed.size, inner.size), dtype=complex)
        for place, omega in enumerate(speed):
            pushed = -(system.across(omega) @ retained[place])
            if whirl > 0:
                pushed = pushed + self.scaled.shapes(speed[[place]])[0, inner] @ excitations[place]
            moved[place] = system.solved(pushed[:, None], omega)[:, 0]
        return moved

    def _condensed_force(self, side: _Side, speed: Floats, force: Complexes, *, whirl: int) -> Complexes:
        """Compute the forces at the retained degrees of freedom (S, r) of forces (S, e) on the eliminated ones, turned
        around."""
        if not self.banded:
            return np.asarray((side.transfer.swapaxes(1, 2) @ force[:, :, None])[:, :, 0])
        system = self._system(whirl)
        # A is symmetric, so that the transfer's transpose is that of the forces.
        return np.array(
            [
                system.across(omega).T @ system.solved(one[:, None], omega)[:, 0]
                for omega, one in zip(speed, force, strict=True)
            ]
        )

    def scale_force(
        self, scale: ScaleFactor, side: _Side, speed: Floats, retained: Complexes, excitations: Complexes, *, whirl: int
    ) -> Complexes:
        """Compute -(∂A/∂ ln s) q + (∂F/∂ ln s) u condensed to the retained degrees of freedom of one sense of whirl,
        (S, r)."""
        whole = np.zeros((speed.size, self.scaled.rotor.plane_size), dtype=complex)
        excitations = np.broadcast_to(excitations, (speed.size, len(self.scaled.excitations)))
        whole[:, self.retained] = retained
        whole[:, self.eliminated] = self._motion(side, speed, retained, excitations, whirl=whirl)
        change = self.scaled.stiffness_rate(scale, speed, whole, whirl)
        if whirl > 0:
            change = change - self.scaled.stiffness_force(scale, excitations)
        outer = -change[:, self.retained]
        return np.asarray(outer + self._condensed_force(side, speed, change[:, self.eliminated], whirl=whirl))


class _BandedSystem:
    """A = stiffness - ω² inertia + jω damping of one sense of whirl, with the eliminated part as bands."""

    def __init__(self, matrices: tuple[Floats, Floats, Floats], inner: NDArray[np.intp], outer: NDArray[np.intp]) -> None:
        whole = matrices if np.any(matrices[2]) else matrices[:2]
        self.dtype = complex if len(whole) > 2 else float
        self._bands = [_bands(matrix[np.ix_(inner, inner)]) for matrix in whole]
        self._across = [matrix[np.ix_(inner, outer)] for matrix in whole]
        self._kept = [matrix[np.ix_(outer, outer)] for matrix in whole]

    def across(self, speed: float) -> FloatsOrComplexes:
        """Return the part (e, r) of A at a speed [rad/s]."""
        return _at(self._across, speed)

    def kept(self, speed: float) -> FloatsOrComplexes:
        """Return the part (r, r) of A at a speed [rad/s]."""
        return _at(self._kept, speed)

    def solved(self, inside: FloatsOrComplexes, speed: float, scale: Floats | None = None) -> FloatsOrComplexes:
        """Solve for A⁻¹ times columns (e, n) at a speed; scale: as in `_solve`. Raises SingularCondensation."""
        try:
            found: Any = scipy.linalg.solve_banded((BANDS, BANDS), _at(self._bands, speed), inside, check_finite=False)
        except np.linalg.LinAlgError:
            raise _singular(speed) from None
        if scale is not None and scale.size:
            transfer = np.abs(found[:, : scale.shape[1]]) / scale
            if not transfer.max() < LARGEST_TRANSFER:
                raise _singular(speed)
        return np.asarray(found)


def _bands(matrix: Floats) -> Floats:
    """Return the diagonals (2 BANDS + 1, e) of a matrix, from the uppermost, as LAPACK wants them."""
    bands = np.zeros((2 * BANDS + 1, len(matrix)))
    for above in range(-BANDS, BANDS + 1):
        diagonal = np.diagonal(matrix, above)
        bands[BANDS - above, max(above, 0) : max(above, 0) + diagonal.size] = diagonal
    return bands


def _at(parts: list[Floats], speed: float) -> FloatsOrComplexes:
    """Compute stiffness - ω² inertia + jω damping."""
    real = parts[0] - speed**2 * parts[1]
    return real + 1j * speed * parts[2] if len(parts) > 2 else real


def _solve(own: FloatsOrComplexes, inside: FloatsOrComplexes, speed: Floats, scale: Floats) -> FloatsOrComplexes:
    """Solve for A⁻¹ times the columns of `inside`, of which the first belong to retained degrees of freedom; scale: (e, r)."""
    try:
        solved = np.asarray(np.linalg.solve(own, inside))
    except np.linalg.LinAlgError:
        smallest = [np.linalg.svd(one, compute_uv=False)[-1] for one in own]
        raise _singular(speed[int(np.argmin(smallest))]) from None
    transfer = np.abs(solved[:, :, : scale.shape[1]]) / scale
    if transfer.size and not transfer.max() < LARGEST_TRANSFER:
        raise _singular(speed[int(np.argmax(transfer.max(axis=(1, 2))))])
    return solved


def _singular(speed: float) -> SingularCondensation:
    return SingularCondensation(
        f"speed {speed:.6g} rad/s falls on a natural frequency of the shafts clamped at bearings and couplings: "
        "leave that speed out"
    )
