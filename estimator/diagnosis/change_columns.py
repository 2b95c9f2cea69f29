"""Columns of changes: how the quantities of a diagnosis change together when an element does.

A diagnosis has N quantities. Direct terms and scale factors count as logarithms, everything else in SI.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Literal

import numpy as np

from estimator.arrays import Floats
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from estimator.rotor.parameters import Coefficient, Unknowns

RISE = 0.15
"""Expected common change of an element's stiffnesses, of logarithms [-]."""
COEFFICIENT_SPREAD = 0.05
"""Standard deviation by which a coefficient of a changed element differs from the others' common change [-]."""
DAMPING_SPREAD = 0.15
"""Standard deviation by which a damping of a changed element differs from the others' common change [-]."""
RUN_OUT = 0.3
"""Expected change of a run-out, each part, in units of the channel's median amplitude [-]."""
LARGE_RUN_OUT = 10.0
"""Expected size of a large one, such as a scratch under the probe, over the usual [-]."""

TermKind = Literal["stiffness", "damping"]
"""Kind of the terms that change together."""
TERM_ORDER: Mapping[TermKind, int] = {"stiffness": 0, "damping": 1}
"""Power of jω with which each kind of terms acts."""


class ChangeColumns:
    """Builder of the columns of changes for one machine and the quantities of its diagnosis."""

    def __init__(
        self, machine: Machine, unknowns: Unknowns, names: Sequence[str], *, typical: Floats, amplitude: Mapping[str, float]
    ) -> None:
        """Take the values of the healthy machine.

        names: (N,) of the quantities; typical: (N,) their values; amplitude: median by channel [m].
        """
        self.machine = machine
        self.unknowns = unknowns
        self.names = list(names)
        self._typical = typical
        self._amplitude = amplitude
        self._coefficients = {one.name: one for one in unknowns.coefficients}

    def knows(self, name: str) -> bool:
        """Return whether a complex quantity is among the diagnosis's.

        Args:
            name: Name of the quantity.

        Returns:
            Whether it is.
        """
        return f"{name}.real" in self.names

    def changes(self, element: str) -> bool:
        """Return whether an element has any coefficient that the document neither fixes nor ties to another element's.

        Args:
            element: Name of the element.

        Returns:
            Whether it has.
        """
        return next(self._of(element), None) is not None

    def growth(self, element: str) -> Floats:
        """Return the change of all coefficients of an element when they grow in proportion.

        Args:
            element: Name of the element.

        Returns:
            Change (N,) [SI, logarithms of direct terms].
        """
        found = np.zeros(len(self.names))
        for place, one in self._of(element):
            found[place] = 1.0 if one.direct else self._typical[place]
        return found

    def single_coefficients(self, element: str) -> list[Floats]:
        """Return a column for the change of each coefficient of an element by itself.

        Args:
            element: Name of the element.

        Returns:
            Columns (N,), one per coefficient [SI, logarithms of direct terms].
        """
        columns = []
        for place, one in self._of(element):
            size = DAMPING_SPREAD if one.order == TERM_ORDER["damping"] else COEFFICIENT_SPREAD
            columns.append(size * (1.0 if one.direct else one.scale) * np.eye(len(self.names))[place])
        return columns

    def direct_terms(self, element: str, term: TermKind) -> Floats:
        """Return ones at the direct terms of an element that are stiffnesses, or dampings.

        Args:
            element: Name of the element.
            term: Kind of the terms.

        Returns:
            Column (N,) [-].
        """
        found = np.zeros(len(self.names))
        found[[place for place, one in self._of(element) if one.direct and one.order == TERM_ORDER[term]]] = 1.0
        return found

    def element_variants(self, element: str) -> tuple[Floats, ...]:
        """Return the ways in which one element changes: as a whole, by stiffness and damping, by each coefficient.

        Args:
            element: Name of the element.

        Returns:
            Columns (N, r) of each way [SI, logarithms of direct terms].
        """
        whole = [RISE * self.growth(element)]
        terms: tuple[TermKind, ...] = ("stiffness", "damping")
        parts = [RISE * part for term in terms if (part := self.direct_terms(element, term)).any()]
        freest = [*parts, *self.single_coefficients(element)]
        return tuple(np.column_stack(columns) for columns in (whole, parts, freest) if columns)

    def complex_pair(self, name: str, size: float) -> Floats:
        """Return columns that change the real and the imaginary part of a complex quantity.

        Args:
            name: Name of the quantity.
            size: Size of the change [SI].

        Returns:
            Columns (N, 2) [SI].
        """
        columns = np.zeros((len(self.names), 2))
        for column, part in enumerate(("real", "imaginary")):
            columns[self.names.index(f"{name}.{part}"), column] = size
        return columns

    def run_outs(self, probes: Sequence[str]) -> tuple[Floats, Floats]:
        """Return columns that change both parts of the run-outs of p probes, by the usual size and by a large one.

        Args:
            probes: Ids of the probes.

        Returns:
            Columns (N, 2 p) of each size [m].
        """
        pairs = [self.complex_pair(f"probe.{one}.run_out", RUN_OUT * self._amplitude[one]) for one in probes]
        usual = np.concatenate(pairs, axis=1)
        return usual, LARGE_RUN_OUT * usual

    def magnitude(self, name: str) -> float:
        """Return the magnitude of a complex quantity while the machine is healthy.

        Args:
            name: Name of the quantity.

        Returns:
            Magnitude [SI].
        """
        return float(np.hypot(*(self._typical[self.names.index(f"{name}.{part}")] for part in ("real", "imaginary"))))

    def _of(self, element: str) -> Iterator[tuple[int, Coefficient]]:
        for place, name in enumerate(self.names):
            one = self._coefficients.get(describe(name).coefficient)
            if one is not None and one.element == element:
                yield place, one
