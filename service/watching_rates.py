"""Alerts of elements that change too fast, whatever the size of the change so far."""

from collections.abc import Mapping, Sequence

from sqlalchemy.orm import Session

from estimator.rate_of_change import WINDOW
from estimator.trend_tests import Reading
from service import alerting
from service.alert_life import Severity
from service.alerting import Finding
from service.comparing import Compared, readings
from service.limits import LONGEST_DELAY, Limits
from service.rate_of_change import RATE_OF_CHANGE, RateFinding, rate_findings
from storage import alerts
from storage.tables import IdentificationRow

LOOKED_BACK = WINDOW + LONGEST_DELAY
"""Newest runs that a rate and its delays look at."""


def judge(session: Session, rows: Compared, limits: Limits) -> None:
    """Open, update or clear the alerts of this rule after an accepted identification."""
    if rows.missing is not None:
        return
    stored = rows.identification
    opened = {one.element: one for one in alerts.open_alerts(session, stored.machine_id) if one.rule == RATE_OF_CHANGE}
    present = {element: Severity(one.severity) for element, one in opened.items()}
    history = readings(session, rows)
    newest = _found(limits, history, present)
    longest = max((_longest_delay(limits, element) for element in {*newest, *opened}), default=1)
    # The newest run first, then as each run before it had it.
    found = [newest, *(_found(limits, history[:-back], present) for back in range(1, longest))]
    for element, one in newest.items():
        if element in opened or all(element in then for then in found[: limits.rule(RATE_OF_CHANGE, element).on_delay]):
            _raise(session, stored, one, latching=limits.rule(RATE_OF_CHANGE, element).latching)
    for element, alert in opened.items():
        gone = not any(element in then for then in found[: limits.rule(RATE_OF_CHANGE, element).off_delay])
        if gone and alert.evidence.get("run_kind") == stored.run_kind:
            alerting.clear_alert(session, alert)


def _found(limits: Limits, history: Sequence[Reading], present: Mapping[str, Severity]) -> dict[str, RateFinding]:
    return {one.element: one for one in rate_findings(limits, history, present)}


def _longest_delay(limits: Limits, element: str) -> int:
    rule = limits.rule(RATE_OF_CHANGE, element)
    return max(rule.on_delay, rule.off_delay)


def _raise(session: Session, stored: IdentificationRow, one: RateFinding, *, latching: bool) -> None:
    evidence = {"kind": RATE_OF_CHANGE, "element": one.element, "parameter": one.rate.name, "runs": one.rate.runs}
    evidence |= {f"{what}_per_cent": 100.0 * getattr(one.rate, what) for what in ("per_week", "lower", "upper")}
    finding = Finding(
        message=one.message,
        evidence=evidence | {"identification": stored.id, "run_kind": stored.run_kind},
        identification_id=stored.id,
        measured_at=stored.measured_at,
        severity=one.severity,
        latching=latching,
    )
    alerting.raise_alert(session, stored.machine_id, rule=RATE_OF_CHANGE, element=one.element, finding=finding)
