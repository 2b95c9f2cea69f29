"""A rotor whose materials' E and ρ are multiplied by factors: its matrices in one plane, its forces, and their derivatives."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.rotor.assembly import Rotor
from estimator.rotor.parameters import Excitation, ScaleFactor


@dataclass(frozen=True)
class ScaledRotor:
    """The plane matrices of a rotor, and the forces of what turns with it, for given scale factors of E and ρ.

    factors: scale factor by name, 1 where none is given.
    """

    rotor: Rotor
    excitations: tuple[Excitation, ...]
    factors: dict[str, float]

    def factor(self, material: str, what: str) -> float:
        """Scale factor of a material's `young_modulus` or `density`."""
        return self.factors.get(f"material.{material}.{what}", 1.0)

    @cached_property
    def length(self) -> float:
        """A length [m] that makes slopes comparable with displacements."""
        return max(float(stations[-1]) for stations in self.rotor.stations.values())

    def matrices(self, whirl: int) -> tuple[Floats, Floats, Floats]:
        """Plane stiffness, inertia and damping (N/2, N/2) so that A = stiffness - ω² inertia + jω damping."""
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
        """Of each excitation, the force (N/2,) per its power of ω, of what turns with the shaft."""

        def force(item: Excitation) -> Floats | None:
            if item.shape is None or not item.stiffened:
                return item.shape
            shape = item.shape
            parts = (self.factor(n, "young_modulus") * (m.stiffness @ shape) for n, m in self.rotor.materials.items())
            return sum(parts, np.zeros_like(shape))

        return tuple(force(item) for item in self.excitations)

    def shapes(self, speed: Floats) -> Floats:
        """Force shapes (S, N/2, E) of what turns with the shaft."""
        whole = np.zeros((speed.size, self.rotor.plane_size, len(self.excitations)))
        for column, (item, shape) in enumerate(zip(self.excitations, self._shapes, strict=True)):
            if shape is not None:
                whole[:, :, column] = speed[:, None] ** item.speed_power * shape
        return whole

    def transfer_unit(self, inner: NDArray[np.intp], outer: NDArray[np.intp]) -> Floats:
        """Factors (e, r) that turn transfers between displacements and slopes into numbers without dimension."""
        unit = np.where(np.arange(self.rotor.plane_size) % 2 == 0, 1.0, self.length)
        return np.asarray(unit[inner][:, None] / unit[outer])

    def stiffness_force(self, scale: ScaleFactor, excitations: Complexes) -> Complexes:
        """(∂F/∂ ln s) u (S, N/2) of the excitations (S, E) that a shaft's stiffness carries, such as a bow."""
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
        """(∂A/∂ ln s) q (S, N/2) of a motion q (S, N/2)."""
        part = self.rotor.materials[scale.material]
        alpha, beta = self.rotor.rayleigh
        omega = speed[:, None]
        factor = self.factor(scale.material, scale.what)
        if scale.what == "young_modulus":
            loss = beta + (1 - whirl) * self.rotor.internal[scale.material]
            return np.asarray(factor * ((1 + 1j * omega * loss) * (motion @ part.stiffness)))
        inertia = -(omega**2) * (motion @ (part.mass - whirl * part.gyroscopic))
        return np.asarray(factor * (inertia + 1j * omega * alpha * (motion @ part.mass)))
