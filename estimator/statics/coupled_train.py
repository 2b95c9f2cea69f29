"""The train at rest with couplings and pedestals of any stiffness, without condensing it anew.

A coupling's stiffness k adds k a aᵀ to that of the shafts. If q stiffnesses change by Δ, the stiffness S and the weight w that
are condensed to the journals change by q terms only: S = S₀ + L Δ (1 + F Δ)⁻¹ Lᵀ, w = w₀ - L Δ (1 + F Δ)⁻¹ s. L holds the
strains of the q stiffnesses per unit motion of each journal, s their strains under the weight with all journals held, F the
train's compliance at them (Woodbury's identity: Hager, SIAM Rev. 31 (1989) 221, doi:10.1137/1031049; applied here). Pedestals
follow as in `train_statics`. Only direct terms vary: cross-coupled ones act in the statics as the document gives them.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from estimator.arrays import Floats
from estimator.bearings.model import ModelParameter
from estimator.bearings.registry import CONSTANT
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from estimator.rotor.assembly import Rotor, assemble_rotor
from estimator.rotor.coefficient_models import prior_parameter
from estimator.rotor.identity_cache import cached_by_identity
from estimator.rotor.parameters import Coefficient, dense, unknowns
from estimator.statics.train_statics import (
    StaticSlopes,
    TrainStatics,
    aligned_places,
    free_motion,
    lateral_places,
    static_stiffness,
    train_load,
)


@dataclass(frozen=True)
class _Joints:
    """The q stiffnesses of couplings that are identified, at the train's N degrees of freedom.

    Attributes:
        value: Their expected values (q,) [N/m, N m/rad].
        owner: Number of the parameter that each is (q,).
        motion: Motion of all degrees of freedom per unit of the force of each (N, q) [m/N, 1/N m].
        strained: What a unit of each journal's motion strains them by (q, 2n) [-, 1/m].
        at_rest: What they are strained by at rest with all journals held (q,) [m, rad].
        by_load: The same per unit of each static load (q, 2m) [m/N, rad/N].
        compliance: What a unit of each one's force strains each by (q, q) [m/N, ...].
    """

    value: Floats
    owner: "np.ndarray[tuple[int, ...], np.dtype[np.intp]]"
    motion: Floats
    strained: Floats
    at_rest: Floats
    by_load: Floats
    compliance: Floats

    def held(self, factors: Floats) -> tuple[Floats, Floats]:
        """Return the changes Δ (q,) of the stiffnesses and (1 + F Δ)⁻¹ (q, q) at factors (C,) on the parameters."""
        change = self.value * (factors[self.owner] - 1.0)
        return change, np.asarray(np.linalg.inv(np.eye(change.size) + self.compliance * change), dtype=float)


@dataclass(frozen=True)
class CoupledTrain:
    """A train at rest whose couplings and pedestals may be of other stiffness than expected.

    Attributes:
        bearings: Ids of the n bearings.
        parameters: The C stiffnesses that are identified; each moves the stiffnesses tied to it.
        moved: Motion of all N degrees of freedom per unit of each journal's x and y (N, 2n) [-, 1/m]; pedestals stay.
        stiffness: Stiffness (2n, 2n) of shafts and couplings as expected [N/m].
        weight: Weight (2n,) carried there [N].
        by_load: Change of the weight per unit of each static load (2n, 2m) [-].
        aligned: Places (n, 2) of the bearings' centres where no coupling carries anything [m].
        compliance: Expected compliance (2n,) of the pedestal under each journal along x and along y, 0 without one [m/N].
        under: Number of the parameter that its stiffness is (2n,); -1 for none.
    """

    bearings: tuple[str, ...]
    parameters: tuple[ModelParameter, ...]
    moved: Floats
    stiffness: Floats
    weight: Floats
    by_load: Floats
    aligned: Floats
    compliance: Floats
    under: "np.ndarray[tuple[int, ...], np.dtype[np.intp]]"
    _joints: _Joints

    @cached_property
    def _resting(self) -> Floats:
        """Return the forces (2n,) of the films at rest when aligned, whatever the couplings' stiffness [N]."""
        return self.stiffness @ self.aligned.reshape(-1) - self.weight

    @cached_property
    def _of_joint(self) -> Floats:
        """Return by how much each coupling's stiffness follows each parameter's logarithm, at factors of one (q, C)."""
        each = np.zeros((self._joints.value.size, len(self.parameters)))
        each[np.arange(self._joints.value.size), self._joints.owner] = self._joints.value
        return each

    def at(self, factors: Floats) -> TrainStatics:
        """Compute the train at rest, with derivatives by the logarithms of the factors.

        Source: Woodbury's identity, Hager, SIAM Rev. 31 (1989) 221, doi:10.1137/1031049.

        Args:
            factors: Factors (C,) on the expected stiffnesses, positive [-].

        Returns:
            The train at rest.
        """
        joints = self._joints
        change, inner = joints.held(factors)
        strained, resting, loaded = inner @ joints.strained, inner @ joints.at_rest, inner @ joints.by_load
        left = joints.strained.T * change
        stiffness = self.stiffness + left @ strained
        weight, by_load = self.weight - left @ resting, self.by_load - left @ loaded
        along = self._of_joint * factors
        # dS = L' dΔ L'ᵀ with L'ᵀ = (1 + F Δ)⁻¹ Lᵀ, and so the others: F is symmetric.
        turned = strained.T[:, :, None] * along
        slopes = StaticSlopes(
            np.einsum("iqc,qj->cij", turned, strained),
            -np.einsum("iqc,q->ci", turned, resting),
            -np.einsum("iqc,qm->cim", turned, loaded),
        )
        return self._on_pedestals(factors, stiffness, weight, by_load, slopes)

    def _on_pedestals(
        self, factors: Floats, stiffness: Floats, weight: Floats, by_load: Floats, slopes: StaticSlopes
    ) -> TrainStatics:
        if not self.compliance.any():
            return TrainStatics(self.bearings, (stiffness + stiffness.T) / 2, weight, self.aligned, by_load, slopes)
        compliance = self.compliances(factors)
        given = np.linalg.inv(np.eye(weight.size) + stiffness * compliance)
        soft = given @ stiffness
        weight = given @ (weight - stiffness @ (compliance * self._resting))
        by_load = given @ by_load
        # As couplings move: d(1 + S D)⁻¹ S = (1 + S D)⁻¹ dS (1 - D S'), and what that does to weight and loads.
        kept = slopes.stiffness * compliance
        by_stiffness = given @ (slopes.stiffness - kept @ soft)
        by_weight = (slopes.weight - kept @ (self._resting + weight)) @ given.T
        by_loads = given @ (slopes.by_load - kept @ by_load)
        # As pedestals move: dS' = -S' dD S', with dD = -D for a logarithm.
        for place in np.flatnonzero(self.under >= 0).tolist():
            own, column = self.under[place], soft[:, place] * compliance[place]
            by_stiffness[own] += np.outer(column, soft[place])
            by_weight[own] += column * (self._resting + weight)[place]
            by_loads[own] += np.outer(column, by_load[place])
        slopes = StaticSlopes(by_stiffness, by_weight, by_loads)
        return TrainStatics(self.bearings, (soft + soft.T) / 2, weight, self.aligned, by_load, slopes)

    def compliances(self, factors: Floats) -> Floats:
        """Return by how much pedestals give way along x and along y of each bearing, 0 without one.

        Args:
            factors: Factors (C,) on the expected stiffnesses [-].

        Returns:
            Compliances (2n,) [m/N].
        """
        own = np.append(factors, 1.0)[self.under]
        return np.asarray(self.compliance / own)

    def motion(self, rows: Floats, factors: Floats) -> tuple[Floats, Floats]:
        """Derive how some points of the train move with its journals, at rest.

        Args:
            rows: What of all degrees of freedom a point's motion is (m, N) [-].
            factors: Factors (C,) on the expected stiffnesses [-].

        Returns:
            Motions (m, 2n) per unit of each journal's x and y, and their derivatives (C, m, 2n) by the logarithms of the
            factors; pedestals do not move [-].
        """
        joints = self._joints
        change, inner = joints.held(factors)
        strained, moved = inner @ joints.strained, rows @ joints.motion
        # d(Δ (1 + F Δ)⁻¹) = (1 + Δ F)⁻¹ dΔ (1 + F Δ)⁻¹.
        turned = (moved @ inner.T)[:, :, None] * (self._of_joint * factors)
        return rows @ self.moved - (moved * change) @ strained, -np.einsum("mqc,qj->cmj", turned, strained)


@cached_by_identity
def coupled_train(machine: Machine) -> CoupledTrain:
    """Condense a train under its weight and static loads to its journals (Guyan, AIAA J. 3 (1965) 380, exact in statics).

    Args:
        machine: The machine.

    Returns:
        The train, whose couplings and pedestals may take any stiffness.

    Raises:
        UnsupportedShaft: Something would fall although all journals are held.
    """
    rotor = assemble_rotor(machine)
    held = np.concatenate([lateral_places(rotor, bearing.shaft, bearing.station) for bearing in machine.bearings])
    load, units = train_load(machine, rotor), _unit_loads(machine, rotor)
    given = static_stiffness(machine, couplings=[one.id for one in machine.couplings])
    stiffness = (given + given.T) / 2
    identified = _identified(unknowns(machine, rotor).coefficients)
    leaders = list(dict.fromkeys(leader.name for _, leader in identified))
    parameters = {leader.name: prior_parameter(leader) for _, leader in identified}
    joints = [(one, leaders.index(leader.name)) for one, leader in identified if describe(one.name).element_kind == "coupling"]
    acting = dense([one.left for one, _ in joints], rotor.size)
    deflected, moved = free_motion(stiffness, np.column_stack([load, units, acting]), held)
    sag, by_unit, motion = np.split(deflected, [1, 1 + units.shape[1]], axis=1)
    condensed = stiffness[held] @ moved
    compliance, under = _under(machine, identified, leaders)
    return CoupledTrain(
        bearings=tuple(one.id for one in machine.bearings),
        parameters=tuple(parameters[name] for name in leaders),
        moved=moved,
        stiffness=(condensed + condensed.T) / 2,
        weight=moved.T @ load,
        by_load=moved.T @ units,
        aligned=aligned_places(machine, rotor, load, held),
        compliance=compliance,
        under=under,
        _joints=_Joints(
            value=np.array([one.expected for one, _ in joints]),
            owner=np.array([owner for _, owner in joints], dtype=np.intp),
            motion=motion,
            strained=acting.T @ moved,
            at_rest=acting.T @ sag[:, 0],
            by_load=acting.T @ by_unit,
            compliance=acting.T @ motion,
        ),
    )


def train_statics(machine: Machine) -> TrainStatics:
    """Condense a train under its weight and static loads to its journals, couplings and pedestals as stiff as expected.

    Args:
        machine: The machine.

    Returns:
        The train at rest.

    Raises:
        UnsupportedShaft: Something would fall although all journals are held.
    """
    train = coupled_train(machine)
    return train.at(np.ones(len(train.parameters)))


def _identified(coefficients: tuple[Coefficient, ...]) -> list[tuple[Coefficient, Coefficient]]:
    """Return direct stiffnesses of couplings and pedestals that are identified as constants, each with the one it follows."""
    by_name = {one.name: one for one in coefficients}
    pairs = [(one, one if one.tied_to is None else by_name[one.tied_to]) for one in coefficients]
    return [
        (one, leader)
        for one, leader in pairs
        if describe(one.name).element_kind in ("coupling", "pedestal")
        and one.direct
        and one.order == 0
        and not leader.fixed
        and leader.form is CONSTANT
    ]


def _under(
    machine: Machine, identified: list[tuple[Coefficient, Coefficient]], leaders: list[str]
) -> tuple[Floats, "np.ndarray[tuple[int, ...], np.dtype[np.intp]]"]:
    """Return the compliance of the pedestal under each journal along x and y (2n,) and the parameter that each is (2n,)."""
    expected = {one.name: (one.expected, leaders.index(leader.name)) for one, leader in identified}
    compliance, under = np.zeros((len(machine.bearings), 2)), np.full((len(machine.bearings), 2), -1, dtype=np.intp)
    for number, bearing in enumerate(machine.bearings):
        pedestal = machine.pedestal_of(bearing.id)
        if pedestal is None:
            continue
        for axis, (term, said) in enumerate((("kxx", pedestal.kxx), ("kyy", pedestal.kyy))):
            value, own = expected.get(f"pedestal.{pedestal.id}.{term}", (said, -1))
            compliance[number, axis], under[number, axis] = 1.0 / value, own
    return compliance.reshape(-1), under.reshape(-1)


def _unit_loads(machine: Machine, rotor: Rotor) -> Floats:
    """Return a unit of each static load along x and along y (N, 2m)."""
    places = [lateral_places(rotor, one.shaft, one.station) for one in machine.static_loads]
    return np.eye(rotor.size)[:, np.concatenate([*places, np.zeros(0, dtype=np.intp)])]
