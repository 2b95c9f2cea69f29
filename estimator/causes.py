"""What can have happened to a machine, each as the changes that it makes: the hypotheses of a diagnosis.

The signs of misalignment are the thesis's (§5.7-5.8): direct and cross-coupled coefficients of the coupling and of the
bearings beside it grow together. A bearing or a coupling that changes alone is no misalignment; an unbalance moves no
coefficient; an error of a channel moves all that this channel is seen by, in proportions that the fit itself can tell.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from estimator.condensation import Floats
from estimator.machine import Machine
from estimator.misalignment import neighbouring_bearings
from estimator.parameters import Coefficient, Unknowns

Kind = Literal["misalignment", "coupling", "bearing", "unbalance", "bow", "run_out", "sensor"]

RISE = 0.15
"""Size expected of the common change of an element's stiffnesses, of logarithms."""
UNEVEN = 0.04
"""By how much one element of a misaligned train may rise more than another."""
APART = 0.05
"""By how much each coefficient of a changed element may differ from the others' common change …"""
DAMPING_APART = 0.15
"""… and each damping."""
UNBALANCE = 0.5
"""Change expected of an unbalance, in units of the machine's median one."""
GAIN = 0.15
"""Change expected of a gain, each part."""
RUN_OUT = 0.3
"""Change expected of a run-out, each part, in units of the channel's median amplitude."""


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """One thing that can have happened.

    element: such as `coupling.C1`, `bearing.B2`, `disc.D1`, `shaft.motor`, `probe.B1L`. variants: each (N, r) changes that it
    makes, of the size expected of them, from simple to free. rising: functionals (q, N) of the change that must be positive.
    elements: all whose coefficients it moves.
    """

    kind: Kind
    element: str
    variants: tuple[Floats, ...]
    rising: Floats
    elements: frozenset[str] = frozenset()


def hypotheses(
    machine: Machine, unknowns: Unknowns, names: Sequence[str], *, typical: Floats, amplitude: Mapping[str, float]
) -> tuple[Hypothesis, ...]:
    """Everything that a diagnosis of this machine chooses from.

    typical: (N,) the quantities that `names` lists while the machine is healthy. amplitude: of each channel then [m].
    """
    return tuple(_HypothesisBuilder(machine, unknowns, names, typical, amplitude).all())


class _HypothesisBuilder:
    def __init__(
        self, machine: Machine, unknowns: Unknowns, names: Sequence[str], typical: Floats, amplitude: Mapping[str, float]
    ) -> None:
        self.machine = machine
        self.unknowns = unknowns
        self.names = list(names)
        self.typical = typical
        self.amplitude = amplitude
        self.coefficients = {one.name: one for one in unknowns.coefficients}

    def all(self) -> Iterator[Hypothesis]:
        for coupling in self.machine.couplings:
            neighbours = [f"bearing.{bearing}" for bearing in neighbouring_bearings(self.machine, coupling)]
            own = f"coupling.{coupling.id}"
            beside = [element for element in neighbours if self._direct(element, "stiffness").any()]
            if beside and self._direct(own, "stiffness").any():
                yield self._misalignment(own, beside)
            yield from self._alone("coupling", own)
        for part in self.machine.bearings:
            yield from self._alone("bearing", f"bearing.{part.id}")
        for seal in self.machine.seals:
            yield from self._alone("bearing", f"seal.{seal.id}")
        planes = [one for one in self.unknowns.unbalances if f"{one.name}.real" in self.names]
        median = float(np.median([self._size(one.name) for one in planes])) if planes else 0.0
        for plane in planes:
            columns = self._pair(plane.name, UNBALANCE * max(median, self._size(plane.name)))
            yield Hypothesis("unbalance", plane.element, (columns,), self._none())
        yield from self._channels()

    def _channels(self) -> Iterator[Hypothesis]:
        for probe in self.machine.probes:
            if f"probe.{probe.id}.gain.real" in self.names:
                yield Hypothesis("sensor", f"probe.{probe.id}", (self._pair(f"probe.{probe.id}.gain", GAIN),), self._none())
            if f"probe.{probe.id}.run_out.real" in self.names:
                yield Hypothesis("run_out", f"probe.{probe.id}", (self._run_out(probe.id),), self._none())
        for shaft in self.machine.shafts:
            probes = [probe.id for probe in self.machine.probes if probe.shaft == shaft.id]
            known = [one for one in probes if f"probe.{one}.run_out.real" in self.names]
            if len(known) > 1:
                columns = np.concatenate([self._run_out(one) for one in known], axis=1)
                yield Hypothesis("bow", f"shaft.{shaft.id}", (columns,), self._none())

    def _misalignment(self, own: str, beside: list[str]) -> Hypothesis:
        elements = [own, *beside]
        together = RISE * sum(self._growth(element) for element in elements)
        each = [UNEVEN * self._growth(element) for element in elements]
        variants = tuple(
            np.column_stack([together, *each, *more]) for more in ([], [c for e in elements for c in self._apart(e)])
        )
        rising = np.stack([_mean(self._direct(element, "stiffness")) for element in elements])
        return Hypothesis("misalignment", own, variants, rising, frozenset(elements))

    def _alone(self, kind: Kind, element: str) -> Iterator[Hypothesis]:
        """A change of one element, unless the document fixes all of its coefficients or ties them to another's."""
        if next(self._of(element), None) is not None:
            yield Hypothesis(kind, element, self._variants(element), self._none(), frozenset([element]))

    def _variants(self, element: str) -> tuple[Floats, ...]:
        """Growth of an element as a whole; of stiffness and damping by themselves; of each coefficient."""
        whole = [RISE * self._growth(element)]
        parts = [RISE * part for what in ("stiffness", "damping") if (part := self._direct(element, what)).any()]
        return tuple(np.column_stack(columns) for columns in (whole, parts, [*parts, *self._apart(element)]) if columns)

    def _growth(self, element: str) -> Floats:
        """(N,) how all coefficients of an element change when they grow in proportion, as logarithms or in SI."""
        found = np.zeros(len(self.names))
        for place, one in self._of(element):
            found[place] = 1.0 if one.direct else self.typical[place]
        return found

    def _apart(self, element: str) -> list[Floats]:
        """A change of each coefficient of an element by itself."""
        columns = []
        for place, one in self._of(element):
            size = DAMPING_APART if "damping" in one.quantity else APART
            columns.append(size * (1.0 if one.direct else one.scale) * np.eye(len(self.names))[place])
        return columns

    def _of(self, element: str) -> Iterator[tuple[int, Coefficient]]:
        for place, name in enumerate(self.names):
            one = self.coefficients.get(name.partition("@")[0])
            if one is not None and one.element == element:
                yield place, one

    def _direct(self, element: str, what: str) -> Floats:
        """(N,) one at the direct terms of an element that are stiffnesses, or dampings."""
        found = np.zeros(len(self.names))
        found[[place for place, one in self._of(element) if one.direct and what in one.quantity]] = 1.0
        return found

    def _pair(self, name: str, size: float) -> Floats:
        columns = np.zeros((len(self.names), 2))
        for column, part in enumerate(("real", "imaginary")):
            columns[self.names.index(f"{name}.{part}"), column] = size
        return columns

    def _run_out(self, probe: str) -> Floats:
        return self._pair(f"probe.{probe}.run_out", RUN_OUT * self.amplitude[probe])

    def _size(self, name: str) -> float:
        """Magnitude of a complex quantity."""
        return float(np.hypot(*(self.typical[self.names.index(f"{name}.{part}")] for part in ("real", "imaginary"))))

    def _none(self) -> Floats:
        return np.zeros((0, len(self.names)))


def _mean(which: Floats) -> Floats:
    return np.asarray(which / max(1.0, float(which.sum())))
