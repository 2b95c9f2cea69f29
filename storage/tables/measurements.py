"""Tables of measurements: sources, samples, states, runs and rejected input."""

from typing import Any

from sqlalchemy import ForeignKey, ForeignKeyConstraint, Index, LargeBinary, Text, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column

from storage.tables.base import Base, Name, RowKey


class SourceRow(Base):
    """Reception state of one start (epoch) of one source."""

    __tablename__ = "sources"

    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"), primary_key=True)
    source: Mapped[str] = mapped_column(Name(64), primary_key=True)
    epoch: Mapped[int] = mapped_column(primary_key=True)
    next_sequence: Mapped[int]
    received: Mapped[int]
    duplicates: Mapped[int]
    lost: Mapped[int]
    late: Mapped[int]
    last_time: Mapped[int]
    last_received_at: Mapped[int | None]
    """Arrival of the newest samples, by the service's clock [ns]; `last_time` is by the source's."""
    missing: Mapped[list[list[int]] | None]
    """Sequence gaps that may still be filled: [first, last, after, before], the latter two times [ns]."""


class SampleBlockRow(Base):
    """Samples of one source that were stored together, compressed; see `storage.encoding.sample_blocks`."""

    __tablename__ = "sample_blocks"
    __table_args__ = (
        UniqueConstraint("machine_id", "source", "epoch", "first_sequence"),
        ForeignKeyConstraint(["machine_id", "revision"], ["machine_revisions.machine_id", "machine_revisions.revision"]),
        Index(None, "machine_id", "time_last"),
    )

    id: Mapped[int] = mapped_column(RowKey, primary_key=True)
    machine_id: Mapped[str] = mapped_column(Name(64))
    revision: Mapped[int]
    source: Mapped[str] = mapped_column(Name(64))
    epoch: Mapped[int]
    first_sequence: Mapped[int]
    count: Mapped[int]
    time_first: Mapped[int]
    time_last: Mapped[int]
    received_at: Mapped[int | None]
    """Arrival of the last of the samples, by the service's clock [ns]; null in blocks of older releases."""
    data: Mapped[bytes] = mapped_column(LargeBinary)


class CollectorRow(Base):
    """State of a machine's run collection, stored with the samples that led to it."""

    __tablename__ = "collectors"

    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"), primary_key=True)
    state: Mapped[dict[str, Any]]


class MachineStateRow(Base):
    """Operating mode of a machine from a time on, until the next row."""

    __tablename__ = "machine_states"
    __table_args__ = (Index(None, "machine_id", "since"),)

    id: Mapped[int] = mapped_column(RowKey, primary_key=True)
    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"))
    since: Mapped[int]
    mode: Mapped[str] = mapped_column(Name(16))
    speed: Mapped[float | None]


class RunRow(Base):
    """A run-up, a run-down or a rolling collection. Once closed it holds its own samples; late ones rebuild it."""

    __tablename__ = "runs"
    __table_args__ = (
        UniqueConstraint("machine_id", "time_first"),
        ForeignKeyConstraint(["machine_id", "revision"], ["machine_revisions.machine_id", "machine_revisions.revision"]),
        Index(None, "state"),
        Index(None, "time_first"),
        Index(None, "machine_id", "state"),
    )

    id: Mapped[int] = mapped_column(RowKey, primary_key=True)
    machine_id: Mapped[str] = mapped_column(Name(64))
    revision: Mapped[int]
    kind: Mapped[str] = mapped_column(Name(16))
    direction: Mapped[int]
    state: Mapped[str] = mapped_column(Name(16))
    reason: Mapped[str | None] = mapped_column(Text)
    time_first: Mapped[int]
    time_last: Mapped[int | None]
    speed_minimum: Mapped[float | None]
    speed_maximum: Mapped[float | None]
    count: Mapped[int | None]
    data: Mapped[bytes | None] = mapped_column(LargeBinary, deferred=True)
    extent: Mapped[dict[str, Any] | None] = mapped_column(deferred=True)
    """Samples that an ended run is to be made of, see `storage.measurements.runs`; null before its end and once closed."""
    # Null in runs collected by older releases.
    reopened_at: Mapped[int | None]
    """Time of the last rebuild by late samples."""
    times_reopened: Mapped[int | None]
    coverage: Mapped[dict[str, Any] | None]
    quality: Mapped[dict[str, Any] | None]
    flags: Mapped[bytes | None] = mapped_column(LargeBinary, deferred=True)
    """Flags of each point of each channel, see `storage.measurements.runs`."""
    released_at: Mapped[int | None]
    """Time at which its samples were deleted, see `storage.operation.retention`; null while it has them."""


class QuarantineRow(Base):
    """A rejected message or sample, as far as it is kept, and the reason."""

    __tablename__ = "quarantine"
    __table_args__ = (Index(None, "reason"),)

    id: Mapped[int] = mapped_column(RowKey, primary_key=True)
    received_at: Mapped[int]
    key: Mapped[str] = mapped_column(Name(512))
    machine_id: Mapped[str | None] = mapped_column(Name(64))
    reason: Mapped[str] = mapped_column(Name(32))
    detail: Mapped[str] = mapped_column(Text)
    size: Mapped[int]
    payload: Mapped[bytes] = mapped_column(LargeBinary)


class QuarantineCountRow(Base):
    """Number of rejections so far for each reason, kept or not."""

    __tablename__ = "quarantine_counts"

    reason: Mapped[str] = mapped_column(Name(32), primary_key=True)
    count: Mapped[int]
