"""Forward response of a train, and its exact derivatives by every unknown of the model."""

import numpy as np
from msgspec import Struct

from estimator.arrays import Complexes, Floats
from estimator.rotor.condensation import CondensedTrain, parts_of
from estimator.rotor.elimination import WhirlElimination


def response(train: CondensedTrain, *, coefficients: Floats, excitations: Complexes) -> Complexes:
    """Compute the steady-state 1× displacement phasors at the probes.

    Source: thesis Eq. 3.23 with the sign of the gyroscopic term of rotation from +x to +y.

    Args:
        train: The condensed train.
        coefficients: Coefficients (K,), or (S, K) where they follow the speed, in the order of `train.unknowns.coefficients`
            [SI].
        excitations: Excitations (E,), or (S, E) where they differ from sample to sample, in the order of
            `train.unknowns.excitations` [SI].

    Returns:
        Phasors (S, m), 0-to-peak [m].
    """
    whole = np.empty((train.speed.size, len(train.output)), dtype=complex)
    for block in train.blocks():
        part = train.pick(block)
        own = coefficients if coefficients.ndim == 1 else coefficients[block]
        force = part.force_of(excitations if excitations.ndim == 1 else excitations[block], own)
        stiffness = part.dynamic_stiffness(own)
        whole[block] = np.linalg.solve(stiffness, force[..., None])[..., 0] @ train.output.T
    return whole


def excitation_responses(train: CondensedTrain, *, coefficients: Floats) -> Complexes:
    """Compute the phasors per unit of each excitation, of which the response is a sum.

    Source: thesis Eq. 3.23, for one excitation at a time.

    Args:
        train: The condensed train.
        coefficients: Coefficients (K,), or (S, K) where they follow the speed [SI].

    Returns:
        Phasors (2E, S, m) per real and imaginary part of each excitation [m per SI unit].
    """
    whole = np.empty((2 * len(train.unknowns.excitations), train.speed.size, len(train.output)), dtype=complex)
    for block in train.blocks():
        part = train.pick(block)
        own = coefficients if coefficients.ndim == 1 else coefficients[block]
        whole[:, block] = np.moveaxis(_receptance(part, part.dynamic_stiffness(own)) @ part.forces(own), 2, 0)
    return whole


class Sensitivity(Struct, frozen=True, eq=False):
    """Phasors of m outputs at S speeds and their derivatives.

    Attributes:
        phasor: Phasors (S, m) [m].
        by_coefficient: Derivatives (K, S, m) by each coefficient's value at that very speed [m per SI unit].
        by_excitation: Derivatives (2E, S, m) by real and imaginary part of each excitation [m per SI unit].
        by_scale: Derivatives (F, S, m) by the logarithm of each scale factor [m].
    """

    phasor: Complexes
    by_coefficient: Complexes
    by_excitation: Complexes
    by_scale: Complexes

    @property
    def by_parameter(self) -> Complexes:
        """Return the derivatives (S, m, K + 2E) by coefficients, then by the parts of the excitations [m per SI unit]."""
        return np.moveaxis(np.concatenate([self.by_coefficient, self.by_excitation]), 0, -1)


def sensitivity(train: CondensedTrain, *, coefficients: Floats, excitations: Complexes) -> Sensitivity:
    """Compute the response and its derivatives.

    From Z q = F: ∂q/∂p = -Z⁻¹ (∂Z/∂p) q with ∂Z/∂p = (jω)ⁿ Σ a bᵀ, and q is linear in the excitations. A response to no
    excitation has no derivative by the coefficients. A coupling that runs out strains by what its ends move beyond the place
    where it is free of load.

    Source: own derivation: Z q = F of thesis Eq. 3.23, differentiated.

    Args:
        train: The condensed train.
        coefficients: Coefficients (K,) or (S, K) [SI].
        excitations: Excitations (E,) or (S, E) [SI].

    Returns:
        Phasors and derivatives.
    """
    stiffness = train.dynamic_stiffness(coefficients)
    receptance = _receptance(train, stiffness)
    displacement: Complexes = np.asarray(
        np.linalg.solve(stiffness, train.force_of(excitations, coefficients)[..., None])[..., 0], dtype=complex
    )
    rate = (1j * train.speed[:, None]) ** train.unknowns.order_of_terms[1]  # (S, T)
    strain = -(displacement @ train.right) * rate  # (S, T)
    free = train.free_strain
    if free is not None:
        strain = strain + (free @ parts_of(excitations)[..., None])[..., 0]
    by_term = np.moveaxis(receptance @ train.left, 2, 0) * strain.T[:, :, None]  # (T, S, m)
    scales = (
        [train.shafts.scale_force(one, displacement, excitations) for one in train.scale_factors]
        if isinstance(train.shafts, WhirlElimination)
        else []
    )
    return Sensitivity(
        phasor=displacement @ train.output.T,
        by_coefficient=_summed(by_term, train),
        by_excitation=np.moveaxis(receptance @ train.forces(coefficients), 2, 0),
        by_scale=np.array([(receptance @ force[..., None])[..., 0] for force in scales]).reshape(
            len(scales), *receptance.shape[:2]
        ),
    )


def _receptance(train: CondensedTrain, stiffness: Complexes) -> Complexes:
    """Return the phasors (S, m, n) per unit force at each retained degree of freedom [m/N]."""
    return np.asarray(np.linalg.solve(stiffness.swapaxes(1, 2), train.output.T).swapaxes(1, 2))


def _summed(by_term: Complexes, train: CondensedTrain) -> Complexes:
    """Sum the terms of each coefficient."""
    if len(by_term) == len(train.unknowns.coefficients):
        return by_term
    first = np.searchsorted(train.owner, np.arange(len(train.unknowns.coefficients)))
    return np.asarray(np.add.reduceat(by_term, first, axis=0))
