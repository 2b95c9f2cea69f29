"""Repository of field balancings. A balancing's steps are one object, with fields

`disc_scale`: the scale of angles on the discs, as `estimator.machine.disc_scale` has it, missing in older ones;
`initial`: ids of the runs before any trial weight; `trials`: for each trial run its id and weights; `correction`: what was
asked and what came; `check`: the check run with its weights and what it shows. A later step is null until it is taken.
`withdrawn`: trial runs that were taken back, with who did and why, missing in older ones.
"""

from collections.abc import Sequence
from typing import Any, cast

from sqlalchemy import select
from sqlalchemy.orm import Session

from estimator.errors import Missing
from storage.clock import now
from storage.paging import Keys, ordered
from storage.tables.machines import BalancingRow

BEGUN, TRIED, PROPOSED, CHECKED = "begun", "tried", "proposed", "checked"
"""States of a balancing: the step taken last."""


class BalancingUnknown(Missing):
    """Raised when a machine has no balancing of this id."""

    subject = "balancing"


def add(
    session: Session,
    machine_id: str,
    *,
    revision: int,
    initial: Sequence[int],
    by: str,
    comment: str,
    disc_scale: dict[str, Any] | None = None,
) -> BalancingRow:
    """Begin a balancing with its initial runs."""
    moment = now()
    row = BalancingRow(
        machine_id=machine_id,
        revision=revision,
        state=BEGUN,
        steps={"disc_scale": disc_scale or {}, "initial": list(initial), "trials": [], "correction": None, "check": None},
        by=by,
        comment=comment,
        created_at=moment,
        updated_at=moment,
    )
    session.add(row)
    session.flush()
    return row


def get(session: Session, machine_id: str, balancing_id: int, *, to_change: bool = False) -> BalancingRow:
    """Return a machine's balancing, locked when `to_change`. Raises BalancingUnknown."""
    row = session.get(BalancingRow, balancing_id, with_for_update=to_change or None)
    if row is None or row.machine_id != machine_id:
        raise BalancingUnknown(balancing_id)
    return row


def of_machine(session: Session, machine_id: str, *, limit: int, after: Keys | None = None) -> Sequence[BalancingRow]:
    """Return a machine's balancings, newest first. after: the id of the last one of the page before."""
    query = select(BalancingRow).where(BalancingRow.machine_id == machine_id)
    return session.scalars(ordered(query, (BalancingRow.id,), after).limit(limit)).all()


def record(row: BalancingRow, state: str, **steps: Any) -> None:
    """Record a step; those that follow from it and were taken before are given as None."""
    row.steps = row.steps | steps
    row.state = state
    row.updated_at = now()


def withdrawn(row: BalancingRow) -> list[dict[str, Any]]:
    """Return the trial runs that were taken back."""
    return cast(list[dict[str, Any]], row.steps.get("withdrawn") or [])


def withdraw(row: BalancingRow, trial: dict[str, Any], *, by: str, comment: str) -> None:
    """Take a trial run back, with what was computed from it; it stays on record.

    trial: the trial as the balancing's steps hold it. by, comment: who does it, and why.
    """
    correction = row.steps["correction"]
    planes = [] if correction is None else correction["result"]["planes"]
    given_up = [{key: one[key] for key in ("disc", "g_mm", "angle_deg")} for one in planes]
    record_of_it = trial | {"withdrawn_by": by, "comment": comment, "at": now(), "given_up": given_up}
    trials = [one for one in row.steps["trials"] if one != trial]
    record(
        row,
        TRIED if trials else BEGUN,
        trials=trials,
        withdrawn=[*withdrawn(row), record_of_it],
        correction=None,
        check=None,
    )
