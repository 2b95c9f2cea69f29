"""Forces on all degrees of freedom of a train that turn with the shaft, at changing speed too."""

from collections.abc import Callable

import numpy as np
from msgspec import Struct

from estimator.arrays import Complexes, Floats
from estimator.rotor.assembly import Rotor, plane_columns
from estimator.rotor.parameters import Excitation, Unknowns


class SynchronousForce(Struct, frozen=True, eq=False):
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

    def project(self, vectors: Complexes) -> "SynchronousForce":
        """Project the force on vectors.

        Args:
            vectors: Vectors (k, N) [-].

        Returns:
            The forces (k,) on as many coordinates.
        """
        return SynchronousForce(vectors @ self.squared, vectors @ self.constant)


def synchronous_force(
    rotor: Rotor, unknown: Unknowns, *, values: Complexes, coefficients: Callable[[], Floats], direction: float
) -> SynchronousForce:
    """Assemble the forces of excitations on a rotor.

    Args:
        rotor: The rotor.
        unknown: The E excitations, and the K coefficients.
        values: Values (E,) of the excitations [SI].
        coefficients: Function that returns the coefficients (K,) [SI], which couplings that run out pull with.
        direction: Sense of rotation, +1 or -1 [-].

    Returns:
        The forces.
    """
    x_plane, y_plane = plane_columns(rotor.size)
    squared, constant = np.zeros(rotor.size, dtype=complex), np.zeros(rotor.size, dtype=complex)
    elastic = sum((part.stiffness for part in rotor.materials.values()), np.zeros_like(rotor.discs.stiffness))
    for item, value in zip(unknown.excitations, values, strict=True):
        turned = value if direction > 0 else np.conj(value)
        for place, size in (item.acting or {}).items():
            constant[place] += size * turned
        if item.coupled and item.shape is not None:
            free = (x_plane - 1j * direction * y_plane) @ item.shape * turned
            constant += _pull(unknown, item, coefficients(), free)
        elif item.shape is not None:
            shape = elastic @ item.shape if item.stiffened else item.shape
            along = (x_plane - 1j * direction * y_plane) @ shape * turned
            whole = squared if item.speed_power == 2 else constant
            whole += along
    return SynchronousForce(squared, constant)


def _pull(unknown: Unknowns, item: Excitation, coefficients: Floats, free: Complexes) -> Complexes:
    """Return the forces (N,) of a coupling's stiffness towards the motion (N,) at which it is free of load."""
    found = np.zeros(free.size, dtype=complex)
    for one, value in zip(unknown.coefficients, coefficients, strict=True):
        if one.element == item.element and one.order == 0:
            for left, right in one.pairs:
                strain = sum(size * free[place] for place, size in right.items())
                for place, size in left.items():
                    found[place] += value * size * strain
    return found
