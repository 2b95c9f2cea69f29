"""Targets of a coupling's alignment, as left cold and with the growth expected, beside what a run determines.

A run-up from standstill shows the machine cold, a run-down from its work hot; the two are never compared with one target. How
probably a difference is more than is allowed: JCGM 106:2012, conformance probability.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from estimator.alignment.tolerance import allowed_alignment, probability_beyond
from estimator.fit.estimates import CONFIDENCE_95
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from estimator.updated_model.derived_quantities import Derived

Warmth = Literal["cold", "hot"]
"""State of a machine for which its alignment is stated."""
WARMTH_OF_RUNS: dict[str, Warmth] = {"run-up": "cold", "run-down": "hot", "rolling": "hot"}
"""State of the machine in each kind of run."""


@dataclass(frozen=True)
class TargetedAlignment:
    """Alignment in one plane beside its target.

    Attributes:
        name: Name, such as `coupling.C1.offset_vertical`.
        unit: SI unit.
        state: State of the machine for which the target is.
        target: What is aimed at in that state [unit].
        off: By how much the alignment is larger [unit]; None where that is not determined.
        half: Half width of its 95 % interval [unit]; None where it is not determined.
        allowed: What is allowed of the difference [unit].
        beyond: Probability that the difference is larger [-]; None where it is not determined.
        reason: Reason why it is not determined; None where it is.
    """

    name: str
    unit: str
    state: Warmth
    target: float
    off: float | None
    half: float | None
    allowed: float
    beyond: float | None
    reason: str | None = None


def expected_alignment(machine: Machine, coupling: str, state: Warmth) -> dict[str, float]:
    """Return what a document aims at for a coupling in a state (derived here: cold, and with its growth hot).

    Args:
        machine: The machine.
        coupling: Id of the coupling.
        state: State of the machine.

    Returns:
        Targets by quantity, such as `offset_vertical` [m, rad]; hot ones only where the growth is stated.
    """
    said = next((one for one in machine.operation.alignment_targets if one.coupling == coupling), None)
    if said is None:
        return {}
    cold, growth = said.left_cold.stated, said.growth.stated
    return cold if state == "cold" else {name: cold[name] + by for name, by in growth.items()}


def targeted_alignment(machine: Machine, alignment: Sequence[Derived], run_kind: str) -> tuple[TargetedAlignment, ...]:
    """Compare the alignment that a run determines with its targets (JCGM 106:2012).

    Args:
        machine: The machine.
        alignment: Offsets and angles of the run, as `alignment_quantities` returns them.
        run_kind: Kind of the run, such as `run-down`.

    Returns:
        Those that have a target in the state that such a run shows.
    """
    state = WARMTH_OF_RUNS.get(run_kind)
    if state is None:
        return ()
    found = []
    for one in alignment:
        said = describe(one.name)
        target = expected_alignment(machine, said.element_id, state).get(said.quantity)
        if target is None:
            continue
        allowed = allowed_alignment(machine, said.element_id).of(said.quantity)
        if one.value is None or one.lower is None or one.upper is None:
            found.append(TargetedAlignment(one.name, one.unit, state, target, None, None, allowed, None, one.reason))
            continue
        off, half = one.value - target, (one.upper - one.lower) / 2.0
        beyond = probability_beyond(off, half / CONFIDENCE_95, allowed)
        found.append(TargetedAlignment(one.name, one.unit, state, target, off, half, allowed, beyond))
    return tuple(found)
