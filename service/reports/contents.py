"""The contents of a report: everything that its pages are made of, so that a worker process needs no database."""

from dataclasses import dataclass
from datetime import datetime

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.machine.document import Machine
from service.alerts.event_message import AlertEvent
from service.identification.stored_model import Identified, UsedRun
from service.wording.language import ENGLISH, Language
from service.wording.shown_units import USUAL_UNITS, ShownUnits


@dataclass(frozen=True)
class ReportedAlert:
    """An alert as it was at the end of the period. rank: rank of its severity; last: the newest event until then."""

    rank: int
    last: AlertEvent
    closed_at: datetime | None
    is_open: bool


@dataclass(frozen=True)
class ReportedNote:
    """A note, or a marker of maintenance, on the machine's timeline."""

    at: datetime
    kind: str
    by: str
    text: str


@dataclass(frozen=True)
class ReportedTrend:
    """A parameter's accepted values in the period, (n,) each, in a unit that people use.

    time: [ns since 1970]. band: the interval of the newest baseline; None without one.
    """

    name: str
    unit: str
    time: NDArray[np.int64]
    value: Floats
    lower: Floats
    upper: Floats
    band: tuple[float, float] | None


@dataclass(frozen=True)
class ReportedBalancing:
    """A field balancing: when it was last touched, by whom it was begun, and which step was taken last."""

    at: datetime
    by: str
    state: str
    comment: str


@dataclass(frozen=True)
class ReportedFit:
    """The newest accepted identification until the end of the period, with its runs.

    measured_at: when its run was. baseline: those that it is compared with, oldest first; reference: the runs of the first.
    missing: why there is no baseline, in words. causes: kind and element of those that its diagnosis names.
    """

    measured_at: datetime
    one: Identified
    runs: tuple[UsedRun, ...]
    baseline: tuple[Identified, ...]
    reference: tuple[UsedRun, ...]
    missing: str
    causes: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class PeriodCounts:
    """Counts of the period. turned_until: end of the newest run until the period's end; None: none yet."""

    runs: int
    identifications: int
    accepted: int
    turned_until: datetime | None


@dataclass(frozen=True)
class ReportContents:
    """Contents of a report on a machine over a period.

    not_to_balance: why no weights are proposed; None where nothing else is wrong. left_out: what there is more of than a
    report shows, in words. language: language of the report; advice and messages are in it already. units: those of its
    plots and tables; trends are in them already.
    """

    machine: Machine
    plant: str
    first: datetime
    last: datetime
    made_at: datetime
    counts: PeriodCounts
    alerts: tuple[ReportedAlert, ...]
    events: tuple[AlertEvent, ...]
    notes: tuple[ReportedNote, ...]
    trends: tuple[ReportedTrend, ...]
    balancings: tuple[ReportedBalancing, ...]
    fit: ReportedFit | None
    not_to_balance: str | None
    left_out: tuple[str, ...]
    language: Language = ENGLISH
    units: ShownUnits = USUAL_UNITS

    @property
    def open_alerts(self) -> list[ReportedAlert]:
        """Return the alerts open at the end of the period, the worst first."""
        found = [one for one in self.alerts if one.is_open]
        return sorted(found, key=lambda one: (-one.rank, one.last.opened_at))
