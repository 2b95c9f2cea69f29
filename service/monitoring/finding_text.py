"""Statement of a cause: its sentence, and the evidence stored with an alert and a diagnosis."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from estimator.machine.parameter_description import describe
from service.monitoring.finding_rules import finding_rule
from storage.clock import to_datetime

if TYPE_CHECKING:
    from estimator.diagnosis.finding_kind import Cause, ChangeSize

LARGEST_MOVES = 4
"""Parameters per element that are listed as moved: those that moved most certainly."""
ELEVATIONS = ("elevation_x", "elevation_y")
"""Parameters that are not listed: a run leaves single elevations to what is believed of them, and knows the alignment."""


@dataclass(frozen=True)
class Statement:
    """A cause with its runners-up and size.

    since: when the first run that shows it was measured [ns]; first_identification: that run's. force: in the coupling at
    running speed [N], when known. form: of a misalignment, when the data determine it. units: SI unit of the change of each of
    the cause's names.
    """

    cause: "Cause"
    runners_up: tuple["Cause", ...]
    size: "ChangeSize"
    since: int
    first_identification: int
    force: float | None
    form: str | None
    units: Mapping[str, str | None]

    def words(self) -> str:
        """Return the sentence for a person."""
        return (
            f"{finding_rule(self.cause.kind).sentence(self)}, against the baseline, since {to_datetime(self.since):%Y-%m-%d}"
        )

    def evidence(self) -> dict[str, Any]:
        """Return the evidence: which parameters moved, by how much and how certainly, and the alternative explanations."""
        return {
            "kind": self.cause.kind,
            "element": self.cause.element,
            "evidence": self.cause.evidence,
            "sigma": self.cause.distance,
            "per_cent": self.size.per_cent,
            "quantities": dict(self.size.quantities),
            "form": self.form,
            "misalignment_force": self.force,
            "since": to_datetime(self.since).isoformat().replace("+00:00", "Z"),
            "first_identification": self.first_identification,
            "runs": len(self.cause.agreement),
            "moved": _changed_parameters(self.cause, self.units),
            "runners_up": [{"kind": one.kind, "element": one.element, "evidence": one.evidence} for one in self.runners_up],
        }


def _changed_parameters(cause: "Cause", units: Mapping[str, str | None]) -> list[dict[str, Any]]:
    certainty = np.divide(cause.change, cause.error, out=np.zeros_like(cause.change), where=cause.error > 0.0)
    order = np.argsort(-np.abs(certainty))
    found = []
    named: Counter[str] = Counter()
    for i in order:
        if describe(cause.names[i]).quantity in ELEVATIONS:
            continue
        element = describe(cause.names[i]).element
        named[element] += 1
        if named[element] <= LARGEST_MOVES:
            name = cause.names[i]
            change = {"change": float(cause.change[i]), "unit": units[name]}
            found.append({"parameter": name, **change, "sigma": float(certainty[i])})
    return found
