"""A cause in words, and as the evidence that an alert and a diagnosis carry."""

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from storage.clock import to_datetime

if TYPE_CHECKING:
    from estimator.change_size import ChangeSize
    from estimator.diagnosis import Cause

LARGEST_MOVES = 4
"""Parameters of each element that are named as moved: those that moved most surely."""


@dataclass(frozen=True)
class Statement:
    """A cause with its runners-up and size.

    since: when the first run that shows it was measured [ns]; first_identification: that run's. force: in the coupling at
    running speed [N], where known. form: of a misalignment, where the data tell it. units: SI unit of the change of each of
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
        """One sentence for a person."""
        return f"{_SAYING[self.cause.kind](self)}, against the baseline, since {to_datetime(self.since):%Y-%m-%d}"

    def evidence(self) -> dict[str, Any]:
        """What it rests on: which parameters moved, by how much and how certainly, and what else would explain it."""
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
            "moved": _moved(self.cause, self.units),
            "runners_up": [{"kind": one.kind, "element": one.element, "evidence": one.evidence} for one in self.runners_up],
        }


def _moved(cause: "Cause", units: Mapping[str, str | None]) -> list[dict[str, Any]]:
    certainty = np.divide(cause.change, cause.error, out=np.zeros_like(cause.change), where=cause.error > 0.0)
    order = np.argsort(-np.abs(certainty))
    found = []
    named: Counter[str] = Counter()
    for i in order:
        element = cause.names[i].rsplit(".", 1)[0]
        named[element] += 1
        if named[element] <= LARGEST_MOVES:
            name = cause.names[i]
            change = {"change": float(cause.change[i]), "unit": units[name]}
            found.append({"parameter": name, **change, "sigma": float(certainty[i])})
    return found


def _misalignment(one: Statement) -> str:
    parts = [f"{name.rsplit('.', 1)[0]} {value:+.0f} %" for name, value in _stiffnesses(one.size.quantities)]
    kind = f" ({one.form})" if one.form else ""
    return f"Coupling {_id(one)} is going out of alignment{kind}: stiffness {', '.join(parts)}"


def _element(one: Statement) -> str:
    parts = [
        f"{name.rsplit('.', 1)[1].removesuffix('_per_cent')} {value:+.0f} %" for name, value in one.size.quantities.items()
    ]
    return f"{one.cause.element.split('.')[0].capitalize()} {_id(one)} has changed by itself: {', '.join(parts)}"


def _unbalance(one: Statement) -> str:
    q = one.size.quantities
    return (
        f"The unbalance of disc {_id(one)} has changed by {rounded(q['change_g_mm'], 3)} g·mm at {q['change_deg']:.0f}°, "
        f"from {rounded(q['before_g_mm'], 3)} to {rounded(q['after_g_mm'], 3)} g·mm"
    )


def _sensor(one: Statement) -> str:
    if not one.cause.names:
        return f"Probe {_id(one)} gives no usable phasors any more"
    q = one.size.quantities
    return f"Probe {_id(one)} or its chain reads differently: gain {q['gain_per_cent']:+.0f} %, phase {q['phase_deg']:+.0f}°"


def _run_out(one: Statement) -> str:
    where = "The run-out at probe" if one.cause.kind == "run_out" else "The bow, or the run-out at all probes, of shaft"
    return f"{where} {_id(one)} has changed by {rounded(one.size.quantities['largest_um'], 2)} µm"


def _misfit(_one: Statement) -> str:
    return "No fit explains the machine's newest runs: its model does not hold any more, or its data are wrong"


def _outliers(_one: Statement) -> str:
    return "Many single phasors of the newest runs do not fit and are left out: look at cables, connections and interference"


_SAYING = {
    "misalignment": _misalignment,
    "coupling": _element,
    "bearing": _element,
    "unbalance": _unbalance,
    "sensor": _sensor,
    "run_out": _run_out,
    "bow": _run_out,
    "misfit": _misfit,
    "outliers": _outliers,
}


def _stiffnesses(quantities: Mapping[str, float]) -> list[tuple[str, float]]:
    return [(name, value) for name, value in quantities.items() if name.endswith("stiffness_per_cent")]


def _id(one: Statement) -> str:
    return one.cause.element.split(".", 1)[1]


def rounded(value: float, digits: int) -> str:
    """A number to so many digits, written out: people read these, and nobody reads 1.3e+04 g·mm aloud."""
    shown = float(f"{value:.{digits}g}")
    decimals = 0 if shown == 0.0 else max(0, digits - 1 - math.floor(math.log10(abs(shown))))
    return f"{shown:.{decimals}f}"
