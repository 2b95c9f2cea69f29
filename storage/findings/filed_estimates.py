"""Repository of identified values in the order of filing, for readers that poll for new ones."""

from collections.abc import Collection, Sequence
from typing import Any

from sqlalchemy import Row, func, null, select, union_all
from sqlalchemy.orm import Session

from storage.clock import now
from storage.findings.jobs import GATHERED, RUN
from storage.tables.findings import DerivedRow, EstimateRow, IdentificationRow

HELD_BACK_NS = 2_000_000_000
"""Age from which on one is listed [ns]: several replicas file at once, and a number may be stored after a later one."""


def filed(
    session: Session,
    *,
    after: int,
    limit: int,
    since: int | None = None,
    newest: bool = False,
    held_back_ns: int = HELD_BACK_NS,
) -> Sequence[IdentificationRow]:
    """Return identifications of runs, single or gathered, with a higher id than `after`, oldest first.

    since: computed at that time or later [ns]. newest: where there are more than `limit`, the newest of them.
    """
    row = IdentificationRow
    query = select(row).where(row.id > after, row.scope.in_((RUN, GATHERED)), row.computed_at <= now() - held_back_ns)
    if since is not None:
        query = query.where(row.computed_at >= since)
    if newest:
        return session.scalars(query.order_by(row.id.desc()).limit(limit)).all()[::-1]
    return session.scalars(query.order_by(row.id).limit(limit)).all()


def newest_of_each_machine(session: Session) -> Sequence[IdentificationRow]:
    """Return of each machine the newest accepted identification of a single run."""
    row = IdentificationRow
    accepted = select(row.machine_id, func.max(row.measured_at).label("at")).where(row.scope == RUN, row.accepted)
    newest = accepted.group_by(row.machine_id).subquery()
    found = select(func.max(row.id)).join(newest, (row.machine_id == newest.c.machine_id) & (row.measured_at == newest.c.at))
    ids = found.where(row.scope == RUN, row.accepted).group_by(row.machine_id)
    return session.scalars(select(row).where(row.id.in_(ids)).order_by(row.id)).all()


def newest_id(session: Session) -> int:
    """Return the id of the newest identification; 0 before any."""
    return session.scalar(select(func.max(IdentificationRow.id))) or 0


def values_of(session: Session, identifications: Collection[int]) -> Sequence[Row[Any]]:
    """Return estimates and derived quantities of identifications, by identification and name.

    Columns: identification, parameter, unit, value, standard_error, lower, upper, imaginary.
    """
    estimate, derived = EstimateRow, DerivedRow
    both = union_all(
        select(
            estimate.identification_id.label("identification"),
            estimate.parameter.label("parameter"),
            estimate.unit.label("unit"),
            estimate.value.label("value"),
            estimate.standard_error.label("standard_error"),
            estimate.lower.label("lower"),
            estimate.upper.label("upper"),
            estimate.imaginary.label("imaginary"),
        ).where(estimate.identification_id.in_(identifications)),
        select(
            derived.identification_id,
            derived.name,
            derived.unit,
            derived.value,
            null(),
            derived.lower,
            derived.upper,
            null(),
        ).where(derived.identification_id.in_(identifications)),
    ).subquery()
    return session.execute(select(both).order_by(both.c.identification, both.c.parameter)).all()
