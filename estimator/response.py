"""Forward response of a train: the 1× phasors that given coefficients and unbalances produce."""

import numpy as np

from estimator.condensation import Complexes, CondensedTrain, Floats


def response(train: CondensedTrain, *, coefficients: Floats, unbalances: Complexes) -> Complexes:
    """Steady-state 1× displacement phasors at the probes, (S, m) complex 0-to-peak [m].

    coefficients: (K,) in the order and SI units of `train.unknowns.coefficients`; unbalances: (P,) complex [kg m].
    Source: thesis Eq. 3.23 with the sign of the gyroscopic term of rotation from +x to +y.
    """
    parts = np.stack([unbalances.real, unbalances.imag], axis=-1).reshape(-1)
    force = train.force @ parts
    displacement = np.linalg.solve(train.dynamic_stiffness(coefficients), force[..., None])[..., 0]
    return np.asarray(displacement @ train.output.T)
