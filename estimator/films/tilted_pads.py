"""Pads of a tilting-pad bearing kept as degrees of freedom beside the journal.

A pad without inertia has one state: w, the journal's motion across the line through the pivot plus tilt times radius. It obeys
K_tt w + C_tt ẇ + K_tn u + C_tn u̇ = 0, u being the motion towards the pivot, and the journal meets the force along that line,
-(K_nn u + C_nn u̇ + K_nt w + C_nt ẇ), alone (J. W. Lund, ASLE Trans. 7 (1964) 342, doi:10.1080/05698196408972064).
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Complexes, Floats

PositionIndex = int | tuple[int | slice, ...]
"""Index of one of several positions, or of some."""


@dataclass(frozen=True)
class HeldPads:
    """First-order form of n pads: the journal's force is -K u - C u̇ - Σ axis push w, and ẇ = -rate w - drive u_n - drag u̇_n.

    Attributes:
        stiffness: K (..., 2, 2), with every w held [N/m].
        damping: C (..., 2, 2), with every w held [N s/m].
        push: Force (..., n) along each pad's axis per unit of w [N/m].
        rate: Rates (..., n) at which a tilt dies out [1/s].
        drive: Rates (..., n) of w per unit of the journal's motion towards the pivot [1/s].
        drag: Rates (..., n) of w per unit of its speed [-].
    """

    stiffness: Floats
    damping: Floats
    push: Floats
    rate: Floats
    drive: Floats
    drag: Floats


@dataclass(frozen=True)
class TiltedPads:
    """The n pads of a bearing at positions (...) of the journal, near which they move.

    Matrices of a pad are over motions (towards the pivot, across); units as of who gives them, see `FilmCoefficients`.

    Attributes:
        axis: Directions (..., n, 2) from the bearing's centre to the pivots [-].
        stiffness: Stiffness (..., n, 2, 2) of each pad's film, the pad being held [μ ω R L (R/c)²/c, or N/m].
        damping: Damping (..., n, 2, 2) of each pad's film, the pad being held [μ R L (R/c)²/c, or N s/m].
        weight: Part (..., n) of each film that is there, which goes with both; 0 where a pad is unloaded [-].
        restoring: Force (..., n) against a slow motion towards the pivot, per unit of it, the pad following
            [μ ω R L (R/c)²/c, or N/m].
    """

    axis: Floats
    stiffness: Floats
    damping: Floats
    weight: Floats
    restoring: Floats

    @property
    def static_stiffness(self) -> Floats:
        """Return the stiffness (..., 2, 2) against slow motions of the journal, with all pads following [N/m]."""
        return np.asarray(np.einsum("...n,...ni,...nj->...ij", self.restoring, self.axis, self.axis))

    def reduced(self, eigenvalue: complex) -> Complexes:
        """Reduce the pads to the dynamic stiffness that a journal meets in a motion e^{λt} (Lund 1964).

        Args:
            eigenvalue: λ; its unit is that of stiffness over damping [rad/s].

        Returns:
            Dynamic stiffness K + λ C (..., 2, 2), symmetric [N/m].
        """
        z = self.stiffness + eigenvalue * self.damping
        held = self.weight * (z[..., 0, 0] - z[..., 0, 1] * z[..., 1, 0] / z[..., 1, 1])
        return np.asarray(np.einsum("...n,...ni,...nj->...ij", held, self.axis, self.axis))

    @property
    def held(self) -> "HeldPads":
        """Return the pads (...) as states w beside the journal's motion [SI]."""
        (nn, nt), (tn, tt) = np.moveaxis(self.stiffness, (-2, -1), (0, 1))
        (c_nn, c_nt), (_, c_tt) = np.moveaxis(self.damping, (-2, -1), (0, 1))

        def over_axes(along: Floats) -> Floats:
            return np.asarray(np.einsum("...n,...ni,...nj->...ij", self.weight * along, self.axis, self.axis))

        return HeldPads(
            over_axes(nn - c_nt * tn / c_tt),
            over_axes(c_nn - c_nt**2 / c_tt),
            self.weight * (nt - c_nt * tt / c_tt),
            tt / c_tt,
            tn / c_tt,
            c_nt / c_tt,
        )

    def rescaled(self, *, stiffness: Floats, damping: Floats) -> "TiltedPads":
        """Return the pads in other units.

        Args:
            stiffness: Unit of stiffness (...) [N/m].
            damping: Unit of damping (...) [N s/m].

        Returns:
            The pads in SI units.
        """
        k, c = stiffness[..., None], damping[..., None]
        matrices = self.stiffness * k[..., None, None], self.damping * c[..., None, None]
        return TiltedPads(self.axis, *matrices, self.weight, self.restoring * k)

    def turned(self, sign: Floats) -> "TiltedPads":
        """Return the pads in axes of which some point the other way.

        Args:
            sign: Signs (2,) of the axes; shape (component,) with components x, y [-].

        Returns:
            The pads.
        """
        return TiltedPads(self.axis * sign, self.stiffness, self.damping, self.weight, self.restoring)

    def at(self, place: PositionIndex) -> "TiltedPads":
        """Return the pads at one of several positions.

        Args:
            place: Number of the position along the first axis, or the index of some along several.

        Returns:
            The pads.
        """
        return TiltedPads(
            self.axis[place], self.stiffness[place], self.damping[place], self.weight[place], self.restoring[place]
        )
