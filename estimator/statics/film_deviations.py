"""Deviations of real films from their model, by some per cent: Gaussian processes over speed.

Kennedy and O'Hagan, J. R. Stat. Soc. B 63 (2001) 425, doi:10.1111/1467-9868.00294. Their numbers are fitted with the others
and told to nobody.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from estimator.arrays import Floats
from estimator.bearings.deviation_shapes import DeviationShapes
from estimator.bearings.journal import DEVIATING, JournalForm
from estimator.bearings.model import ModelParameter
from estimator.bearings.terms import LATERAL

TERMS = tuple(term.name for term in LATERAL)
"""Terms of a bearing in the order of a film's matrices: stiffness by rows, then damping."""
LEVELS = ("all.stiffness_deviation", "all.damping_deviation")
"""Deviations that the direct terms of all films share at every speed: a solver, or an oil, is off for all of them alike."""
SHARED = 0.4
"""Part of a deviation's variance that is shared so [-]."""
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
    """

    names: tuple[str, ...]
    forms: tuple[JournalForm, ...]
    slowest: float
    fastest: float

    @cached_property
    def parameters(self) -> tuple[ModelParameter, ...]:
        """Return the D numbers: those of each term's shapes, film by film, then the levels that all films share."""
        deviating = [name for name, form in zip(self.names, self.forms, strict=True) if form.discrepancy > 0.0]
        names = [
            f"{name}.{term}_deviation{shape}"
            for name in deviating
            for term in DEVIATING
            for shape in range(self._shapes.count)
        ]
        names += LEVELS if deviating else ()
        return tuple(
            ModelParameter(f"films.{name}", "scale factor", "1", False, 0.0, 1.0, 1.0, nuisance=True) for name in names
        )

    @cached_property
    def _shapes(self) -> DeviationShapes:
        return DeviationShapes(self.slowest, self.fastest, left_out=LEFT_OUT)

    def per_number(self, speed: Floats) -> Floats:
        """Compute the relative deviations per unit of each number.

        Args:
            speed: Spin speeds (S,) between the lowest and the highest [rad/s].

        Returns:
            Relative deviations (S, 8n, D) [-].
        """
        shapes, forms = self._shapes.at(speed), self.forms
        count = shapes.shape[1]
        columns = [np.zeros((speed.size, 8 * len(forms), 0))]
        for number, form in enumerate(forms):
            if form.discrepancy == 0.0:
                continue
            part = np.zeros((speed.size, 8 * len(forms), count * len(DEVIATING)))
            for term, name in enumerate(TERMS):
                first = count * DEVIATING.index("cxy" if name == "cyx" else name)
                part[:, 8 * number + term, first : first + count] = form.discrepancy * np.sqrt(1.0 - SHARED) * shapes
            columns.append(part)
        if len(columns) > 1:
            columns.append(np.broadcast_to(_levels(forms), (speed.size, 8 * len(forms), len(LEVELS))))
        return np.concatenate(columns, axis=2)


def _levels(forms: Sequence[JournalForm]) -> Floats:
    """Return the relative deviations (8n, 2) per unit of each level."""
    levels = np.zeros((8 * len(forms), len(LEVELS)))
    for number, form in enumerate(forms):
        for term, one in enumerate(LATERAL):
            if one.direct:
                levels[8 * number + term, one.order] = form.discrepancy * np.sqrt(SHARED)
    return levels
