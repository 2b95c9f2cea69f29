"""What turns with the shaft as forces on all degrees of freedom of a train, at changing speed too."""

import numpy as np

from estimator.condensation import Complexes, Floats
from estimator.parameters import Excitation
from estimator.rotor import Rotor, plane_columns


def synchronous_force(
    rotor: Rotor,
    excitations: tuple[Excitation, ...],
    *,
    values: Complexes,
    speed: Floats,
    direction: float,
    acceleration: Floats | None = None,
) -> Complexes:
    """Complex forces F (S, N) of the force Re(F e^{jφ}) with φ the angle turned, for the excitations' values (E,) [SI].

    speed: (S,) [rad/s], positive. direction: +1 or -1. acceleration: (S,) of the speed [rad/s²], by default none. A mass m at
    the radius e that turns with φ(t) pulls with m e (ω² - jα) e^{jφ}: its own acceleration, the tangential part included.
    """
    square = speed**2 if acceleration is None else speed**2 - 1j * acceleration
    x_plane, y_plane = plane_columns(rotor.size)
    whole = np.zeros((speed.size, rotor.size), dtype=complex)
    elastic = sum((part.stiffness for part in rotor.materials.values()), np.zeros_like(rotor.discs.stiffness))
    for item, value in zip(excitations, values, strict=True):
        turned = value if direction > 0 else np.conj(value)
        if item.acting is not None:
            for place, size in item.acting.items():
                whole[:, place] += size * turned
        if item.shape is not None:
            shape = elastic @ item.shape if item.stiffened else item.shape
            along = (x_plane - 1j * direction * y_plane) @ shape * turned
            whole += (square if item.speed_power == 2 else np.ones(speed.size))[:, None] * along
    return whole
