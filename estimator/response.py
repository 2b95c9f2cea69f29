"""Forward response of a train: the 1× phasors that given coefficients and excitations produce."""

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.condensation import CondensedTrain


def response(train: CondensedTrain, *, coefficients: Floats, excitations: Complexes) -> Complexes:
    """Steady-state 1× displacement phasors at the probes, (S, m) complex 0-to-peak [m].

    coefficients: (K,), or (S, K) where they follow the speed, in the order and SI units of `train.unknowns.coefficients`.
    excitations: (E,), or (S, E) where they differ from sample to sample, as `train.unknowns.excitations`: unbalances first.
    Source: thesis Eq. 3.23 with the sign of the gyroscopic term of rotation from +x to +y.
    """
    whole = np.empty((train.speed.size, len(train.output)), dtype=complex)
    for block in train.blocks():
        part = train.pick(block)
        force = part.force_of(excitations if excitations.ndim == 1 else excitations[block])
        stiffness = part.dynamic_stiffness(coefficients if coefficients.ndim == 1 else coefficients[block])
        whole[block] = np.linalg.solve(stiffness, force[..., None])[..., 0] @ train.output.T
    return whole
