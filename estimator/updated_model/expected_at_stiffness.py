"""Expectations of data and prior about a train's other numbers where a coupling is of another stiffness than a fit found.

A fit ends with a covariance about its estimate. Its information is that of the prior, which is on the numbers themselves, and
that of the data, which see elevations of bearings by nothing but the forces of the films. At another stiffness the prior
expects the same elevations and the data the same forces, which ask for other elevations there: carried along in a straight
line, a load that the films tell well would be spread by the whole doubt about the stiffness. So the data's information is
taken in numbers in which each film's force stands for the elevations that it follows from, linear at the estimate, and the
numbers expected at a stiffness are sought by Gauss-Newton steps (own derivation; the Gaussian posterior about a point:
Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 3.4).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, TypeVar

import numpy as np

from estimator.arrays import Floats
from estimator.machine.parameter_description import describe
from estimator.symmetric_eigen import symmetric_eigen

TrainState = TypeVar("TrainState")
KNOWN = 1e-6
"""Part of the largest standard deviation, in units of each number's own, from which on a direction is uncertain at all [-]."""
TOLD = 1e-3
"""Least part of a direction's information that is the data's, for its estimate to have been pulled by data [-]."""
WEAKEST = 1e-6
"""Least part of the largest change of forces with elevations that counts [-]."""
MOST_STEPS = 8
SETTLED = 0.03
"""Step that need not be gone, in standard deviations [-]."""


@dataclass(frozen=True)
class Prediction:
    """Numbers that follow from the fitted ones.

    Attributes:
        value: Values (m,) [any unit].
        slope: Derivatives (m, P) of them by the fitted numbers [that unit].
    """

    value: Floats
    slope: Floats


@dataclass(frozen=True)
class FittedNumbers:
    """Knowledge of P numbers that a fit left.

    Attributes:
        names: Names of the P numbers; those of couplings are logarithms of stiffnesses.
        values: The estimate (n,), P numbers first [-].
        covariance: Covariance (P, P) of these [-].
        prior: Precision (P, P) of the prior that the covariance holds [-].
        pull: Half the derivative (P,) of the prior's cost at the estimate [-].
    """

    names: Sequence[str]
    values: Floats
    covariance: Floats
    prior: Floats
    pull: Floats

    @cached_property
    def stiffnesses(self) -> list[int]:
        """Return the places of the couplings' numbers."""
        return [place for place, name in enumerate(self.names) if describe(name).element_kind == "coupling"]

    @cached_property
    def elevations(self) -> list[int]:
        """Return the places of uncertain elevations."""
        return [k for k, name in enumerate(self.names) if ".elevation_" in name and self.covariance[k, k] > 0.0]

    @cached_property
    def factor(self) -> Floats:
        """Return a factor (P, r) of the covariance: the numbers are its product with r of unit variance [-].

        Source: standard result: eigenvectors times the roots of the eigenvalues.
        """
        size = np.sqrt(np.diag(self.covariance))
        unit = np.where(size > 0.0, size, 1.0)
        spread, axes = symmetric_eigen(self.covariance / np.outer(unit, unit))
        uncertain = spread > KNOWN**2 * max(float(spread.max(initial=0.0)), 1.0)
        return np.asarray(unit[:, None] * axes[:, uncertain] * np.sqrt(spread[uncertain]))

    def moved(self, away: Floats) -> Floats:
        """Return the numbers where those of unit variance are some way from the estimate.

        Args:
            away: The way (r,) [-].

        Returns:
            Numbers (n,) [-].
        """
        changed = self.values.copy()
        changed[: len(self.covariance)] += self.factor @ away
        return changed


@dataclass(frozen=True)
class Expected(Generic[TrainState]):
    """Expectation of a train at one stiffness of its couplings.

    Attributes:
        values: The numbers (n,), those of the fit first [-].
        state: TrainState of the train with them.
        covariance: Covariance (P, P) of the numbers at this stiffness [-].
    """

    values: Floats
    state: TrainState
    covariance: Floats


class ExpectedAtStiffness(Generic[TrainState]):
    """Expectations along directions of the couplings' stiffness."""

    def __init__(
        self,
        fitted: FittedNumbers,
        central: TrainState,
        *,
        reach: Callable[[Floats], TrainState | None],
        seen: Callable[[TrainState], Prediction],
    ) -> None:
        """Separate the information of the data from that of the prior (see the module).

        Args:
            fitted: What the fit left known.
            central: TrainState of the train at the estimate.
            reach: Function of all numbers that returns the state of the train; None where it has no equilibrium.
            seen: Function of a state that returns the forces that the data see.
        """
        self._fitted, self._reach, self._seen = fitted, reach, seen
        factor = fitted.factor
        part, axes = symmetric_eigen(factor.T @ fitted.prior @ factor)
        part = np.clip(part, 0.0, 1.0)  # a covariance that was widened may be wider than the prior
        self._prior, self._data = axes * part @ axes.T, axes * (1.0 - part) @ axes.T
        told = axes[:, 1.0 - part > TOLD]
        self._pull = told @ told.T @ (factor.T @ fitted.pull)
        self._central = seen(central)
        by_elevation = np.linalg.pinv(self._central.slope[:, fitted.elevations], rcond=WEAKEST)
        self._by_force = np.linalg.pinv(factor)[:, fitted.elevations] @ by_elevation

    def at(self, along: Floats, distance: float) -> Expected[TrainState] | None:
        """Return what is expected where a principal stiffness is some way from its estimate.

        Source: own derivation: Gauss-Newton steps of data and prior at one stiffness, in the summary above.

        Args:
            along: The direction (r,), of unit length, among the numbers of unit variance [-].
            distance: The way in standard deviations [-].

        Returns:
            What is expected; None where the train has no equilibrium on the way there, or nothing settles.
        """
        others = np.linalg.svd(along[None, :])[2][1:].T
        away = distance * along
        for _ in range(MOST_STEPS):
            values = self._fitted.moved(away)
            state = self._reach(values)
            if state is None:
                return None
            gradient, curvature = self._linearised(state, away)
            spread = np.linalg.inv(others.T @ curvature @ others)
            step = others @ (spread @ (others.T @ gradient))
            if np.abs(step).max(initial=0.0) < SETTLED:
                root = self._fitted.factor @ others
                return Expected(values, state, np.asarray(root @ spread @ root.T))
            away = away - step
        return None

    def _linearised(self, state: TrainState, away: Floats) -> tuple[Floats, Floats]:
        """Return half the derivative (r,) and the curvature (r, r) of what data and prior count against a place [-]."""
        seen, factor = self._seen(state), self._fitted.factor
        beyond = seen.value - self._central.value - self._central.slope @ (factor @ away)
        stands_for = away + self._by_force @ beyond
        slope = np.eye(away.size) + self._by_force @ ((seen.slope - self._central.slope) @ factor)
        gradient = slope.T @ (self._data @ stands_for - self._pull) + self._prior @ away + self._pull
        return np.asarray(gradient), np.asarray(slope.T @ self._data @ slope + self._prior)
