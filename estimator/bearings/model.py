"""The seam between bearing models and the fit: coefficients over the spin speed, from a model's own parameters.

A *form* is what the machine document says of an element, with the model's data as its fields. It makes *models*: each gives
some of the element's coefficients from parameters that the fit determines. At given speeds a model becomes *curves*, which
evaluate quickly. The fit knows nothing else of a bearing. `estimator.bearings.registry` lists the forms.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from estimator.arrays import Floats


@dataclass(frozen=True)
class ModelParameter:
    """One real number that a fit determines, and what is believed of it before any measurement.

    name: such as `bearing.B1.kxx` or `bearing.B1.kxx@1500rpm`. quantity, unit: what it is, and its SI unit. positive: by
    nature, so that the logarithm of value over `expected` is fitted; else the value in units of `scale`. expected: best guess
    [SI]. scale: the magnitude expected of it [SI], positive. spread: prior standard deviation of the fitted number.
    coefficient: name of the coefficient whose value it is, everywhere or at a knot; None of what is none.
    """

    name: str
    quantity: str
    unit: str
    positive: bool
    expected: float
    scale: float
    spread: float
    coefficient: str | None = None

    @property
    def centre(self) -> float:
        """Mean of the prior on the fitted number."""
        return 0.0 if self.positive else self.expected / self.scale

    @property
    def origin(self) -> float:
        """Value [SI] where the fitted number is zero; of a positive one its logarithm."""
        return math.log(self.expected) if self.positive else 0.0

    @property
    def step(self) -> float:
        """How far the value [SI], of a positive one its logarithm, changes with the fitted number."""
        return 1.0 if self.positive else self.scale

    def value(self, fitted: Floats) -> Floats:
        """Return the values [SI] that belong to fitted numbers."""
        return np.asarray(self.expected * np.exp(fitted) if self.positive else self.scale * fitted)

    def slope(self, fitted: Floats) -> Floats:
        """Return the derivatives of the values [SI] by the fitted numbers."""
        return self.value(fitted) if self.positive else np.full(fitted.shape, self.scale)

    def fitted(self, value: float) -> float:
        """Return the fitted number of a value [SI]. Raises ValueError where a positive one is not."""
        if self.positive and value <= 0.0:
            raise ValueError(f"{self.name} is {value:g}: it must be positive")
        return math.log(value / self.expected) if self.positive else value / self.scale


@dataclass(frozen=True)
class OwnParameter:
    """A kind of parameter that a form's models have beside coefficients, such as a clearance.

    name: last part of the parameters' names. quantity, unit, positive: as of `ModelParameter`.
    """

    name: str
    quantity: str
    unit: str
    positive: bool


class CoefficientCurves(Protocol):
    """C coefficients at S speeds as functions of a model's P parameters, which come as fitted numbers (P,)."""

    def values(self, fitted: Floats) -> Floats:
        """Return the coefficients (S, C) [SI]."""

    def derivatives(self, fitted: Floats, block: slice) -> Floats:
        """Return their derivatives (s, C, P) by the fitted numbers, at some of the speeds."""


class CoefficientModel(Protocol):
    """Gives C coefficients of an element from P parameters of its own."""

    @property
    def coefficients(self) -> tuple[str, ...]:
        """Names of the C coefficients, such as `bearing.B1.kxx`."""

    @property
    def parameters(self) -> tuple[ModelParameter, ...]:
        """The P parameters."""

    @property
    def constant(self) -> bool:
        """Whether the one coefficient is the one parameter at every speed; the fit evaluates all such ones together."""

    def at(self, speed: Floats) -> CoefficientCurves:
        """Return the curves at spin speeds (S,) [rad/s, without sign]."""

    def level(self, fitted: Floats) -> Floats:
        """Return the parameters (P,) whose coefficients have, at every speed, the values that belong to fitted numbers (C,).

        Raises ValueError where the model has none.
        """


class BearingForm(Protocol):
    """What a machine document says of how an element's coefficients follow from a model."""

    own_parameters: ClassVar[tuple[OwnParameter, ...]]

    @property
    def coefficients(self) -> tuple[str, ...] | None:
        """Terms of the element that the document names as the model's, such as `kxx`; None where it names none."""

    def governs(self, term: str) -> bool:
        """Return whether a term of the element, such as `kxx`, is the model's; if not, it is constant."""

    def parameter_count(self, terms: Sequence[str]) -> int:
        """Return the number of parameters that give these terms of the element, all of which are the model's."""

    def models(self, coefficients: Sequence[ModelParameter]) -> Sequence[CoefficientModel]:
        """Return the models that give these coefficients of one element; each comes as if it were a constant parameter."""
