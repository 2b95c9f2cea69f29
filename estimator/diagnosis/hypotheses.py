"""Hypotheses of a diagnosis: everything that can have happened to a machine, each as the changes that it makes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.diagnosis.change_columns import ChangeColumns
from estimator.diagnosis.finding_kind import ExpectedChange, FindingKind
from estimator.diagnosis.finding_kinds import FINDING_KINDS
from estimator.machine.document import Machine
from estimator.rotor.parameters import Unknowns


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """One thing that can have happened.

    Attributes:
        kind: Kind of the finding.
        element: Name of the element, such as `coupling.C1`, `bearing.B2`, `disc.D1`, `shaft.motor`, `probe.B1L`.
        variants: Changes (N, r) that it makes, of the size expected of them, from simple to free [SI, logarithms of direct
            terms].
        rising: Functionals (q, N) of the change that must be positive [-].
        elements: Names of all elements whose coefficients it moves.
        linear: Whether it enters the response linearly.
        fitted: Whether each of the coefficients that it moves is an unknown of every fit by itself.
    """

    kind: str
    element: str
    variants: tuple[Floats, ...]
    rising: Floats
    elements: frozenset[str] = frozenset()
    linear: bool = False
    fitted: bool = False


def hypotheses(
    machine: Machine, unknowns: Unknowns, names: Sequence[str], *, typical: Floats, amplitude: Mapping[str, float]
) -> tuple[Hypothesis, ...]:
    """List everything that a diagnosis of a machine chooses from.

    Args:
        machine: The machine.
        unknowns: Its unknowns.
        names: Names of the N quantities.
        typical: Values (N,) of the quantities while the machine is healthy [SI, logarithms of direct terms].
        amplitude: Median amplitude by channel then [m].

    Returns:
        The hypotheses.
    """
    columns = ChangeColumns(machine, unknowns, names, typical=typical, amplitude=amplitude)
    return tuple(
        _hypothesis(kind, change, len(names)) for kind in FINDING_KINDS if kind.changes for change in kind.changes(columns)
    )


def _hypothesis(kind: FindingKind, change: ExpectedChange, count: int) -> Hypothesis:
    kind.require_element(change.element)
    rising = np.zeros((0, count)) if change.rising is None else change.rising
    return Hypothesis(kind.kind, change.element, change.variants, rising, change.moves, kind.linear, kind.fitted)
