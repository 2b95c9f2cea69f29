"""Tables of machines: documents, slow-roll vectors, limits, baselines, calibrations, notes, field balancings."""

from typing import Any

from sqlalchemy import ForeignKey, Index, Text
from sqlalchemy.orm import Mapped, mapped_column

from storage.tables.base import Base, Name, RowKey


class MachineRow(Base):
    """A machine and the revision of its document that is in force."""

    __tablename__ = "machines"

    id: Mapped[str] = mapped_column(Name(64), primary_key=True)
    plant: Mapped[str] = mapped_column(Name(64))
    revision: Mapped[int]
    created_at: Mapped[int]
    slow_roll_version: Mapped[int | None]
    """Version of the slow-roll vectors that new identifications subtract."""
    blocks_since: Mapped[int | None]
    """Sample blocks that ended before this time were deleted, see `storage.operation.retention`; null for none."""


class SlowRollRow(Base):
    """Slow-roll vectors of a machine's channels; never changed. Samples and runs keep the measured values, without them."""

    __tablename__ = "slow_roll_vectors"

    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"), primary_key=True)
    version: Mapped[int] = mapped_column(primary_key=True)
    created_at: Mapped[int]
    origin: Mapped[str] = mapped_column(Name(16))
    direction: Mapped[int]
    vectors: Mapped[dict[str, Any]]
    """Per channel real and imaginary part, rms of the complex error [m] and its probe, or why there is no vector."""
    speed_minimum: Mapped[float | None]
    speed_maximum: Mapped[float | None]
    time_first: Mapped[int | None]
    time_last: Mapped[int | None]
    comment: Mapped[str] = mapped_column(Text)


class RevisionRow(Base):
    """One revision of a machine's document; never changed."""

    __tablename__ = "machine_revisions"
    __table_args__ = (Index(None, "machine_id", "same_since", "alike_since", "revision"),)

    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"), primary_key=True)
    revision: Mapped[int] = mapped_column(primary_key=True)
    document: Mapped[dict[str, Any]]
    created_at: Mapped[int]
    same_since: Mapped[int] = mapped_column(server_default="1")
    """First of the contiguous revisions up to this one that describe the same train."""
    alike_since: Mapped[int] = mapped_column(server_default="1")
    """First of the contiguous revisions up to this one with the same train and the same operating conditions."""


class TimelineRow(Base):
    """A note or a marker, such as a maintenance, on a machine's timeline."""

    __tablename__ = "timeline"
    __table_args__ = (Index(None, "machine_id", "at"),)

    id: Mapped[int] = mapped_column(RowKey, primary_key=True)
    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"))
    at: Mapped[int]
    kind: Mapped[str] = mapped_column(Name(32))
    text: Mapped[str] = mapped_column(Text)
    by: Mapped[str] = mapped_column(Name(120))
    created_at: Mapped[int]


class CalibrationRow(Base):
    """A calibration of a channel: when, by whom, and with which certificate. Never changed."""

    __tablename__ = "calibrations"
    __table_args__ = (Index(None, "machine_id", "at"),)

    id: Mapped[int] = mapped_column(RowKey, primary_key=True)
    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"))
    channel: Mapped[str] = mapped_column(Name(64))
    at: Mapped[int]
    certificate: Mapped[str] = mapped_column(Text)
    by: Mapped[str] = mapped_column(Name(120))
    created_at: Mapped[int]


class BalancingRow(Base):
    """A field balancing, from its initial runs to its check run; each step stays as it was entered and computed."""

    __tablename__ = "balancings"
    __table_args__ = (Index(None, "machine_id", "id"),)

    id: Mapped[int] = mapped_column(RowKey, primary_key=True)
    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"))
    revision: Mapped[int]
    """Revision of the document under which all its runs were measured."""
    state: Mapped[str] = mapped_column(Name(16))
    steps: Mapped[dict[str, Any]]
    """Initial runs, trials with their weights, the correction and the check run, as in `storage.machines.balancings`."""
    by: Mapped[str] = mapped_column(Name(120))
    comment: Mapped[str] = mapped_column(Text)
    created_at: Mapped[int]
    updated_at: Mapped[int]


class ModelCalibrationRow(Base):
    """A calibration of a machine's model from runs with known unbalances: what was asked, and what came of it."""

    __tablename__ = "model_calibrations"
    __table_args__ = (Index(None, "machine_id", "id"),)

    id: Mapped[int] = mapped_column(RowKey, primary_key=True)
    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"))
    revision: Mapped[int]
    """Revision of the document that it begins from."""
    job_id: Mapped[int | None] = mapped_column(ForeignKey("identification_jobs.id"))
    asked: Mapped[dict[str, Any]]
    """Runs with their weights and the seed, as in `storage.machines.model_calibrations`."""
    by: Mapped[str] = mapped_column(Name(120))
    comment: Mapped[str] = mapped_column(Text)
    created_at: Mapped[int]
    # Null until it is computed.
    computed_at: Mapped[int | None]
    accepted: Mapped[bool | None]
    verdict: Mapped[str | None] = mapped_column(Text)
    result: Mapped[dict[str, Any] | None]
    """Remarks, starts, and whether the optimum was found twice."""
    document: Mapped[dict[str, Any] | None] = mapped_column(deferred=True)
    """The machine's document with the calibration."""
    code_version: Mapped[str | None] = mapped_column(Name(64))
    revision_in_force: Mapped[int | None]
    """Revision of the document by which it was last put in force; null: never."""


class BaselineRow(Base):
    """A baseline: the first identifications from `since` on, or the named ones.

    Never changed: a newer one replaces it and this one stays readable.
    """

    __tablename__ = "baselines"
    __table_args__ = (Index(None, "machine_id", "since"),)

    id: Mapped[int] = mapped_column(RowKey, primary_key=True)
    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"))
    since: Mapped[int]
    identification_ids: Mapped[list[int] | None]
    reason: Mapped[str] = mapped_column(Text)
    by: Mapped[str] = mapped_column(Name(120))
    created_at: Mapped[int]


class LimitsRow(Base):
    """One version of the limits that a person set for a machine; never changed. The newest is in force."""

    __tablename__ = "limits"

    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"), primary_key=True)
    version: Mapped[int] = mapped_column(primary_key=True)
    document: Mapped[dict[str, Any]]
    """Limits as in `service.monitoring.rules.limits`, complete: later defaults change nothing that was set."""
    at: Mapped[int]
    by: Mapped[str] = mapped_column(Name(120))
    comment: Mapped[str] = mapped_column(Text)
