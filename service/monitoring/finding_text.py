"""Statement of a cause: the kind and numbers that are stored with an alert and a diagnosis; words are made of them later."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

from estimator.machine.parameter_description import describe
from storage.clock import to_datetime

if TYPE_CHECKING:
    from estimator.diagnosis.change_progress import ChangeProgress
    from estimator.diagnosis.finding_kind import Cause, ChangeSize, SizePart
    from service.monitoring.assessment.context import MovedParameter, SecondOrderGrowth

LARGEST_MOVES = 4
"""Parameters per element that are listed as moved: those that moved most certainly."""
ELEVATIONS = ("elevation_x", "elevation_y")
"""Parameters that are not listed: a run leaves single elevations to what is believed of them, and knows the alignment."""

MICROMETRES = 1e6
"""Micrometres in a metre."""


@dataclass(frozen=True)
class Statement:
    """A cause with its runners-up and size.

    since: when the first run that shows it was measured [ns]; first_identification: that run's. force: in the coupling at
    running speed [N], when known. form: form of a misalignment, when the data determine it. progress: since it began. moved:
    parameters of its elements as the newest run determines them; not_estimable: those that it does not. second_order: growth
    of the 2× that speaks for it.
    """

    cause: "Cause"
    runners_up: tuple["Cause", ...]
    size: "ChangeSize"
    since: int
    first_identification: int
    force: float | None
    form: str | None
    progress: "ChangeProgress"
    moved: tuple["MovedParameter", ...]
    not_estimable: tuple[str, ...]
    second_order: "SecondOrderGrowth | None" = None

    def evidence(self) -> dict[str, Any]:
        """Return the evidence: how far what has changed, how certainly, how fast, and the alternative explanations."""
        return {
            "kind": self.cause.kind,
            "element": self.cause.element,
            "evidence": self.cause.evidence,
            "sigma": self.cause.distance,
            "per_cent": self.size.per_cent,
            "tolerance_per_cent": self.size.tolerance_per_cent,
            "quantities": dict(self.size.quantities),
            "parts": [asdict(one) | {"members": list(one.members)} for one in self._parts()],
            "form": self.form,
            "misalignment_force": self.force,
            "since": to_datetime(self.since).isoformat().replace("+00:00", "Z"),
            "first_identification": self.first_identification,
            "runs": len(self.cause.agreement),
            "progress": asdict(self.progress),
            "moved": _changed_parameters(self.cause, self.moved),
            "not_estimable": [name for name in self.not_estimable if describe(name).element == self.cause.element],
            "runners_up": [{"kind": one.kind, "element": one.element, "evidence": one.evidence} for one in self.runners_up],
            "second_order": None if self.second_order is None else _second_order(self.second_order),
        }

    def _parts(self) -> Iterator["SizePart"]:
        """Yield the figures of the size, without members that the newest run does not determine; none of nothing but those."""
        for one in self.size.parts:
            members = tuple(name for name in one.members if describe(name).whole not in self.not_estimable)
            if members or not one.members:
                yield replace(one, members=members)


def _second_order(one: "SecondOrderGrowth") -> dict[str, Any]:
    return {
        "probe": one.probe,
        "before_um": MICROMETRES * one.before,
        "now_um": MICROMETRES * one.now,
        "decided": one.decided,
    }


def _changed_parameters(cause: "Cause", moved: Sequence["MovedParameter"]) -> list[dict[str, Any]]:
    own = {name if describe(name).component is None else describe(name).whole for name in cause.names}
    found = []
    named: Counter[str] = Counter()
    for one in sorted(moved, key=lambda each: -abs(each.sigma)):
        if one.parameter not in own or describe(one.parameter).quantity in ELEVATIONS:
            continue
        named[one.element] += 1
        if named[one.element] <= LARGEST_MOVES:
            found.append({name: value for name, value in asdict(one).items() if name != "element"})
    return found
