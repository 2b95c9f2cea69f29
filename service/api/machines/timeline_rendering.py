"""Renders entries on a timeline and baselines as answers of the API."""

from service.api.machines import timeline_schemas as schemas
from storage.clock import to_datetime
from storage.tables.machines import BaselineRow, TimelineRow


def timeline_entry(row: TimelineRow) -> schemas.TimelineOut:
    """Return an entry of a timeline as the API shows it."""
    return schemas.TimelineOut(
        id=row.id,
        machine=row.machine_id,
        at=to_datetime(row.at),
        kind=row.kind,
        text=row.text,
        by=row.by,
        created_at=to_datetime(row.created_at),
    )


def baseline(row: BaselineRow) -> schemas.BaselineOut:
    """Return a baseline as the API shows it."""
    return schemas.BaselineOut(
        id=row.id,
        machine=row.machine_id,
        since=to_datetime(row.since),
        identifications=row.identification_ids,
        reason=row.reason,
        by=row.by,
        created_at=to_datetime(row.created_at),
    )
