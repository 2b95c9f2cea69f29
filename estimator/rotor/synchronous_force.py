"""Forces on all degrees of freedom of a train that turn with the shaft, at changing speed too."""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.rotor.assembly import Rotor, plane_columns
from estimator.rotor.parameters import Excitation


@dataclass(frozen=True, eq=False)
class SynchronousForce:
    """Force Re(F e^{jφ}) with φ the angle turned.

    A mass m at the radius e that turns with φ(t) pulls with m e (ω² - jα) e^{jφ}: its own acceleration, the tangential part
    included.

    Attributes:
        squared: Part (N,) of F that is multiplied by ω² - jα [kg m, kg m²].
        constant: Constant part (N,) of F [N, N m].
    """

    squared: Complexes
    constant: Complexes

    def at(self, speed: Floats, acceleration: Floats | None = None) -> Complexes:
        """Compute F at some speeds.

        Args:
            speed: Speeds (S,), positive [rad/s].
            acceleration: Accelerations (S,) [rad/s²]; None for none.

        Returns:
            F (S, N) [N, N m].
        """
        square = speed**2 if acceleration is None else speed**2 - 1j * acceleration
        return np.asarray(square[:, None] * self.squared + self.constant)

    def onto(self, vectors: Complexes) -> "SynchronousForce":
        """Project the force on vectors.

        Args:
            vectors: Vectors (k, N) [-].

        Returns:
            The forces (k,) on as many coordinates.
        """
        return SynchronousForce(vectors @ self.squared, vectors @ self.constant)


def synchronous_force(
    rotor: Rotor, excitations: tuple[Excitation, ...], *, values: Complexes, direction: float
) -> SynchronousForce:
    """Assemble the forces of excitations on a rotor.

    Args:
        rotor: The rotor.
        excitations: The E excitations.
        values: Their values (E,) [SI].
        direction: Sense of rotation, +1 or -1 [-].

    Returns:
        The forces.
    """
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
