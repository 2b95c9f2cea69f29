"""What turns with the shaft as forces on all degrees of freedom of a train, at changing speed too."""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.parameters import Excitation
from estimator.rotor import Rotor, plane_columns


@dataclass(frozen=True)
class SynchronousForce:
    """Complex forces F of the force Re(F e^{jφ}) with φ the angle turned: `squared` times ω² - jα, and `constant`, each (N,).

    A mass m at the radius e that turns with φ(t) pulls with m e (ω² - jα) e^{jφ}: its own acceleration, the tangential part
    included.
    """

    squared: Complexes
    constant: Complexes

    def at(self, speed: Floats, acceleration: Floats | None = None) -> Complexes:
        """F (S, N) [SI] at speeds (S,) [rad/s], positive, and accelerations (S,) [rad/s²], by default none."""
        square = speed**2 if acceleration is None else speed**2 - 1j * acceleration
        return np.asarray(square[:, None] * self.squared + self.constant)

    def onto(self, vectors: Complexes) -> "SynchronousForce":
        """What it does along vectors (k, N): the forces (k,) of as many coordinates."""
        return SynchronousForce(vectors @ self.squared, vectors @ self.constant)


def synchronous_force(
    rotor: Rotor, excitations: tuple[Excitation, ...], *, values: Complexes, direction: float
) -> SynchronousForce:
    """The forces of the excitations' values (E,) [SI] on a rotor that turns in a direction, +1 or -1."""
    x_plane, y_plane = plane_columns(rotor.size)
    squared, constant = np.zeros(rotor.size, dtype=complex), np.zeros(rotor.size, dtype=complex)
    elastic = sum((part.stiffness for part in rotor.materials.values()), np.zeros_like(rotor.discs.stiffness))
    for item, value in zip(excitations, values, strict=True):
        turned = value if direction > 0 else np.conj(value)
        for place, size in (item.acting or {}).items():
            constant[place] += size * turned
        if item.shape is not None:
            shape = elastic @ item.shape if item.stiffened else item.shape
            along = (x_plane - 1j * direction * y_plane) @ shape * turned
            whole = squared if item.speed_power == 2 else constant
            whole += along
    return SynchronousForce(squared, constant)
