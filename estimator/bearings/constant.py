"""Constant coefficients, the same at every speed: each is its own parameter."""

from collections.abc import Sequence

import numpy as np
from msgspec import Struct

from estimator.arrays import Floats
from estimator.bearings.defaults import FormDefaults
from estimator.bearings.mixed_coefficient import MixedCoefficient
from estimator.bearings.model import CoefficientModel, ModelParameter
from estimator.bearings.terms import TERMS


class ConstantModel(Struct, frozen=True):
    """One coefficient that is the same at every speed.

    Attributes:
        coefficient: The coefficient as a parameter.
        constant: True.
    """

    coefficient: ModelParameter
    constant: bool = True

    @property
    def coefficients(self) -> tuple[str, ...]:
        """Return the name of the coefficient."""
        return (self.coefficient.name,)

    @property
    def parameters(self) -> tuple[ModelParameter, ...]:
        """Return the coefficient itself."""
        return (self.coefficient,)

    def at(self, speed: Floats) -> MixedCoefficient:
        """Return the coefficient at some speeds.

        Args:
            speed: Spin speeds (S,), without sign [rad/s].

        Returns:
            Its curves.
        """
        return MixedCoefficient(self.coefficient, np.ones((speed.size, 1)))

    def level(self, fitted: Floats) -> Floats:
        """Return the parameter of a constant coefficient: the same number.

        Args:
            fitted: Fitted number (1,) [-]; shape (C,) with C = 1.

        Returns:
            Fitted number (1,) [-].
        """
        return fitted


class Constant(FormDefaults):
    """Form of an element whose document states no dependence on the speed."""

    form: str = "constant"
    coefficients: tuple[str, ...] | None = None

    def governs(self, term: str) -> bool:
        """Return whether a term is constant: all are.

        Args:
            term: The term, such as `kxx`.

        Returns:
            Whether it is a term.
        """
        return term in TERMS

    def parameter_count(self, terms: Sequence[str]) -> int:
        """Return the number of parameters that give some terms: one for each.

        Args:
            terms: The terms.

        Returns:
            The number.
        """
        return len(terms)

    def models(self, coefficients: Sequence[ModelParameter]) -> Sequence[CoefficientModel]:
        """Return a model of each coefficient.

        Args:
            coefficients: The coefficients as parameters.

        Returns:
            The models.
        """
        return [ConstantModel(one) for one in coefficients]
