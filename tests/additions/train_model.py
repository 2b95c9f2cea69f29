"""Adds the form "shared_rubber": one model of all bearings of a train."""

from functools import partial

from tests.additions.addition import Addition
from tests.additions.bearing_form import add_form

MODULE = '''"""Coefficients of bearings on rubber of one batch: the stiffness of each, one loss factor of all."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from estimator.arrays import Floats
from estimator.bearings.defaults import FormDefaults, NeverLevel
from estimator.bearings.model import CoefficientModel, ModelParameter, OwnParameter, WholeTrain
from estimator.bearings.terms import TERMS
from estimator.field_types import Part

LOSS = 0.2


@dataclass(frozen=True)
class SharedRubberCurves:
    """All coefficients at some speeds: k, then c = loss * k / speed, of each bearing."""

    speed: Floats
    parameters: tuple[ModelParameter, ...]

    def values(self, fitted: Floats) -> Floats:
        columns = []
        for one, own in zip(self.parameters, fitted, strict=True):
            k, c = np.full(self.speed.size, one.value(own)), LOSS * one.value(own) / self.speed
            columns += [k, 0.0 * k, 0.0 * k, k, c, 0.0 * k, 0.0 * k, c]
        return np.stack(columns, axis=1)

    def derivatives(self, fitted: Floats, block: slice) -> Floats:
        found = np.zeros((self.speed[block].size, 8 * fitted.size, fitted.size))
        values = self.values(fitted)[block]
        for one in range(fitted.size):
            found[:, 8 * one : 8 * one + 8, one] = values[:, 8 * one : 8 * one + 8]
        return found


@dataclass(frozen=True)
class SharedRubberModel(NeverLevel):
    """Rubber of all bearings."""

    bearings: tuple[str, ...]
    constant: bool = False
    law = "rubber"

    @property
    def coefficients(self) -> tuple[str, ...]:
        terms = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")
        return tuple(f"bearing.{one}.{term}" for one in self.bearings for term in terms)

    @property
    def parameters(self) -> tuple[ModelParameter, ...]:
        named = (f"bearing.{one}.rubber" for one in self.bearings)
        return tuple(ModelParameter(name, "stiffness", "N/m", True, 2e6, 2e6, 1.0) for name in named)

    def at(self, speed: Floats) -> SharedRubberCurves:
        return SharedRubberCurves(speed, self.parameters)


def shared_rubber(machine: Any) -> SharedRubberModel:
    return SharedRubberModel(tuple(one.id for one in machine.bearings))


class SharedRubber(FormDefaults, Part):
    """Coefficients of rubber of one batch."""

    own_parameters: ClassVar[tuple[OwnParameter, ...]] = (OwnParameter("rubber", "stiffness", "N/m", positive=True),)
    whole_train: ClassVar[WholeTrain | None] = WholeTrain(
        "estimator.bearings.shared_rubber:shared_rubber", of="rubber", reason="its loss is that of one batch"
    )
    form: Literal["shared_rubber"]
    coefficients: tuple[str, ...] | None = None

    def governs(self, term: str) -> bool:
        return term in TERMS

    def parameter_count(self, terms: Sequence[str]) -> int:
        return 1

    def models(self, coefficients: Sequence[ModelParameter]) -> Sequence[CoefficientModel]:
        return ()
'''

CHECK = """
import numpy as np
import pytest
from estimator.fit.identify import identify
from estimator.fit.problem.train_models import train_models
from estimator.machine.document import DocumentError, parse_machine
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import condense
from estimator.rotor.parameter_names import parameter_units
from estimator.rotor.response import response
from tests.plant import document
said = document()
for one in said["bearings"]:
    one["speed_dependence"] = {"form": "shared_rubber"}
machine = parse_machine(said)
train = condense(machine, speed=2 * np.pi * np.linspace(8.0, 45.0, 120), direction=np.ones(120))
(found,) = [one for one in train_models(train) if getattr(one.model, "law", "") == "rubber"]
truth = [2.2e6, 1.8e6, 2.5e6, 1.5e6]
values = np.tile([one.expected for one in train.unknowns.coefficients], (120, 1))
values[:, found.coefficients] = found.model.at(train.speed).values(np.log(np.array(truth) / 2e6))
unbalances = np.array([one.nominal for one in train.unknowns.excitations])
clean = response(train, coefficients=values, excitations=unbalances)
noise = np.random.default_rng(1).standard_normal((2, *clean.shape))
phasor = clean + 1e-7 * (noise[0] + 1j * noise[1])
fit = identify(machine, Measurement.of(speed=train.speed, phasor=phasor))
rubber = [one for one in fit.estimates if one.name.endswith(".rubber")]
assert [one.name for one in rubber] == [f"bearing.B{n}.rubber" for n in (1, 2, 3, 4)]
assert all(abs(one.value - value) < 4 * one.standard_error < 2 * value for one, value in zip(rubber, truth)), rubber
assert parameter_units(machine)["bearing.B3.rubber"] == "N/m"
del said["bearings"][2]["speed_dependence"]
with pytest.raises(DocumentError, match="needs the form 'shared_rubber', as the other bearings: its loss"):
    parse_machine(said)
assert '"SharedRubber"' in OPENAPI
"""


TRAIN_MODEL = Addition(
    "model of all bearings",
    most_files=2,
    add=partial(add_form, module="shared_rubber", form="SharedRubber", text=MODULE),
    check=CHECK,
)
