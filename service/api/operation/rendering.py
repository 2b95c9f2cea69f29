"""Renders sources and quarantined input as answers of the API."""

from service.api.conventions.values import time_or_none
from service.api.operation import schemas
from service.api.operation.refusal_words import refusal_words
from storage.clock import to_datetime
from storage.tables.measurements import QuarantineRow, SourceRow


def source(row: SourceRow) -> schemas.SourceOut:
    """Return a source as the API shows it."""
    return schemas.SourceOut(
        machine=row.machine_id,
        source=row.source,
        epoch=row.epoch,
        next_sequence=row.next_sequence,
        received=row.received,
        duplicates=row.duplicates,
        lost=row.lost,
        late=row.late,
        newest_sample_at=time_or_none(row.last_time or None),
        newest_received_at=time_or_none(row.last_received_at),
    )


def quarantine_entry(row: QuarantineRow) -> schemas.QuarantineEntry:
    """Return a quarantined message as the API shows it."""
    return schemas.QuarantineEntry(
        id=row.id,
        received_at=to_datetime(row.received_at),
        key=row.key,
        machine=row.machine_id,
        reason=row.reason,
        meaning=refusal_words(row.reason),
        detail=row.detail,
        size=row.size,
        payload=row.payload.decode("utf-8", "backslashreplace"),
    )
