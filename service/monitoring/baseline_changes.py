"""New baselines: after a maintenance the machine has changed, and findings against the old baseline no longer hold."""

from sqlalchemy.orm import Session

from estimator.errors import Conflict, Invalid
from estimator.machine.document import Machine
from service.alerts import transitions
from storage.alerts import alerts
from storage.clock import TOLERANCE, now
from storage.findings import identifications
from storage.machines import baselines, machines, timeline
from storage.tables.machines import BaselineRow, RevisionRow, TimelineRow

MAINTENANCE = "maintenance"
FEWEST_NAMED = 3
"""Smallest number of named identifications: fewer do not show their scatter."""


class BaselineRefused(Conflict):
    """The named identifications cannot form a baseline; the message states the reason."""


class BaselineInFuture(Invalid):
    """The baseline would begin in the future: until then the machine is unchanged."""


def begin(
    session: Session,
    machine_id: str,
    *,
    since: int,
    reason: str,
    by: str,
    identification_ids: list[int] | None = None,
) -> BaselineRow:
    """Begin a baseline and clear the alerts that were based on the one before. Raises BaselineRefused, BaselineInFuture."""
    if since > now() + TOLERANCE:
        raise BaselineInFuture(
            "a baseline begins when the work is done, not in the future: say it then, and note the plan as a note"
        )
    if identification_ids is not None:
        _require(session, machine_id, identification_ids)
    row = baselines.begin(session, machine_id, since=since, identification_ids=identification_ids, reason=reason, by=by)
    for alert in alerts.open_alerts(session, machine_id):
        # Where it begins in the past, runs behind that were compared with what no longer counts.
        if alert.measured_at < since or baselines.in_force(session, machine_id, at=alert.measured_at) is row:
            transitions.clear_alert(session, alert, comment=f"a new baseline begins: {reason}")
    return row


def revise(session: Session, machine: Machine) -> RevisionRow:
    """Put a document in force; when it describes another machine, clear the alerts that were based on the one before.

    Raises MachineUnknown, PlantChanged.
    """
    before = machines.get(session, machine.id).revision
    row = machines.revise(session, machine)
    if before not in machines.comparable_revisions(session, machine.id, row.revision):
        for alert in alerts.open_alerts(session, machine.id):
            comment = f"a new baseline begins: revision {row.revision} describes the machine otherwise"
            transitions.clear_alert(session, alert, comment=comment)
    return row


def note(session: Session, machine_id: str, *, at: int, kind: str, text: str, by: str) -> TimelineRow:
    """Add an entry to the timeline; a maintenance begins a baseline. Raises BaselineInFuture."""
    row = timeline.add(session, machine_id, at=at, kind=kind, text=text, by=by)
    if kind == MAINTENANCE:
        begin(session, machine_id, since=at, reason=text, by=by)
    return row


def _require(session: Session, machine_id: str, ids: list[int]) -> None:
    if len(set(ids)) < FEWEST_NAMED:
        raise BaselineRefused(f"{len(set(ids))} identifications are named: at least {FEWEST_NAMED} make a baseline")
    for number in ids:
        row = identifications.get(session, number)
        if row.machine_id != machine_id:
            raise BaselineRefused(f"identification {number} is of machine '{row.machine_id}', not of '{machine_id}'")
        if not row.accepted:
            raise BaselineRefused(f"identification {number} was not accepted: {row.verdict}")
