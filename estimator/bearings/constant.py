"""Coefficients that are the same at every speed: each is its own parameter."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from estimator.arrays import Floats
from estimator.bearings.mixed_coefficient import MixedCoefficient
from estimator.bearings.model import CoefficientModel, ModelParameter, OwnParameter
from estimator.bearings.terms import TERMS


@dataclass(frozen=True)
class ConstantModel:
    """One coefficient that is the same at every speed."""

    coefficient: ModelParameter
    constant: bool = True

    @property
    def coefficients(self) -> tuple[str, ...]:
        """Name of the coefficient."""
        return (self.coefficient.name,)

    @property
    def parameters(self) -> tuple[ModelParameter, ...]:
        """The coefficient itself."""
        return (self.coefficient,)

    def at(self, speed: Floats) -> MixedCoefficient:
        """Return the coefficient at speeds (S,) [rad/s]."""
        return MixedCoefficient(self.coefficient, np.ones((speed.size, 1)))

    def level(self, fitted: Floats) -> Floats:
        """Return the parameter (1,) of a fitted number (1,): the same."""
        return fitted


class Constant:
    """The form of an element that says nothing of the speed."""

    own_parameters: ClassVar[tuple[OwnParameter, ...]] = ()
    coefficients: tuple[str, ...] | None = None

    def governs(self, term: str) -> bool:
        """Return whether a term is constant: all are."""
        return term in TERMS

    def parameter_count(self, terms: Sequence[str]) -> int:
        """Return one for each term."""
        return len(terms)

    def models(self, coefficients: Sequence[ModelParameter]) -> Sequence[CoefficientModel]:
        """Return a model of each coefficient."""
        return [ConstantModel(one) for one in coefficients]
