"""The updated model: a machine with the coefficients and unbalances that an identification found, and how sure they are."""

from dataclasses import dataclass

import numpy as np

from estimator.condensation import Complexes, Floats
from estimator.identification import Identification
from estimator.machine import Machine
from estimator.parameters import Unknowns, unknowns
from estimator.rotor import assemble_rotor


class NotDetermined(ValueError):
    """The identification leaves parameters open, so that there is no model to predict with."""


@dataclass(frozen=True)
class UpdatedModel:
    """A machine with K coefficients and P unbalances put in.

    coefficients: (K,) in SI and unbalances: (P,) complex [kg m], in the order of `unknowns`. covariance: (K + 2P, K + 2P)
    over the coefficients, direct terms as logarithms, then real and imaginary part of each unbalance, [SI² or 1].
    """

    machine: Machine
    coefficients: Floats
    unbalances: Complexes
    covariance: Floats

    def __post_init__(self) -> None:
        unknown = self.unknowns
        shapes = {
            "coefficients": (len(unknown.coefficients),),
            "unbalances": (len(unknown.unbalances),),
            "covariance": 2 * (len(unknown.coefficients) + 2 * len(unknown.unbalances),),
        }
        for name, shape in shapes.items():
            if np.shape(getattr(self, name)) != shape:
                raise ValueError(f"{name} has shape {np.shape(getattr(self, name))}; '{self.machine.id}' needs {shape}")

    @property
    def unknowns(self) -> Unknowns:
        """What the coefficients and unbalances are called and where they act."""
        return unknowns(self.machine, assemble_rotor(self.machine))


def updated_model(machine: Machine, identification: Identification) -> UpdatedModel:
    """The model that an identification of the machine leads to.

    Raises NotDetermined, which names the parameters that have no value, ValueError for an identification of another machine.
    """
    open_ones = [one.name for one in identification.estimates if one.value is None]
    if open_ones:
        raise NotDetermined(f"the data leave open, so that nothing can be predicted: {', '.join(open_ones)}")
    unknown = unknowns(machine, assemble_rotor(machine))
    names = tuple(one.name for one in identification.estimates)
    if names != unknown.names:
        raise ValueError(f"the identification is of other parameters than those of machine '{machine.id}'")
    values = [complex(one.value or 0.0, one.imaginary or 0.0) for one in identification.estimates]
    count = len(unknown.coefficients)
    return UpdatedModel(
        machine=machine,
        coefficients=np.real(values[:count]),
        unbalances=np.array(values[count:]),
        covariance=identification.covariance,
    )
