"""A train condensed to its journals and pedestals at the speeds of its run-downs.

What stands between them does not change from run to run: of many run-downs of one machine only the films have to be put in.
"""

import numpy as np

from tests.film_plant.arrays import Complexes, Floats
from tests.film_plant.assembly import Matrices
from tests.film_plant.response import at_probes, film_blocks


class CondensedTrain:
    """Response of a train to what turns, with any films, at given speeds.

    Args:
        matrices: The train without its films.
        speed: Speeds of the run-downs (S,) [rad/s].
    """

    def __init__(self, matrices: Matrices, speed: Floats) -> None:
        self._matrices = matrices
        self._speed = speed
        stands = matrices.pedestals[matrices.pedestals >= 0]
        self._kept = np.concatenate([matrices.journals.ravel(), stands])
        size = self._kept.size
        inner = np.setdiff1d(np.arange(len(matrices.mass)), self._kept)
        order = np.concatenate([self._kept, inner])
        self._dynamic = np.empty((speed.size, size, size), dtype=complex)
        self._force = np.empty((speed.size, size), dtype=complex)
        for k, w in enumerate(speed):
            turning = matrices.damping + w * matrices.gyroscopic
            dynamic = (matrices.stiffness - w**2 * matrices.mass + 1j * w * turning)[np.ix_(order, order)]
            force = (w**2 * matrices.unbalance + matrices.turning)[order]
            through = np.linalg.solve(dynamic[size:, size:], np.column_stack([dynamic[size:, :size], force[size:]]))
            self._dynamic[k] = dynamic[:size, :size] - dynamic[:size, size:] @ through[:, :-1]
            self._force[k] = force[:size] - dynamic[:size, size:] @ through[:, -1]

    def is_of(self, matrices: Matrices) -> bool:
        """Tell whether these are the matrices of this train."""
        own = vars(self._matrices)
        return all(np.array_equal(value, own[name]) for name, value in vars(matrices).items())

    def phasors(self, *, stiffness: Floats, damping: Floats) -> Complexes:
        """Phasors (S, 2n) [m] at the bearings, relative to the pedestals, with films' coefficients (S, n, 2, 2)."""
        dynamic = self._dynamic.copy()
        films = stiffness + 1j * self._speed[:, None, None, None] * damping
        place = np.zeros(len(self._matrices.mass), dtype=int)
        place[self._kept] = np.arange(self._kept.size)
        for number, rows, columns, sign in film_blocks(self._matrices):
            row, column = np.ix_(place[rows], place[columns])
            dynamic[:, row, column] += sign * films[:, number]
        moved = np.zeros((self._speed.size, len(self._matrices.mass)), dtype=complex)
        moved[:, self._kept] = np.linalg.solve(dynamic, self._force[..., None])[..., 0]
        return at_probes(self._matrices, moved)
