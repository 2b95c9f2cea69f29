"""Coefficients that follow the speed through their values at some speeds, the knots: polynomials and piecewise lines."""

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Annotated, Literal, Self

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from pydantic import Field, model_validator

from estimator.arrays import Floats
from estimator.bearings.defaults import FormDefaults
from estimator.bearings.mixed_coefficient import MixedCoefficient
from estimator.bearings.model import CoefficientModel, ModelParameter
from estimator.bearings.terms import TERMS
from estimator.field_types import Part, Positive
from estimator.units import rpm_to_rad_per_s

KnotWeights = Callable[[Floats, Floats], Floats]
"""Function of knots (P,) and speeds (S,) [rad/s] that returns the weights (S, P) with which the values at the knots make the
one at each speed.
"""


def piecewise_weights(knots: Floats, speed: Floats) -> Floats:
    """Compute the weights of straight lines from knot to knot, level outside them.

    Args:
        knots: Knots (P,), ascending [rad/s].
        speed: Speeds (S,) [rad/s].

    Returns:
        Weights (S, P) [-].
    """
    return np.stack([np.interp(speed, knots, row) for row in np.eye(knots.size)], axis=1)


def polynomial_weights(knots: Floats, speed: Floats) -> Floats:
    """Compute the weights of the one polynomial through all knots: Lagrange's polynomials.

    Args:
        knots: Knots (P,), ascending [rad/s].
        speed: Speeds (S,) [rad/s].

    Returns:
        Weights (S, P) [-].
    """
    return np.stack(
        [np.prod([(speed - other) / (own - other) for other in knots if other != own], axis=0) for own in knots],
        axis=1,
    )


WEIGHTS: dict[str, KnotWeights] = {"piecewise": piecewise_weights, "polynomial": polynomial_weights}
"""Weights by form."""


class KnotModel(Struct, frozen=True, eq=False, dict=True):
    """One coefficient through its values at knots.

    Attributes:
        coefficient: The coefficient as a parameter.
        knots_rpm: Knots [r/min].
        weights: Function that returns the weights of the knots.
        constant: False.
    """

    coefficient: ModelParameter
    knots_rpm: tuple[float, ...]
    weights: KnotWeights
    constant: bool = False

    @property
    def coefficients(self) -> tuple[str, ...]:
        """Return the name of the coefficient."""
        return (self.coefficient.name,)

    @cached_property
    def parameters(self) -> tuple[ModelParameter, ...]:
        """Return its value at each knot as a parameter."""
        return tuple(
            replace(self.coefficient, name=f"{self.coefficient.name}@{knot:g}rpm", speed=rpm_to_rad_per_s(knot))
            for knot in self.knots_rpm
        )

    def at(self, speed: Floats) -> MixedCoefficient:
        """Return the coefficient at some speeds.

        Args:
            speed: Spin speeds (S,), without sign [rad/s].

        Returns:
            Its curves.
        """
        return MixedCoefficient(self.coefficient, self.weights(np.array(self.knots_rpm) * np.pi / 30.0, speed))

    def level(self, fitted: Floats) -> Floats:
        """Return the values at the knots of a coefficient that is the same at every speed.

        Args:
            fitted: Fitted number (1,) [-]; shape (C,) with C = 1.

        Returns:
            Fitted numbers (P,) [-], all the same.
        """
        return np.full(len(self.knots_rpm), fitted[0])


class SpeedDependence(FormDefaults, Part):
    """Dependence of an element's coefficients on the speed: through values at some speeds, which are identified.

    Two or more knots: `piecewise` runs straight from knot to knot and stays level outside them, `polynomial` is the one
    polynomial through all of them. Direct terms follow in their logarithm, so that they stay positive.
    """

    form: Literal["polynomial", "piecewise"] = Field(
        description="one polynomial through all knots, or straight lines from knot to knot"
    )
    knots_rpm: Annotated[tuple[Positive, ...], Field(min_length=2, max_length=12)] = Field(description="ascending [r/min]")
    coefficients: Annotated[tuple[str, ...], Field(max_length=len(TERMS), fail_fast=True)] | None = Field(
        default=None, description="which of them, by default all, such as [kxx, kyy]"
    )

    @model_validator(mode="after")
    def _ascending(self) -> Self:
        if any(high <= low for low, high in zip(self.knots_rpm, self.knots_rpm[1:], strict=False)):
            raise ValueError(f"knots_rpm must ascend, not {list(self.knots_rpm)}")
        return self

    def governs(self, term: str) -> bool:
        """Return whether a term follows the speed.

        Args:
            term: The term, such as `kxx`.

        Returns:
            Whether it does.
        """
        return self.coefficients is None or term in self.coefficients

    def parameter_count(self, terms: Sequence[str]) -> int:
        """Return the number of values at knots: one at each for each term.

        Args:
            terms: The terms.

        Returns:
            The number.
        """
        return len(self.knots_rpm) * len(terms)

    def models(self, coefficients: Sequence[ModelParameter]) -> Sequence[CoefficientModel]:
        """Return a model of each coefficient.

        Args:
            coefficients: The coefficients as parameters.

        Returns:
            The models.
        """
        return [KnotModel(one, self.knots_rpm, WEIGHTS[self.form]) for one in coefficients]
