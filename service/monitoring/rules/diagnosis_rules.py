"""Delays of a diagnosis's alerts, and the severity of a cause, by the limits of its alert rule."""

from typing import TYPE_CHECKING

from service.alerts.lifecycle import Severity
from service.monitoring.rules.finding_catalogue import finding_rule
from service.monitoring.rules.limits import Limits, severity_of

if TYPE_CHECKING:
    from estimator.diagnosis.finding_kind import ChangeSize

UNLIMITED_DELAY = 2
"""Runs in a row that open, and good ones that clear, an alert of a finding without limits."""
WHOLE_TOLERANCE = 100.0
"""All of what is allowed [%]."""


def delays(limits: Limits, kind: str, element: str) -> tuple[int, int]:
    """Return how many runs in a row open and clear an alert of a kind of finding."""
    rule = finding_rule(kind).rule
    if rule.limits is None:
        return UNLIMITED_DELAY, UNLIMITED_DELAY
    chosen = limits.rule(rule.name, element)
    return chosen.on_delay, chosen.off_delay


def danger_limit(limits: Limits, kind: str, element: str, size: "ChangeSize") -> float | None:
    """Return the danger limit of a cause's size, in the per cent that `ChangeSize.limited` has; None where there is none."""
    rule = finding_rule(kind).rule
    level = None if rule.limits is None else limits.rule(rule.name, element).danger
    if level is None:
        return None
    if size.tolerance_per_cent is None:
        return level.per_cent
    # Certain to be beyond what is allowed is at least all of what is allowed.
    return level.tolerance_per_cent if level.beyond_tolerance is None else WHOLE_TOLERANCE


def cause_severity(
    limits: Limits,
    *,
    kind: str,
    element: str,
    sigma: float,
    size: "ChangeSize",
    force: float | None,
    present: Severity | None,
) -> Severity | None:
    """Return the severity of a cause; None while it reaches no limit. sigma: standard deviations of its change.

    size: its size; one without any is always an alert. force: in the coupling [N]. present: severity of its open alert.
    """
    rule = finding_rule(kind).rule
    if rule.limits is None or size.unknown:
        return Severity.ALERT
    return severity_of(
        limits,
        rule.name,
        sigma=sigma,
        per_cent=size.per_cent,
        force=force,
        tolerance_per_cent=size.tolerance_per_cent,
        beyond_tolerance=size.beyond_tolerance,
        present=present,
        element=element,
    )
