"""Comparison of a later run with a baseline on oil films: how far the alignment has moved, and which loads."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from estimator.alignment.alignment_change import changed_alignment
from estimator.alignment.freed_coordinates import MovingCause
from estimator.alignment.load_change import LoadChange, changed_loads
from estimator.alignment.run_change import run_change
from estimator.alignment.tolerance import ToleratedChange, tolerated_changes
from estimator.fit.decimals import signed_with_half
from estimator.fit.estimates import CONFIDENCE_95
from estimator.fit.validation.omitted_forces import largest_score
from estimator.machine.parameter_description import describe
from estimator.updated_model.model import UpdatedModel

MICRO = 1e6
UNLIKELY = 0.05
"""Chance of calling any offset or angle of a healthy machine changed [-]."""


@dataclass(frozen=True)
class AlignmentComparison:
    """Changes since a baseline, as API, alert and report tell them.

    Attributes:
        coupling: Id of the coupling.
        changes: Changes of its offsets [m] and angles [rad], with what is allowed.
        loads: Changes of the loads on all bearings' films [N].
        others: Kind and element of each other cause of what has changed; what these have moved is not held at the baseline's.
    """

    coupling: str
    changes: tuple[ToleratedChange, ...]
    loads: tuple[LoadChange, ...]
    others: tuple[tuple[str, str], ...] = ()

    @property
    def verdict(self) -> str:
        """Return which offsets and angles have changed for certain, in words, and what else has happened.

        Any of them is told of a healthy machine with a chance of 5 % at most, which they share (Bonferroni); the intervals
        that stand beside are of each by itself.
        """
        also = "".join(f"; {kind} at {element} is named, and what it has moved is left open" for kind, element in self.others)
        return f"{self._alignment_verdict()}{also}"

    def _alignment_verdict(self) -> str:
        known = [one for one in self.changes if one.value is not None]
        if not known:
            return f"the run does not determine the alignment of {self.coupling}"
        several = largest_score(UNLIKELY, len(known)) / CONFIDENCE_95
        moved = [f"{_words(one.name)} by {_change(one)}" for one in known if abs(one.value or 0.0) > several * one.half]
        if not moved:
            return f"no change of the alignment of {self.coupling} is certain"
        return f"the alignment of {self.coupling} has changed: {', '.join(moved)}"

    def lines(self) -> Iterator[str]:
        """List offsets and angles, then loads, each with its 95 % interval.

        Returns:
            The lines of the table.
        """
        width = max(len(name) for name in (*(one.name for one in self.changes), *(one.name for one in self.loads)))
        for one in self.changes:
            yield f"  {one.name:<{width}}  {f'not determined: {one.reason}' if one.value is None else _change(one)}"
        for load in self.loads:
            part = "" if load.part is None else f", {100.0 * load.part:+.0f} %"
            told = " ± ".join(signed_with_half(load.value, load.half))
            yield f"  {load.name:<{width}}  {told} N of {load.before:.4g} N{part}"


def compared_alignment(
    baseline: Sequence[UpdatedModel], later: UpdatedModel, coupling: str, *, causes: Iterable[MovingCause] = ()
) -> AlignmentComparison:
    """Compare a coupling's alignment with a baseline (linear mixed model; Laird and Ware 1982).

    Args:
        baseline: Models of the baseline's runs, at least one, of one machine whose bearings are described by their films.
        later: Model of the later run.
        coupling: Id of the coupling.
        causes: Element of what else is known to have happened to the machine since, and what that moves.

    Returns:
        The comparison.

    Raises:
        ValueError: There is no baseline, it is of another machine, or no elevation of its bearings is identified.
    """
    change = run_change(baseline, later, causes=causes)
    if change is None:
        raise ValueError(
            f"changes of alignment follow from elevations of bearings, and none of '{later.machine.id}' is identified: "
            "describe all of its bearings by geometry and oil"
        )
    changes = tolerated_changes(later.machine, changed_alignment(change))
    own = tuple(one for one in changes if describe(one.name).element_id == coupling)
    return AlignmentComparison(coupling, own, changed_loads(change))


def _words(name: str) -> str:
    """Return an offset or angle as people name it, such as `vertical offset` for `coupling.C1.offset_vertical`."""
    quantity, _, plane = describe(name).quantity.partition("_")
    return f"{plane} {quantity}"


def _change(one: ToleratedChange) -> str:
    unit = f"µ{one.unit}"
    told = " ± ".join(signed_with_half(MICRO * (one.value or 0.0), MICRO * one.half))
    return f"{told} {unit} ({MICRO * one.allowed:.0f} {unit} allowed, chance of more {_chance(one.beyond)})"


def _chance(value: float) -> str:
    """Return a chance in per cent: none is certain, and none impossible."""
    part = 100.0 * value
    return f"{part:.0f} %" if 1.0 <= part <= 99.0 else "under 1 %" if part < 1.0 else "over 99 %"
