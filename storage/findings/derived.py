"""Repository of the quantities derived from identifications; for their history see `storage.findings.trends`."""

from collections.abc import Collection, Sequence

from sqlalchemy import insert, select
from sqlalchemy.orm import Session

from estimator.updated_model.derived_quantities import Derived
from storage.tables.findings import DerivedRow, IdentificationRow


def add(session: Session, identification: IdentificationRow, quantities: Sequence[Derived]) -> None:
    """Store the quantities derived from a stored identification, in their order."""
    rows = [
        {
            "identification_id": identification.id,
            "name": one.name,
            "place": place,
            "machine_id": identification.machine_id,
            "measured_at": identification.measured_at,
            "unit": one.unit,
            "value": one.value,
            "lower": one.lower,
            "upper": one.upper,
            "reason": one.reason,
        }
        for place, one in enumerate(quantities)
    ]
    if rows:  # bulk insert: as ORM objects they would take several times as long within the writer's turn
        session.execute(insert(DerivedRow), rows)


def of_identification(session: Session, identification_id: int) -> Sequence[DerivedRow]:
    """Return all quantities derived from one identification, in the order in which they were stored."""
    query = select(DerivedRow).where(DerivedRow.identification_id == identification_id).order_by(DerivedRow.place)
    return session.scalars(query).all()


def one(session: Session, identification_id: int, name: str) -> DerivedRow | None:
    """Return one derived quantity; None when there is none."""
    return session.get(DerivedRow, (identification_id, name))


def several(
    session: Session, identification_ids: Collection[int], names: Collection[str]
) -> dict[tuple[int, str], DerivedRow]:
    """Return those of these quantities that identifications have, by identification and name: in one query."""
    chosen = DerivedRow.identification_id.in_(identification_ids), DerivedRow.name.in_(names)
    return {(row.identification_id, row.name): row for row in session.scalars(select(DerivedRow).where(*chosen))}
