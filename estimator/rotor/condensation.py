"""Exact dynamic condensation of a train to the degrees of freedom that carry unknowns or probes.

At each speed everything else is eliminated by the dynamic Schur complement, so that the unknowns sit in a small system
Z(ω, p) q = F(ω, U) without any approximation. (The thesis's Eq. 4.8-4.20 condense the same way; its high-frequency form of
§4.4 drops the stiffness and is not used here.) The eliminated parts, shafts and discs, are the same in every direction
across the axis: in forward and backward whirl they separate into two systems of half the size, real without damping.
"""

from collections.abc import Iterator
from functools import cached_property

import numpy as np
from msgspec import Struct, field
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.rotor.assembly import Rotor, assemble_rotor, plane_columns
from estimator.rotor.elimination import GivenShafts, WhirlElimination
from estimator.rotor.parameters import ScaleFactor, Unknowns, dense, scale_factors, unknowns
from estimator.rotor.shaft_element import NODE_DOFS

BLOCK = 256
"""Number of speeds that are computed at a time: enough for the arithmetic to be fast, little enough for memory."""
LARGEST_GIVEN = 1_000_000
"""Most numbers of dynamic stiffness and forces that are kept in full, 16 bytes each [-]; more are assembled when needed."""


class CondensedTrain(Struct, frozen=True, eq=False, dict=True):
    """A train at S speeds, with n retained degrees of freedom, K coefficients in T terms, E excitations and m channels.

    Attributes:
        speed: Spin speeds (S,) [rad/s], positive.
        direction: Sense of rotation (S,), +1 or -1 [-].
        shafts: Dynamic stiffness of shafts and discs and the forces on them, at the retained degrees of freedom.
        left: Vectors a (n, T), one per term [-].
        right: Vectors b (n, T), one per term [-].
        output: Displacement (m, n) at each probe, along its angle [-].
        unknowns: Names and expectations of coefficients and excitations.
        channels: Ids of the m channels.
        gain_spread: Standard deviation (m,) of each channel's gain [-]; empty where gains are exact.
        run_out_spread: Standard deviation (m,) of each channel's run-out [m]; empty where run-outs are exact.
        scale_factors: The F factors of E and ρ that are not known exactly.
        machine: The machine; None for a train that is none's.
        freed: Strain (2, T, E) of each term at which couplings are free of load, per unit of each excitation's motion in the
            x-z plane, then in the y-z plane [-]; without terms where no coupling runs out.
    """

    speed: Floats
    direction: Floats
    shafts: WhirlElimination | GivenShafts
    left: Floats
    right: Floats
    output: Floats
    unknowns: Unknowns
    channels: tuple[str, ...]
    gain_spread: Floats = field(default_factory=lambda: np.zeros(0))
    run_out_spread: Floats = field(default_factory=lambda: np.zeros(0))
    scale_factors: tuple[ScaleFactor, ...] = ()
    machine: Machine | None = None
    freed: Floats = field(default_factory=lambda: np.zeros((2, 0, 0)))

    @property
    def scale_names(self) -> tuple[str, ...]:
        """Return the names of the scale factors."""
        return tuple(one.name for one in self.scale_factors)

    @property
    def scale_spread(self) -> Floats:
        """Return the relative rms spread (F,) of each scale factor [-]."""
        return np.array([one.spread for one in self.scale_factors])

    @property
    def known(self) -> Complexes:
        """Return the dynamic stiffness of shafts and discs (S, n, n) [N/m, N, N m/rad]."""
        return self.shafts.known()

    @property
    def force(self) -> Complexes:
        """Return the forces (S, n, 2E) per part of each excitation that acts on the shafts [N and N m per unit]."""
        return self.shafts.force()

    @property
    def free_strain(self) -> Complexes | None:
        """Return the strain (S, T, 2E) of each term at which couplings are free of load, per part of each excitation [-].

        None where no coupling runs out.
        """
        if not self.freed.any():
            return None
        sense = 1j * self.direction[:, None, None]
        along = self.freed[0] - sense * self.freed[1]
        return np.stack([along, sense * along], axis=-1).reshape(*along.shape[:2], -1)

    def forces(self, coefficients: Floats) -> Complexes:
        """Compute the forces of all excitations: on the shafts, and of couplings whose run-out strains them.

        Args:
            coefficients: Coefficients p (K,) or, where they follow the speed, (S, K) [SI].

        Returns:
            Forces (S, n, 2E) per real and imaginary part of each excitation [N and N m per unit].
        """
        strain = self.free_strain
        if strain is None:
            return self.force
        which = np.flatnonzero(self.freed.any(axis=(0, 2)))
        value = coefficients[..., self.owner[which]]
        return np.asarray(self.force + (self.left[:, which] * value[..., None, :]) @ strain[:, which])

    @property
    def owner(self) -> NDArray[np.intp]:
        """Return the coefficient (T,) that each term belongs to, ascending."""
        return self.unknowns.order_of_terms[0]

    @cached_property
    def order(self) -> NDArray[np.intp]:
        """Return the power (K,) of jω with which each coefficient acts."""
        return np.array([c.order for c in self.unknowns.coefficients], dtype=np.intp)

    def dynamic_stiffness(self, coefficients: Floats) -> Complexes:
        """Assemble Z = known + Σ (jω)ⁿ p a bᵀ.

        Args:
            coefficients: Coefficients p (K,) or, where they follow the speed, (S, K) [SI].

        Returns:
            Z (S, n, n) [N/m, N, N m/rad]; NaN at speeds at which a coefficient is.
        """
        whole = self.known
        flat = whole.reshape(len(whole), -1)
        for power, owner, places, products in self._products:
            flat[:, places] += ((1j * self.speed) ** power)[:, None] * (coefficients[..., owner] @ products)
        # Where a film is too thin nothing is known: LAPACK would call a matrix singular that is unknown in part.
        flat[~np.broadcast_to(np.isfinite(coefficients).all(axis=-1), len(flat))] = np.nan
        return whole

    @cached_property
    def _products(self) -> tuple[tuple[int, NDArray[np.intp], NDArray[np.intp], Floats], ...]:
        """Return for each power of jω the coefficients (t,) of its terms, and where (p,) among the n² places their products
        a bᵀ (t, p) are not zero: few, as a term joins two places of the train."""
        owner, order = self.unknowns.order_of_terms
        found = []
        for power in np.unique(order).tolist():
            which = np.flatnonzero(order == power)
            whole = (self.left[:, None, which] * self.right[None, :, which]).reshape(-1, which.size).T
            places = np.flatnonzero(whole.any(axis=0))
            found.append((power, owner[which], places, np.ascontiguousarray(whole[:, places])))
        return tuple(found)

    def force_of(self, excitations: Complexes, coefficients: Floats) -> Complexes:
        """Assemble the force of excitations.

        Args:
            excitations: Excitations (E,) or, where they differ from sample to sample, (S, E) [SI].
            coefficients: Coefficients (K,) or, where they follow the speed, (S, K) [SI].

        Returns:
            F (S, n) [N, N m].
        """
        return np.asarray((self.forces(coefficients) @ parts_of(excitations)[..., None])[..., 0])

    def pick(self, which: slice) -> "CondensedTrain":
        """Return the same train at some of its speeds.

        Args:
            which: The speeds to keep.

        Returns:
            The train at these speeds.
        """
        return replace(
            self,
            speed=self.speed[which],
            direction=self.direction[which],
            shafts=self.shafts.pick(which),
        )

    def blocks(self) -> Iterator[slice]:
        """Divide the speeds into blocks of at most BLOCK.

        Yields:
            Slices of the speeds that together are all of them.
        """
        for begin in range(0, self.speed.size, BLOCK):
            yield slice(begin, min(begin + BLOCK, self.speed.size))

    def scaled(self, factors: Floats) -> "CondensedTrain":
        """Return the train with Young's modulus E and density ρ of its materials multiplied.

        Args:
            factors: Factors (F,) of `scale_names` [-].

        Returns:
            The scaled train; the same one where there is nothing to scale.
        """
        if factors.size == 0 or isinstance(self.shafts, GivenShafts):
            return self
        return replace(self, shafts=self.shafts.scaled(dict(zip(self.scale_names, factors, strict=True))))


def parts_of(excitations: Complexes) -> Floats:
    """Return the real and imaginary parts of excitations, one after the other.

    Args:
        excitations: Excitations (…, E) [SI].

    Returns:
        Parts (…, 2E) [SI].
    """
    return np.stack([excitations.real, excitations.imag], axis=-1).reshape(*excitations.shape[:-1], -1)


def condense(machine: Machine, *, speed: Floats, direction: Floats, output: Floats | None = None) -> CondensedTrain:
    """Condense a machine at the given speeds (dynamic Schur complement; compare thesis Eq. 4.8-4.20).

    Args:
        machine: The machine.
        speed: Spin speeds (S,) [rad/s], positive and finite.
        direction: Sense of rotation (S,) [-]: +1 from +x to +y, -1 against it.
        output: Rows (m, N) over all degrees of freedom to look at [-]; None for the probes.

    Returns:
        The condensed train.

    Raises:
        ValueError: A speed is not positive and finite, or direction does not hold +1 or -1 for each speed.
        SingularCondensation: Elimination is impossible at a speed.
    """
    speed = np.asarray(speed, dtype=float)
    direction = np.asarray(direction, dtype=float)
    if speed.ndim != 1 or speed.size == 0 or not np.all(np.isfinite(speed) & (speed > 0)):
        raise ValueError("speed must be a non-empty list of positive, finite spin speeds [rad/s]")
    if direction.shape != speed.shape or not np.all(np.abs(direction) == 1):
        raise ValueError("direction must hold +1 or -1 for each speed")
    rotor = assemble_rotor(machine)
    unknown = unknowns(machine, rotor)
    pairs = [pair for coefficient in unknown.coefficients for pair in coefficient.pairs]
    vectors = {
        "left": _in_planes(rotor, dense([left for left, _ in pairs], rotor.size)),
        "right": _in_planes(rotor, dense([right for _, right in pairs], rotor.size)),
        "output": _in_planes(rotor, (probe_rows(machine, rotor) if output is None else output).T),
        "acting": _in_planes(rotor, dense([item.acting or {} for item in unknown.excitations], rotor.size)),
    }
    touched = np.any(np.concatenate(list(vectors.values()), axis=1), axis=1)
    retained = np.flatnonzero(touched[: rotor.plane_size] | touched[rotor.plane_size :])
    kept = np.concatenate([retained, rotor.plane_size + retained])
    scales = scale_factors(machine, rotor)
    elimination = WhirlElimination.of(
        rotor,
        retained=retained,
        acting=vectors["acting"][kept],
        excitations=unknown.excitations,
        speed=speed,
        direction=direction,
        reusable=bool(scales),
    )
    return CondensedTrain(
        speed=speed,
        direction=direction,
        shafts=_given(elimination, reusable=bool(scales)),
        left=vectors["left"][kept],
        right=vectors["right"][kept],
        output=vectors["output"][kept].T,
        unknowns=unknown,
        channels=machine.channels,
        gain_spread=np.array([probe.gain_spread for probe in machine.probes]),
        run_out_spread=np.array([probe.run_out_spread for probe in machine.probes]),
        scale_factors=scales,
        machine=machine,
        freed=_freed(rotor, unknown, vectors["right"]),
    )


def _freed(rotor: Rotor, unknown: Unknowns, right: Floats) -> Floats:
    """Return `CondensedTrain.freed` from each term's vector b (N, T) over both planes."""
    shapes = np.zeros((rotor.plane_size, len(unknown.excitations)))
    for column, item in enumerate(unknown.excitations):
        if item.coupled and item.shape is not None:
            shapes[:, column] = item.shape
    if not shapes.any():
        return np.zeros((2, 0, 0))
    own = [[one.element == item.element and one.order == 0 for item in unknown.excitations] for one in unknown.coefficients]
    planes = right[: rotor.plane_size], right[rotor.plane_size :]
    by_term = np.stack([plane.T @ shapes for plane in planes])
    return np.asarray(by_term * np.array(own, dtype=float)[unknown.order_of_terms[0]])


def _given(elimination: WhirlElimination, *, reusable: bool) -> WhirlElimination | GivenShafts:
    """Return what is left of the shafts in full, where that is little and no derivatives by scale factors are wanted."""
    motions = 2 * elimination.retained.size
    numbers = elimination.speed.size * motions * (motions + 2 * len(elimination.excitations))
    if reusable or numbers > LARGEST_GIVEN:
        return elimination
    return GivenShafts(elimination.known(), elimination.force())


def _in_planes(rotor: Rotor, vectors: Floats) -> Floats:
    """Convert vectors (N, count) over (x, y, θx, θy) per node to vectors over the x-z plane, then the y-z plane."""
    x_plane, y_plane = plane_columns(rotor.size)
    return np.concatenate([x_plane.T @ vectors, y_plane.T @ vectors])


def probe_rows(machine: Machine, rotor: Rotor) -> Floats:
    """Assemble the map from the motion of all degrees of freedom to the probes.

    Args:
        machine: The machine, with m probes.
        rotor: Its assembled rotor, with N degrees of freedom.

    Returns:
        Displacement (m, N) at each probe, along its angle and relative to the pedestal that it stands on, per motion of each
        degree of freedom [-].
    """
    rows = np.zeros((len(machine.probes), rotor.size))
    for row, probe in zip(rows, machine.probes, strict=True):
        x = NODE_DOFS * rotor.node(probe.shaft, probe.station)
        angle = np.deg2rad(probe.angle_deg)
        row[x], row[x + 1] = np.cos(angle), np.sin(angle)
        row[np.abs(row) < 1e-15] = 0.0  # a probe along an axis sees that axis only
        pedestal = machine.pedestal_under(probe)
        if pedestal is not None:
            stands = NODE_DOFS * rotor.pedestal_node[pedestal.id]
            row[stands : stands + 2] -= row[x : x + 2]
    return rows
