"""Transitions of alerts: each event changes the alert's standing, is recorded, and is queued for delivery.

All functions work inside the caller's transaction: a state without its event, or an event without its deliveries, cannot be
stored.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy.orm import Session

from estimator.errors import Invalid
from service.alerts.lifecycle import (
    ACTIVE,
    Acknowledged,
    AlertCondition,
    AlertStatus,
    Cleared,
    Forbidden,
    LifecycleEvent,
    Raised,
    Released,
    Reset,
    Severity,
    Suppressed,
    Suppression,
    advance,
)
from storage.alerts import alerts, deliveries, suppressions
from storage.clock import now
from storage.tables.alerting import AlertRow, SuppressionRow

SERVICE = "rundown"
"""Author of events that no person causes."""
EXPIRED_AT_ONCE = 20
"""Largest number of suppressions that end in one transaction."""
MOST_SUPPRESSIONS = 500
"""Largest number of suppressions in force on a machine."""
LONGEST_SHELVING_DAYS = 30
LONGEST_SHELVING_NS = LONGEST_SHELVING_DAYS * 86_400 * 1_000_000_000
"""Longest shelving: thirty days [ns]."""


class MomentRefused(Invalid):
    """The end of a shelving is not permitted."""

    @property
    def detail(self) -> str:
        """Return that the request is wrong; `field_errors` names the field."""
        return "the request is wrong"

    @property
    def field_errors(self) -> Sequence[tuple[str, str]]:
        """Return the error for the field `until`."""
        return [("until", str(self))]


@dataclass(frozen=True)
class AlertFinding:
    """Finding of an identification for an alert: its evidence, which is its kind and numbers, and severity."""

    evidence: dict[str, Any]
    identification_id: int
    measured_at: int
    severity: Severity = Severity.ALERT
    latching: bool = False


@dataclass(frozen=True)
class Person:
    """The author of an action, with a comment."""

    name: str
    comment: str = ""


def status_of(row: AlertRow) -> AlertStatus:
    """Return the standing of a stored alert."""
    return AlertStatus(
        condition=AlertCondition(row.condition),
        severity=Severity(row.severity),
        latching=row.latching,
        suppressions=frozenset(Suppression(one) for one in row.suppressions),
    )


def raise_alert(session: Session, machine_id: str, *, rule: str, element: str, finding: AlertFinding) -> AlertRow:
    """Open an episode because the cause is present, or update the open one."""
    row = alerts.open_alert(session, machine_id, rule=rule, element=element)
    if row is None:
        row = alerts.add(
            session,
            machine_id,
            rule=rule,
            element=element,
            evidence=finding.evidence,
            identification_id=finding.identification_id,
            measured_at=finding.measured_at,
            latching=finding.latching,
        )
        row.suppressions = sorted({one.kind for one in suppressions.of_alert(session, machine_id, rule=rule, element=element)})
        row.state = status_of(row).state
    else:
        row.message, row.evidence, row.latching = "", finding.evidence, finding.latching
        row.identification_id, row.measured_at = finding.identification_id, finding.measured_at
        row.updated_at = now()
    _apply_event(session, row, Raised(finding.severity), "raised", Person(SERVICE))
    return row


def clear_alert(session: Session, row: AlertRow, *, comment: str = "") -> None:
    """Record that the cause is gone. A shelving until then ends."""
    _apply_event(session, row, Cleared(), "cleared", Person(SERVICE, comment))
    _end_shelving_until_cleared(session, row)


def _end_shelving_until_cleared(session: Session, row: AlertRow) -> None:
    for one in suppressions.of_alert(session, row.machine_id, rule=row.rule, element=row.element):
        if one.until_cleared:
            release(session, one, Person(SERVICE, "its cause is gone"))


def acknowledge(session: Session, row: AlertRow, person: Person) -> None:
    """Record that a person has seen the alert. Raises Forbidden."""
    _apply_event(session, row, Acknowledged(), "acknowledged", person)


def reset(session: Session, row: AlertRow, person: Person) -> None:
    """Reset a latched alert. Raises Forbidden."""
    _apply_event(session, row, Reset(), "reset", person)
    _end_shelving_until_cleared(session, row)


def comment(session: Session, row: AlertRow, person: Person) -> None:
    """Add a person's comment, also to a closed alert."""
    _record(session, row, "commented", row.state, person, at=now())


def shelve(session: Session, row: AlertRow, person: Person, *, until: int, until_cleared: bool = False) -> None:
    """Shelve an alert until a moment [ns]: it notifies nobody, nor does a later episode before then.

    until_cleared: the shelving ends with this episode's cause, so that a later one calls; refused where that is gone already.

    Raises Forbidden, and MomentRefused for a moment in the past or more than 30 days ahead: nothing is shelved for ever.
    """
    if row.closed_at is not None:
        raise Forbidden("the alert is closed: only an open alert is shelved")
    if Suppression.SHELVED in status_of(row).suppressions:
        raise Forbidden("the alert is shelved already: end that first")
    if until_cleared and status_of(row).condition not in ACTIVE:
        raise Forbidden("the alert's cause is gone already: shelve it until a moment")
    moment = now()
    if not moment < until <= moment + LONGEST_SHELVING_NS:
        raise MomentRefused(f"an alert is shelved until a moment to come, at most {LONGEST_SHELVING_DAYS} days ahead")
    place = {"rule": row.rule, "element": row.element}
    suppress(session, row.machine_id, Suppression.SHELVED, person, **place, until=until, until_cleared=until_cleared)


def unshelve(session: Session, row: AlertRow, person: Person) -> None:
    """End a shelving before its time. Raises Forbidden."""
    shelved = [
        one
        for one in suppressions.of_alert(session, row.machine_id, rule=row.rule, element=row.element)
        if one.kind == Suppression.SHELVED
    ]
    if not shelved:
        raise Forbidden("the alert is not shelved")
    for one in shelved:
        release(session, one, person)


def suppress(
    session: Session,
    machine_id: str,
    kind: Suppression,
    person: Person,
    *,
    rule: str | None = None,
    element: str | None = None,
    until: int | None = None,
    until_cleared: bool = False,
) -> SuppressionRow:
    """Suppress the alerts of a machine, or those of a rule or an element, both open and future ones.

    Raises Forbidden where as many are in force on the machine as may be.
    """
    if suppressions.count_in_force(session, machine_id) >= MOST_SUPPRESSIONS:
        many = f"{MOST_SUPPRESSIONS} suppressions of machine '{machine_id}' are in force"
        raise Forbidden(f"{many}, as many as may: end some first")
    begun = suppressions.add(
        session,
        machine_id,
        kind=kind,
        rule=rule,
        element=element,
        until=until,
        by=person.name,
        comment=person.comment,
        until_cleared=until_cleared,
    )
    for row in _matching(session, begun):
        _apply_event(session, row, Suppressed(kind), kind.value, person)
    return begun


def release(session: Session, begun: SuppressionRow, person: Person) -> None:
    """End a suppression. Raises Forbidden when it has ended already."""
    if begun.ended_at is not None:
        raise Forbidden("the suppression has ended already")
    suppressions.end(begun, by=person.name)
    session.flush()
    kind = Suppression(begun.kind)
    for row in _matching(session, begun):
        left = {one.kind for one in suppressions.of_alert(session, row.machine_id, rule=row.rule, element=row.element)}
        if kind not in left and kind in status_of(row).suppressions:
            _apply_event(session, row, Released(kind), f"{kind.value}_ended", person)


def release_expired(session: Session) -> int:
    """End expired suppressions, so many that the transaction is a short one, and return their number."""
    over = suppressions.expired(session, now(), limit=EXPIRED_AT_ONCE)
    for one in over:
        release(session, one, Person(SERVICE, "its time is over"))
    return len(over)


def any_expired(session: Session) -> bool:
    """Return whether any suppression has expired."""
    return bool(suppressions.expired(session, now(), limit=1))


def _matching(session: Session, one: SuppressionRow) -> list[AlertRow]:
    return [
        row
        for row in alerts.open_alerts(session, one.machine_id)
        if one.rule in (None, row.rule) and one.element in (None, row.element)
    ]


def _apply_event(session: Session, row: AlertRow, event: LifecycleEvent, kind: str, person: Person) -> None:
    """Apply an event to an alert, and record it if it changes anything."""
    before = status_of(row)
    after = advance(before, event)
    if after == before:
        return
    if isinstance(event, Raised) and after.condition is before.condition:
        kind = "severity_changed"
    state_before = row.state
    row.condition, row.severity, row.state = after.condition.value, int(after.severity), after.state
    row.suppressions = sorted(after.suppressions)
    row.updated_at = now() if row.event_count else row.opened_at  # with its first event it opens
    if after.closed:
        row.closed_at = row.updated_at
    _record(session, row, kind, state_before, person, at=row.updated_at)


def _record(session: Session, row: AlertRow, kind: str, state_before: str, person: Person, *, at: int) -> None:
    event = alerts.add_event(session, row, kind=kind, state_before=state_before, by=person.name, comment=person.comment, at=at)
    deliveries.queue(session, event)
