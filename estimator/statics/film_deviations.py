"""Deviations of real films from their model, by some per cent: Gaussian processes over speed.

Kennedy and O'Hagan, J. R. Stat. Soc. B 63 (2001) 425, doi:10.1111/1467-9868.00294. Their numbers are fitted with the others
and not reported. The films of one run deviate by more than those of the machine: by what varies from run to run, besides.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np

from estimator.arrays import Complexes, Floats
from estimator.bearings.deviation_shapes import DeviationShapes
from estimator.bearings.journal import DEVIATING, JournalForm
from estimator.bearings.model import ModelParameter
from estimator.bearings.terms import LATERAL

Outputs = TypeVar("Outputs", Floats, Complexes)
TERMS = tuple(term.name for term in LATERAL)
"""Terms of a bearing in the order of a film's matrices: stiffness by rows, then damping."""
LEVELS = ("all.stiffness_deviation", "all.damping_deviation")
"""Deviations that the direct terms of all films share at every speed: a solver, or an oil, is off for all of them alike."""
SHARED = 0.4
"""Part of a deviation's variance that is shared so [-]."""
DIRECT_DAMPING = ("cxx", "cyy")
"""Terms that vary from run to run by enough to count."""
LEFT_OUT = 0.001
"""Part of a deviation's variance that its left-out shapes may hold [-]: less than noise of 1 % shows."""


@dataclass(frozen=True)
class FilmDeviations:
    """Deviations of the 8n coefficients of n films, of D numbers in all.

    Attributes:
        names: Ids of the bearings (n,).
        forms: Form of each bearing, which states the size of its deviations.
        slowest: Lowest speed [rad/s].
        fastest: Highest speed [rad/s].
        run_damping: Standard deviation of each direct damping from run to run, relative [-].
    """

    names: tuple[str, ...]
    forms: tuple[JournalForm, ...]
    slowest: float
    fastest: float
    run_damping: float = 0.0

    @cached_property
    def parameters(self) -> tuple[ModelParameter, ...]:
        """Return the D numbers: those of each term's shapes, film by film, then the levels that all films share.

        They count what the document says that films deviate by. In one run direct dampings deviate by their scatter besides;
        stiffness varies by too little to count, and cross-coupled damping by a part of itself, which is small.
        """
        deviating = [(name, form) for name, form in zip(self.names, self.forms, strict=True) if form.discrepancy > 0.0]
        found = [
            _number(f"{name}.{term}_deviation{shape}", self._between_runs(form) if term in DIRECT_DAMPING else 0.0)
            for name, form in deviating
            for term in DEVIATING
            for shape in range(self._shapes.count)
        ]
        return (*found, *(_number(name) for name in LEVELS if deviating))

    def _between_runs(self, form: JournalForm) -> float:
        """Return the scatter of a film's direct damping between runs, over what it deviates by in all runs of a machine."""
        return float(self.run_damping / own_size(form.discrepancy))

    @cached_property
    def _shapes(self) -> DeviationShapes:
        return DeviationShapes(self.slowest, self.fastest, left_out=LEFT_OUT)

    def at(self, speed: Floats) -> "DeviationCurves":
        """Return the deviations at some speeds.

        Args:
            speed: Spin speeds (S,) between the lowest and the highest [rad/s].

        Returns:
            The deviations there.
        """
        return DeviationCurves(np.array([one.discrepancy for one in self.forms]), self._shapes.at(speed))


class DeviationCurves:
    """Relative deviations of the 8n coefficients of n films at S speeds, of D numbers.

    Attributes:
        count: Number of numbers D.
    """

    def __init__(self, size: Floats, shapes: Floats) -> None:
        """Prepare the deviations.

        Args:
            size: Size of each film's deviations (n,) [-].
            shapes: Shapes of a term's deviation (S, B) [-].
        """
        self._size = size
        self._deviating = np.flatnonzero(size > 0.0)
        self._shapes = shapes
        self._levels = size * np.sqrt(SHARED)
        self._own_size = size[self._deviating] * np.sqrt(1.0 - SHARED)
        own = self._deviating.size * len(DEVIATING) * shapes.shape[1]
        self.count = own + len(LEVELS) if own else 0

    @cached_property
    def per_number(self) -> Floats:
        """Return the relative deviations (S, 8n, D) per unit of each number [-]."""
        each = np.eye(8 * self._size.size)[:, None, :] * np.ones((len(self._shapes), 1))
        return np.ascontiguousarray(np.moveaxis(self.chained(each, slice(None)), 0, 2))

    def relative(self, numbers: Floats) -> Floats:
        """Compute the relative deviations.

        Args:
            numbers: The numbers (D,) [-].

        Returns:
            Relative deviations (S, 8n) [-].
        """
        found = np.zeros((self._size.size, len(TERMS), len(self._shapes)))
        if self.count:
            own, levels = np.split(numbers, [self.count - len(LEVELS)])
            shaped = own.reshape(self._deviating.size, len(DEVIATING), -1) @ self._shapes.T
            found[self._deviating] = self._own_size[:, None, None] * shaped[:, _OF_TERM]
            for order, level in enumerate(levels):
                found[:, _DIRECT[order]] += (self._levels * level)[:, None, None]
        return np.asarray(found.reshape(-1, len(self._shapes)).T)

    def chained(self, by_relative: Outputs, block: slice) -> Outputs:
        """Compute derivatives by the numbers from those by the relative deviations, at some of the speeds.

        Args:
            by_relative: Derivatives (8n, s, m) of m outputs by the relative deviation of each coefficient there [any unit].
            block: The s speeds.

        Returns:
            Derivatives (D, s, m) [that unit].
        """
        if not self._deviating.size:
            return by_relative[:0]
        films = by_relative.reshape(self._size.size, len(TERMS), *by_relative.shape[1:])
        own = films[self._deviating][:, _FIRST]
        own[:, _SHARED_CROSS] += films[self._deviating][:, TERMS.index("cyx")]
        own *= self._own_size[:, None, None, None]
        shaped = own[:, :, None] * self._shapes[block].T[:, :, None]
        levels = [np.tensordot(self._levels, films[:, _DIRECT[order]].sum(axis=1), 1) for order in range(len(LEVELS))]
        return np.concatenate([shaped.reshape(-1, *by_relative.shape[1:]), np.stack(levels)])


def own_size(discrepancy: float) -> float:
    """Return the size of what each film's terms deviate by for themselves, beside what all films share.

    Args:
        discrepancy: Size of the film's deviations [-].

    Returns:
        That part [-].
    """
    return discrepancy * float(np.sqrt(1.0 - SHARED))


def _number(name: str, between_runs: float = 0.0) -> ModelParameter:
    spread = float(np.hypot(1.0, between_runs))
    return ModelParameter(
        f"films.{name}", "scale factor", "1", False, 0.0, 1.0, spread, nuisance=True, between_runs=between_runs
    )


_FIRST = [TERMS.index(name) for name in DEVIATING]
_OF_TERM = [DEVIATING.index("cxy" if name == "cyx" else name) for name in TERMS]
_SHARED_CROSS = DEVIATING.index("cxy")
_DIRECT = [[place for place, one in enumerate(LATERAL) if one.direct and one.order == order] for order in range(len(LEVELS))]
