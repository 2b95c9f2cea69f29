"""Interface between bearing models and the fit: coefficients over the spin speed, from a model's own parameters.

A *form* is the part of the machine document that chooses the model of an element, with the model's data as its fields. It
makes *models*: each gives some of the element's coefficients from parameters that the fit determines. At given speeds a model
becomes *curves*, which evaluate quickly. The fit knows nothing else of a bearing. `estimator.bearings.registry` lists the
forms.
"""

import math
from collections.abc import Iterable, Sequence
from typing import ClassVar, Protocol, runtime_checkable

import numpy as np
from msgspec import Struct

from estimator.arrays import Complexes, Floats


class ModelParameter(Struct, frozen=True):
    """One real number that a fit determines, and what is believed of it before any measurement.

    Attributes:
        name: Name, such as `bearing.B1.kxx` or `bearing.B1.kxx@1500rpm`.
        quantity: Physical quantity.
        unit: SI unit.
        positive: Whether it is positive by nature, so that the logarithm of value over `expected` is fitted; else the value in
            units of `scale`.
        expected: Best guess [unit].
        scale: Magnitude expected of it, positive [unit].
        spread: Prior standard deviation of the fitted number [-].
        coefficient: Name of the coefficient whose value it is, everywhere or at a knot; None for any other parameter.
        speed: Speed at which it is the coefficient's value [rad/s]; None where it is everywhere, and for any other parameter.
        nuisance: Whether it is fitted only so that the others get their due uncertainty, and not reported.
        between_runs: Part of `spread` by which it varies from run to run of one machine, as a standard deviation [-].
    """

    name: str
    quantity: str
    unit: str
    positive: bool
    expected: float
    scale: float
    spread: float
    coefficient: str | None = None
    speed: float | None = None
    nuisance: bool = False
    between_runs: float = 0.0

    @property
    def centre(self) -> float:
        """Return the mean of the prior on the fitted number [-]."""
        return 0.0 if self.positive else self.expected / self.scale

    @property
    def origin(self) -> float:
        """Return the value where the fitted number is zero [unit], of a positive parameter its logarithm."""
        return math.log(self.expected) if self.positive else 0.0

    @property
    def step(self) -> float:
        """Return the change of the value with the fitted number [unit], of a positive parameter of its logarithm [-]."""
        return 1.0 if self.positive else self.scale

    def value(self, fitted: Floats) -> Floats:
        """Convert fitted numbers to values.

        Args:
            fitted: Fitted numbers (...), of any shape [-].

        Returns:
            Values (...) [unit].
        """
        return np.asarray(self.expected * np.exp(fitted) if self.positive else self.scale * fitted)

    def slope(self, fitted: Floats) -> Floats:
        """Compute the derivatives of the values by the fitted numbers.

        Args:
            fitted: Fitted numbers (...), of any shape [-].

        Returns:
            Derivatives (...) [unit].
        """
        return self.value(fitted) if self.positive else np.full(fitted.shape, self.scale)

    def fitted(self, value: float) -> float:
        """Convert a value to the fitted number.

        Args:
            value: The value [unit].

        Returns:
            The fitted number [-].

        Raises:
            ValueError: The parameter is positive by nature and the value is not.
        """
        if self.positive and value <= 0.0:
            raise ValueError(f"{self.name} is {value:g}: it must be positive")
        return math.log(value / self.expected) if self.positive else value / self.scale


class OwnParameter(Struct, frozen=True):
    """A kind of parameter that a form's models have beside coefficients, such as a clearance.

    Attributes:
        name: Last part of the parameters' names.
        quantity: Physical quantity.
        unit: SI unit.
        positive: Whether it is positive by nature, as of `ModelParameter`.
        term: The element's direct term that it scales, such as `kxx`; None for one that scales none.
    """

    name: str
    quantity: str
    unit: str
    positive: bool
    term: str | None = None


class WholeTrain(Struct, frozen=True):
    """Declaration of a form of which one model gives the coefficients of all bearings of a train that have it, together.

    Attributes:
        model: Function that makes this model of a machine, as "module:function". It is imported where a train needs it, since
            such a model may take long to import, and may stand in any room that `estimator.fit.problem` may import.
        of: What the coefficients follow from, such as "films".
        reason: Why all bearings of the train need this form; None where bearings of other forms may stand beside them, which
            are supports of a stiffness of their own.
        part: Field of the bearing that a document must give with it, such as "film"; None where it needs none.
        contents: What stands in this field.
    """

    model: str
    of: str
    reason: str | None = None
    part: str | None = None
    contents: str = ""


class CoefficientCurves(Protocol):
    """C coefficients at S speeds as functions of a model's P parameters."""

    def values(self, fitted: Floats) -> Floats:
        """Compute the coefficients.

        Args:
            fitted: Fitted numbers (P,) [-].

        Returns:
            Coefficients (S, C) [SI].
        """

    def derivatives(self, fitted: Floats, block: slice) -> Floats:
        """Compute the derivatives of the coefficients by the fitted numbers, at some of the speeds.

        Args:
            fitted: Fitted numbers (P,) [-].
            block: The s speeds.

        Returns:
            Derivatives (s, C, P) [SI].
        """


@runtime_checkable
class ChainedCurves(CoefficientCurves, Protocol):
    """Curves of many parameters that change few coefficients each: they apply their derivatives without building them all."""

    def chained(self, fitted: Floats, block: slice, by_coefficient: Complexes) -> Complexes:
        """Compute the derivatives of outputs by the fitted numbers from those by the coefficients, at some of the speeds.

        Args:
            fitted: Fitted numbers (P,) [-].
            block: The s speeds.
            by_coefficient: Derivatives (C, s, m) of m outputs by the coefficients [any unit].

        Returns:
            Derivatives (P, s, m) [that unit].
        """


class CoefficientModel(Protocol):
    """Model that gives C coefficients of an element from P parameters of its own."""

    @property
    def coefficients(self) -> tuple[str, ...]:
        """Return the names of the C coefficients, such as `bearing.B1.kxx`."""

    @property
    def parameters(self) -> tuple[ModelParameter, ...]:
        """Return the P parameters."""

    @property
    def constant(self) -> bool:
        """Return whether the one coefficient is the one parameter at every speed; the fit evaluates all such ones together."""

    def at(self, speed: Floats) -> CoefficientCurves:
        """Return the curves at some speeds.

        Args:
            speed: Spin speeds (S,), without sign [rad/s].

        Returns:
            The curves.
        """

    def level(self, fitted: Floats) -> Floats:
        """Solve for the parameters whose coefficients are constant over speed.

        Args:
            fitted: Fitted numbers (C,) of the constant coefficients [-].

        Returns:
            Fitted numbers (P,) of the parameters [-].

        Raises:
            ValueError: The model's coefficients cannot have these values at every speed.
        """


@runtime_checkable
class ReadingModel(CoefficientModel, Protocol):
    """Model whose coefficients depend on parameters of other models too, as loads on films do on a coupling's stiffness.

    Its curves take the fitted numbers of these parameters before those of its own.
    """

    @property
    def read(self) -> tuple[str, ...]:
        """Return the names of these parameters of other models."""


class BearingForm(Protocol):
    """Part of a machine document that chooses the model of an element's coefficients."""

    own_parameters: ClassVar[tuple[OwnParameter, ...]]
    whole_train: ClassVar[WholeTrain | None]
    load_field: ClassVar[str | None]

    @property
    def form(self) -> str:
        """Return the name of the form in a document, such as "journal"."""

    @property
    def coefficients(self) -> tuple[str, ...] | None:
        """Return the terms of the element that the document names as the model's, such as `kxx`; None where it names none."""

    def governs(self, term: str) -> bool:
        """Return whether a term of the element is the model's; if not, it is constant.

        Args:
            term: The term, such as `kxx`.

        Returns:
            Whether it is.
        """

    def parameter_count(self, terms: Sequence[str]) -> int:
        """Return the number of parameters that give some terms of the element.

        Args:
            terms: The terms, all of which are the model's.

        Returns:
            The number.
        """

    def nominal(self, term: str, rpm: float) -> float | None:
        """Return the value that the form itself gives a term before any measurement.

        Args:
            term: The term, such as `kxx`.
            rpm: Speed [r/min].

        Returns:
            The value [SI]; None where the element's own nominal value holds, at every speed.
        """

    def implausible(self) -> Iterable[tuple[str, str]]:
        """Find what only a slip of the unit explains, in a bearing or pedestal: refused where documents enter.

        Returns:
            Pairs of a field of the form, and a sentence about it.
        """

    def warnings(self, lowest_rpm: float, highest_rpm: float) -> Iterable[tuple[str, str]]:
        """Find what is possible but probably a mistake.

        Args:
            lowest_rpm: Lowest speed of the machine [r/min].
            highest_rpm: Its highest speed [r/min].

        Returns:
            Pairs of a field of the form, and a sentence about it.
        """

    def models(self, coefficients: Sequence[ModelParameter]) -> Sequence[CoefficientModel]:
        """Return the models that give some coefficients of one element.

        Args:
            coefficients: The coefficients, each as if it were a constant parameter.

        Returns:
            The models.
        """
