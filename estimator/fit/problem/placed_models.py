"""Models of coefficients that follow the speed, with their parameters among the coordinates of a fit."""

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.bearings.mixed_coefficient import MixedCoefficient
from estimator.bearings.model import ChainedCurves, CoefficientCurves, CoefficientModel
from estimator.fit.problem.knot_coefficients import gathered


class PlacedModel(Struct, frozen=True, dict=True):
    """A model whose coefficients follow the speed, with its P parameters among the coordinates.

    Attributes:
        model: The model.
        coefficients: Indices of its c coefficients among the K.
        columns: Index of each among the model's own coefficients.
        first: Index of its first coordinate.
        curves: Its curves at the train's speeds.
        read: Coordinates of other models' parameters that it depends on as well.
    """

    model: CoefficientModel
    coefficients: tuple[int, ...]
    columns: tuple[int, ...]
    first: int
    curves: CoefficientCurves
    read: tuple[int, ...] = ()

    @cached_property
    def _shorter(self) -> ChainedCurves | None:
        """Return the curves where they know a shorter way than all derivatives, and all their coefficients count."""
        whole = self.columns == tuple(range(len(self.model.coefficients)))
        return self.curves if whole and isinstance(self.curves, ChainedCurves) else None

    @cached_property
    def places(self) -> range:
        """Return the coordinates of its own parameters."""
        return range(self.first, self.first + len(self.model.parameters))

    @cached_property
    def numbers(self) -> NDArray[np.intp]:
        """Return the coordinates (P,) that its curves depend on: first those of other models that it reads, then its own."""
        return np.array([*self.read, *self.places], dtype=np.intp)

    def own(self, theta: Floats) -> Floats:
        """Return the numbers that its curves take among all coordinates.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            Fitted numbers (P,) [-].
        """
        return theta[self.numbers]

    def values(self, theta: Floats) -> Floats:
        """Compute the coefficients.

        Args:
            theta: Fit coordinates θ (n,) [-].

        Returns:
            Coefficients (S, c) [SI].
        """
        return self.curves.values(self.own(theta))[:, self.columns]

    def derivatives(self, theta: Floats, block: slice) -> Floats:
        """Compute the derivatives of the coefficients by the coordinates, at some of the speeds.

        Args:
            theta: Fit coordinates θ (n,) [-].
            block: The s speeds.

        Returns:
            Derivatives (s, c, P) [SI].
        """
        return self.curves.derivatives(self.own(theta), block)[:, self.columns]

    def chained(self, theta: Floats, block: slice, by_coefficient: Complexes) -> Complexes:
        """Compute the derivatives of outputs by the coordinates from those by the coefficients, at some of the speeds.

        Args:
            theta: Fit coordinates θ (n,) [-].
            block: The s speeds.
            by_coefficient: Derivatives (c, s, m) of m outputs by the coefficients [any unit].

        Returns:
            Derivatives (P, s, m) [that unit].
        """
        if self._shorter is not None:
            return self._shorter.chained(self.own(theta), block, by_coefficient)
        along = self.derivatives(theta, block).swapaxes(1, 2) @ by_coefficient.swapaxes(0, 1)
        return np.asarray(along.swapaxes(0, 1))


class FollowingCoefficients:
    """Coefficients that follow the speed; those that are given by values at the same knots are evaluated together."""

    def __init__(self, models: Sequence[PlacedModel]) -> None:
        """Prepare the coefficients.

        Args:
            models: The models.
        """
        pairs = ((one, one.curves) for one in models)
        self._knots = gathered(
            [(one.coefficients[0], one.places, own) for one, own in pairs if isinstance(own, MixedCoefficient)]
        )
        self._others = [one for one in models if not isinstance(one.curves, MixedCoefficient)]

    def among(self, constant: Floats, theta: Floats) -> Floats:
        """Compute all coefficients over speed.

        Args:
            constant: Coefficients (K,), of those that follow the speed any values [SI].
            theta: Fit coordinates θ (n,) [-].

        Returns:
            Coefficients (S, K) [SI].
        """
        found: list[tuple[Sequence[int] | NDArray[np.intp], Floats]] = [
            *((one.coefficients, one.values(theta)) for one in self._knots),
            *((one.coefficients, one.values(theta)) for one in self._others),
        ]
        whole = np.repeat(constant[None, :], len(found[0][1]), axis=0)
        for coefficients, values in found:
            whole[:, coefficients] = values
        return whole

    def add_derivatives(self, whole: Complexes, theta: Floats, block: slice, by_coefficient: Complexes) -> None:
        """Add the derivatives of outputs by the coordinates to those of all, at some of the speeds.

        Args:
            whole: Derivatives (n, s, m) of m outputs by all coordinates, which are added to [any unit].
            theta: Fit coordinates θ (n,) [-].
            block: The s speeds.
            by_coefficient: Derivatives (K, s, m) of the outputs by all coefficients [that unit per SI].
        """
        for knots in self._knots:
            knots.add_derivatives(whole, theta, block, by_coefficient)
        for one in self._others:
            found = one.chained(theta, block, by_coefficient[list(one.coefficients)])
            whole[list(one.read)] += found[: len(one.read)]
            whole[one.places.start : one.places.stop] += found[len(one.read) :]  # a slice, which nothing copies
