"""Adds the form of bearing "softening": coefficients that fall with speed."""

from functools import partial

from tests.additions.addition import Addition
from tests.additions.bearing_form import add_form

MODULE = '''"""Coefficients of a bearing whose rubber softens with speed (derived here)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from estimator.arrays import Floats
from estimator.bearings.defaults import FormDefaults, NeverLevel
from estimator.bearings.model import CoefficientModel, ModelParameter
from estimator.bearings.terms import TERMS
from estimator.field_types import Part, Positive


@dataclass(frozen=True)
class SofteningCurves:
    """A coefficient at some speeds."""

    coefficient: ModelParameter
    factor: Floats

    def values(self, fitted: Floats) -> Floats:
        return self.factor[:, None] * self.coefficient.value(fitted)

    def derivatives(self, fitted: Floats, block: slice) -> Floats:
        return (self.factor[block, None] * self.coefficient.slope(fitted))[..., None]


@dataclass(frozen=True)
class SofteningModel(NeverLevel):
    """A coefficient over 1 + (speed / halving)²."""

    coefficient: ModelParameter
    halving: float
    constant: bool = False
    law = "rubber that softens"

    @property
    def coefficients(self) -> tuple[str, ...]:
        return (self.coefficient.name,)

    @property
    def parameters(self) -> tuple[ModelParameter, ...]:
        return (self.coefficient,)

    def at(self, speed: Floats) -> SofteningCurves:
        return SofteningCurves(self.coefficient, 1.0 / (1.0 + (speed / self.halving) ** 2))


class Softening(FormDefaults, Part):
    """Coefficients that fall to one half at a speed."""

    form: Literal["softening"]
    halving: Positive
    coefficients: tuple[str, ...] | None = None

    def governs(self, term: str) -> bool:
        return term in TERMS

    def parameter_count(self, terms: Sequence[str]) -> int:
        return len(terms)

    def models(self, coefficients: Sequence[ModelParameter]) -> Sequence[CoefficientModel]:
        return [SofteningModel(one, self.halving) for one in coefficients]
'''

CHECK = """
import numpy as np
from estimator.fit.problem.train_models import train_models
from estimator.machine.document import parse_machine
from estimator.rotor.condensation import condense
from estimator.rotor.parameter_names import parameter_units
from tests.plant import document
said = document()
said["bearings"][0]["speed_dependence"] = {"form": "softening", "halving": 300.0}
machine = parse_machine(said)
models = train_models(condense(machine, speed=np.ones(1), direction=np.ones(1)))
(found,) = [one.model for one in models if one.model.coefficients == ("bearing.B1.kxx",)]
assert np.allclose(found.at(np.array([0.0, 300.0])).values(np.zeros(1))[:, 0] / 2e6, [1.0, 0.5])
assert parameter_units(machine)["bearing.B1.kxx"] == "N/m"
assert '"Softening"' in OPENAPI
"""


BEARING_MODEL = Addition(
    "bearing model", most_files=2, add=partial(add_form, module="softening", form="Softening", text=MODULE), check=CHECK
)
