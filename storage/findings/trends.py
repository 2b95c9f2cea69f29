"""Histories of parameters in columns, from which trends are drawn."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import func, null, select
from sqlalchemy.orm import Session

from estimator.arrays import Floats
from storage.findings.identifications import counted_ids
from storage.measurements.runs import DISCARDED
from storage.paging import Keys, between, ordered
from storage.tables.findings import DerivedRow, EstimateRow, IdentificationRow
from storage.tables.machines import BaselineRow, MachineRow
from storage.tables.measurements import RunRow

Integers = NDArray[np.int64]
Texts = NDArray[np.object_]

TABLES = (
    "machines",
    "machine_revisions",
    "runs",
    "identifications",
    "estimates",
    "derived_quantities",
    "baselines",
)
"""Tables from which histories, and the baselines they are compared with, are read."""
HistoryStamp = tuple[int | None, ...]
"""A stamp that stays equal as long as nothing was stored that could change a machine's histories or their baselines."""


@dataclass(frozen=True)
class ParameterHistory:
    """One parameter or derived quantity at n identifications, oldest first; (n,) each.

    Times [ns since 1970]; NaN: no value. standard_error: standard error of a parameter's value; imaginary: imaginary part of
    an unbalance, whose value is the real part.
    """

    unit: str | None
    measured_at: Integers
    computed_at: Integers
    value: Floats
    standard_error: Floats
    lower: Floats
    upper: Floats
    imaginary: Floats
    accepted: NDArray[np.bool_]
    run_kind: Texts
    identification: Integers
    revision: Integers
    slow_roll_version: Integers
    """Version of the slow-roll vectors that were subtracted; 0 for none."""
    load_balance: Integers
    """Version of the balance of loads on oil films; 0 for none."""

    def __len__(self) -> int:
        return len(self.measured_at)


@dataclass(frozen=True)
class HistoryPoint:
    """One point of a history. Times [ns since 1970]; value: for an unbalance, its magnitude."""

    measured_at: int
    identification: int
    computed_at: int
    accepted: bool
    value: float | None
    lower: float | None
    upper: float | None


def histories(session: Session, machine_id: str, names: Sequence[str], *, scope: str) -> dict[str, ParameterHistory]:
    """Return the whole history of each parameter or derived quantity, one point per run, see `identifications.counting`.

    Unknown names have an empty history.
    """
    found = {
        name: _history(list(rows)) for name, rows in groupby(_rows(session, machine_id, names, scope), key=lambda row: row[0])
    }
    return {name: found.get(name, _NOTHING) for name in names}


def page(
    session: Session,
    machine_id: str,
    name: str,
    *,
    derived: bool,
    scope: str,
    first: int,
    last: int,
    after: Keys | None,
    descending: bool,
    limit: int,
) -> list[HistoryPoint]:
    """Return a page of a history between two times [ns], see `histories`.

    derived: whether it is a derived quantity, not a parameter. after: (time, identification) of the last point of the page
    before.
    """
    table, named = (DerivedRow, DerivedRow.name) if derived else (EstimateRow, EstimateRow.parameter)
    identification = IdentificationRow
    columns = table.measured_at, identification.id, identification.computed_at, identification.accepted
    imaginary = null().label("imaginary") if derived else EstimateRow.imaginary
    query: Any = select(*columns, table.value, table.lower, table.upper, imaginary)
    query = query.join(identification, identification.id == table.identification_id)
    query = query.where(table.machine_id == machine_id, named == name, identification.scope == scope)
    query = query.where(identification.id.in_(counted_ids(machine_id)))
    query = between(query, table.measured_at, first, last)
    query = ordered(query, (table.measured_at, table.identification_id), after, descending=descending)
    return [
        HistoryPoint(
            measured_at=row.measured_at,
            identification=row.id,
            computed_at=row.computed_at,
            accepted=row.accepted,
            value=row.value if row.imaginary is None else math.hypot(row.value, row.imaginary),
            lower=row.lower,
            upper=row.upper,
        )
        for row in session.execute(query.limit(limit))
    ]


def _rows(session: Session, machine_id: str, names: Sequence[str], scope: str) -> Iterator[Sequence[Any]]:
    """Yield rows by name and time: estimates, then derived quantities, whose names are distinct."""
    estimate, derived = EstimateRow, DerivedRow
    of_estimate = estimate.parameter, estimate.unit, estimate.measured_at, estimate.value, estimate.lower, estimate.upper
    of_derived = derived.name, derived.unit, derived.measured_at, derived.value, derived.lower, derived.upper
    nothing = null(), null()
    for table, columns, errors in (
        (estimate, of_estimate, (estimate.standard_error, estimate.imaginary)),
        (derived, of_derived, nothing),
    ):
        identification = IdentificationRow
        query = (
            select(
                *columns,
                *errors,
                identification.computed_at,
                identification.accepted,
                identification.run_kind,
                identification.id,
                identification.revision,
                identification.slow_roll_version,
                identification.load_balance,
            )
            .join(identification, identification.id == table.identification_id)
            .where(table.machine_id == machine_id, columns[0].in_(names))
            .where(identification.scope == scope, identification.id.in_(counted_ids(machine_id)))
            .order_by(columns[0], table.measured_at, table.identification_id)
        )
        yield from session.execute(query)


def stamp(session: Session, machine_id: str) -> HistoryStamp:
    """Return the stamp of everything that a machine's histories depend on."""
    newest = select(func.max(IdentificationRow.id)).where(IdentificationRow.machine_id == machine_id)
    gone = select(RunRow.id).where(RunRow.machine_id == machine_id, RunRow.state == DISCARDED).subquery()
    baseline = select(func.max(BaselineRow.id)).where(BaselineRow.machine_id == machine_id)
    revision = select(MachineRow.revision).where(MachineRow.id == machine_id)
    counted = select(func.count(gone.c.id)), select(func.sum(gone.c.id))
    parts = (newest, *counted, baseline, revision)
    (row,) = session.execute(select(*(part.scalar_subquery() for part in parts))).all()
    return tuple(row)


def _history(rows: Sequence[Sequence[object]]) -> ParameterHistory:
    columns = list(zip(*rows, strict=True)) or [()] * 15
    _, units, measured, value, lower, upper, error, imaginary, computed, accepted, kind, number, revision, version, balance = (
        columns
    )
    return ParameterHistory(
        unit=str(units[0]) if units else None,
        measured_at=np.array(measured, np.int64),
        computed_at=np.array(computed, np.int64),
        value=np.array(value, np.float64),
        standard_error=np.array(error, np.float64),
        lower=np.array(lower, np.float64),
        upper=np.array(upper, np.float64),
        imaginary=np.array(imaginary, np.float64),
        accepted=np.array(accepted, np.bool_),
        run_kind=np.array(kind, np.object_),
        identification=np.array(number, np.int64),
        revision=np.array(revision, np.int64),
        slow_roll_version=np.array([one or 0 for one in version], np.int64),
        load_balance=np.array([one or 0 for one in balance], np.int64),
    )


_NOTHING = _history([])
