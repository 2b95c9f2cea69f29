"""Reads the trends of a report: of what has an alert, then of couplings, then others."""

from collections.abc import Iterator, Sequence

import numpy as np
from sqlalchemy.orm import Session

from estimator.machine.parameter_description import describe
from service.monitoring.trend_bands import baseline_bands
from service.reports.contents import ReportedTrend
from service.reports.period import ReportPeriod
from service.wording.shown_units import ShownUnits
from storage.findings import derived, identifications, trends
from storage.findings.jobs import RUN
from storage.findings.trends import ParameterHistory
from storage.tables.findings import IdentificationRow

SHOWN: dict[str, tuple[str, float]] = {
    "m": ("µm", 1e6),
    "rad": ("mrad", 1e3),
    "kg m": ("g mm", 1e6),
    "rad/s": ("r/min", 60.0 / (2.0 * np.pi)),
    "N/m": ("MN/m", 1e-6),
    "N s/m": ("kN s/m", 1e-3),
}
"""Units that people use, and their number in an SI unit; others are shown as they are."""
MOST_TRENDS = 16
"""Trends of a report; the page has all of them."""


def reported_names(session: Session, newest: IdentificationRow, alerted: Sequence[str]) -> tuple[str, ...]:
    """Return the newest identification's parameters whose trends are printed: of alerts, of couplings, then others.

    alerted: elements with an open alert.
    """
    known = [one.name for one in derived.of_identification(session, newest.id)]
    known += [one.parameter for one in identifications.estimates(session, newest.id)]
    of_alerts = [name for element in alerted for name in known if describe(name).element == element]
    of_couplings = [name for name in known if describe(name).element_kind == "coupling"]
    return tuple(dict.fromkeys([*of_alerts, *of_couplings, *known]))[:MOST_TRENDS]


def read_trends(
    session: Session, machine_id: str, names: Sequence[str], period: ReportPeriod, *, baseline_runs: int, units: ShownUnits
) -> Iterator[ReportedTrend]:
    """Yield the trends that have a value in the period."""
    shown = SHOWN | _chosen(units)
    for name, history in trends.histories(session, machine_id, names, scope=RUN).items():
        size = np.where(np.isfinite(history.imaginary), np.hypot(history.value, history.imaginary), history.value)
        known = history.accepted & np.isfinite(size)
        known &= (history.measured_at >= period.first) & (history.measured_at <= period.last)
        if not known.any():
            continue
        unit, scale = shown.get(history.unit or "", (history.unit or "", 1.0))
        yield ReportedTrend(
            name=name,
            unit=unit,
            time=history.measured_at[known],
            value=scale * size[known],
            lower=scale * history.lower[known],
            upper=scale * history.upper[known],
            band=_band(session, machine_id, name, history, scale, baseline_runs),
        )


def _chosen(units: ShownUnits) -> dict[str, tuple[str, float]]:
    """Return the units of lengths and speeds that were chosen."""
    rpm = SHOWN["rad/s"][1]
    speed = ("Hz" if units.hertz else SHOWN["rad/s"][0], rpm * units.speed_factor())
    return {"m": (units.length, units.in_length(1e6)), "rad/s": speed}


def _band(
    session: Session, machine_id: str, name: str, history: ParameterHistory, scale: float, baseline_runs: int
) -> tuple[float, float] | None:
    bands = baseline_bands(session, machine_id, name, history, baseline_runs=baseline_runs)
    return (scale * bands[-1].band.lower, scale * bands[-1].band.upper) if bands else None
