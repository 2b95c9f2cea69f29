"""Rotor whose materials' E and ρ are multiplied by factors: its matrices in one plane, its forces, and their derivatives."""

from functools import cached_property

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.rotor.assembly import Rotor
from estimator.rotor.parameters import Excitation, ScaleFactor


class ScaledRotor(Struct, frozen=True, dict=True):
    """A rotor with its excitations, for given scale factors of E and ρ.

    Attributes:
        rotor: The rotor.
        excitations: The E excitations.
        factors: Scale factor by name [-]; 1 where none is given.
    """

    rotor: Rotor
    excitations: tuple[Excitation, ...]
    factors: dict[str, float]

    def factor(self, material: str, what: str) -> float:
        """Return the scale factor of a material's property.

        Args:
            material: Id of the material.
            what: `young_modulus` or `density`.

        Returns:
            The factor [-].
        """
        return self.factors.get(f"material.{material}.{what}", 1.0)

    @cached_property
    def length(self) -> float:
        """Return a length that makes slopes comparable with displacements [m]."""
        return max(float(stations[-1]) for stations in self.rotor.stations.values())

    def matrices(self, whirl: int) -> tuple[Floats, Floats, Floats]:
        """Assemble the plane matrices of one sense of whirl, so that A = stiffness - ω² inertia + jω damping.

        Args:
            whirl: +1 for forward whirl, -1 for backward.

        Returns:
            Stiffness (N/2, N/2) [N/m, N, N m], inertia (N/2, N/2) [kg, kg m, kg m²] and damping (N/2, N/2) [N s/m, N s, N m
            s].
        """
        alpha, beta = self.rotor.rayleigh
        stiffness = self.rotor.discs.stiffness.copy()
        inertia = self.rotor.discs.mass - whirl * self.rotor.discs.gyroscopic
        damping = np.zeros_like(stiffness)
        for name, part in self.rotor.materials.items():
            elastic = self.factor(name, "young_modulus") * part.stiffness
            heavy = self.factor(name, "density")
            stiffness += elastic
            inertia = inertia + heavy * (part.mass - whirl * part.gyroscopic)
            damping += (beta + (1 - whirl) * self.rotor.internal[name]) * elastic + alpha * heavy * part.mass
        return stiffness, inertia, damping

    @cached_property
    def _shapes(self) -> tuple[Floats | None, ...]:
        """Compute the force (N/2,) of each excitation that turns with the shaft, per its power of ω; none of couplings'."""

        def force(item: Excitation) -> Floats | None:
            if item.coupled:
                return None
            if item.shape is None or not item.stiffened:
                return item.shape
            shape = item.shape
            parts = (self.factor(n, "young_modulus") * (m.stiffness @ shape) for n, m in self.rotor.materials.items())
            return sum(parts, np.zeros_like(shape))

        return tuple(force(item) for item in self.excitations)

    def shapes(self, speed: Floats) -> Floats:
        """Compute the force shapes of the excitations that turn with the shaft.

        Args:
            speed: Speeds (S,) [rad/s].

        Returns:
            Forces (S, N/2, E) per unit of each excitation [N, N m].
        """
        whole = np.zeros((speed.size, self.rotor.plane_size, len(self.excitations)))
        for column, (item, shape) in enumerate(zip(self.excitations, self._shapes, strict=True)):
            if shape is not None:
                whole[:, :, column] = speed[:, None] ** item.speed_power * shape
        return whole

    def transfer_unit(self, inner: NDArray[np.intp], outer: NDArray[np.intp]) -> Floats:
        """Return the factors that turn transfers between displacements and slopes into numbers without dimension.

        Args:
            inner: Plane degrees of freedom (e,) that move.
            outer: Plane degrees of freedom (r,) that move them.

        Returns:
            Factors (e, r) [-, m, 1/m].
        """
        unit = np.where(np.arange(self.rotor.plane_size) % 2 == 0, 1.0, self.length)
        return np.asarray(unit[inner][:, None] / unit[outer])

    def stiffness_force(self, scale: ScaleFactor, excitations: Complexes) -> Complexes:
        """Compute (∂F/∂ ln s) u of the excitations that a shaft's stiffness carries, such as a bow.

        Args:
            scale: The scale factor s.
            excitations: Excitations u (S, E) [SI].

        Returns:
            Forces (S, N/2) [N, N m].
        """
        part = self.rotor.materials[scale.material]
        whole = np.zeros((len(excitations), self.rotor.plane_size), dtype=complex)
        if scale.what != "young_modulus":
            return whole
        for column, item in enumerate(self.excitations):
            if item.stiffened and item.shape is not None:
                lifted = self.factor(scale.material, scale.what) * (part.stiffness @ item.shape)
                whole = whole + lifted * excitations[:, column, None]
        return whole

    def stiffness_rate(self, scale: ScaleFactor, speed: Floats, motion: Complexes, whirl: int) -> Complexes:
        """Compute (∂A/∂ ln s) q of a motion q.

        Args:
            scale: The scale factor s.
            speed: Speeds (S,) [rad/s].
            motion: Motion q (S, N/2) [m, rad].
            whirl: +1 for forward whirl, -1 for backward.

        Returns:
            Forces (S, N/2) [N, N m].
        """
        part = self.rotor.materials[scale.material]
        alpha, beta = self.rotor.rayleigh
        omega = speed[:, None]
        factor = self.factor(scale.material, scale.what)
        if scale.what == "young_modulus":
            loss = beta + (1 - whirl) * self.rotor.internal[scale.material]
            return np.asarray(factor * ((1 + 1j * omega * loss) * (motion @ part.stiffness)))
        inertia = -(omega**2) * (motion @ (part.mass - whirl * part.gyroscopic))
        return np.asarray(factor * (inertia + 1j * omega * alpha * (motion @ part.mass)))
