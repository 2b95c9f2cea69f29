"""Histories of parameters in columns: what a trend is drawn from."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from numpy.typing import NDArray
from sqlalchemy import func, select
from sqlalchemy.orm import Session

from storage.identifications import counting
from storage.runs import DISCARDED
from storage.tables import BaselineRow, EstimateRow, IdentificationRow, MachineRow, RunRow

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Texts = NDArray[np.object_]

Stamp = tuple[int | None, ...]
"""Equal as long as nothing was stored that could change a machine's histories or what they are compared with."""


@dataclass(frozen=True)
class History:
    """One parameter over n identifications, oldest first; (n,) each. Times in ns since 1970; NaN where there is no value.

    standard_error: of the value; imaginary: of an unbalance, whose value is the real part.
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
    """0: none was subtracted."""

    def __len__(self) -> int:
        return len(self.measured_at)


def histories(session: Session, machine_id: str, parameters: Sequence[str], *, scope: str) -> dict[str, History]:
    """The whole history of each parameter: one point per run, see `identifications.counting`. Unknown ones are empty."""
    identification = IdentificationRow
    query = (
        select(
            EstimateRow.parameter,
            EstimateRow.unit,
            EstimateRow.measured_at,
            identification.computed_at,
            EstimateRow.value,
            EstimateRow.standard_error,
            EstimateRow.lower,
            EstimateRow.upper,
            EstimateRow.imaginary,
            identification.accepted,
            identification.run_kind,
            identification.id,
            identification.revision,
            identification.slow_roll_version,
        )
        .join(identification, identification.id == EstimateRow.identification_id)
        .where(EstimateRow.machine_id == machine_id, EstimateRow.parameter.in_(parameters))
        .where(identification.scope == scope, identification.id.in_(counting(machine_id)))
        .order_by(EstimateRow.parameter, EstimateRow.measured_at, EstimateRow.identification_id)
    )
    found = {name: _history(list(rows)) for name, rows in groupby(session.execute(query), key=lambda row: row[0])}
    return {name: found.get(name, _NOTHING) for name in parameters}


def stamp(session: Session, machine_id: str) -> Stamp:
    """What a machine's histories depend on, in a few numbers."""
    newest = select(func.max(IdentificationRow.id)).where(IdentificationRow.machine_id == machine_id)
    gone = select(RunRow.id).where(RunRow.machine_id == machine_id, RunRow.state == DISCARDED).subquery()
    baseline = select(func.max(BaselineRow.id)).where(BaselineRow.machine_id == machine_id)
    revision = select(MachineRow.revision).where(MachineRow.id == machine_id)
    counted = select(func.count(gone.c.id)), select(func.sum(gone.c.id))
    parts = (newest, *counted, baseline, revision)
    (row,) = session.execute(select(*(part.scalar_subquery() for part in parts))).all()
    return tuple(row)


def _history(rows: Sequence[Sequence[object]]) -> History:
    columns = list(zip(*rows, strict=True)) or [()] * 14
    _, units, measured, computed, value, error, lower, upper, imaginary, accepted, kind, number, revision, version = columns
    return History(
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
    )


_NOTHING = _history([])
