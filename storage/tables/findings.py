"""Tables of identification jobs, their results and the findings derived from them."""

from typing import Any

from sqlalchemy import ForeignKey, ForeignKeyConstraint, Index, LargeBinary, Text
from sqlalchemy.orm import Mapped, mapped_column

from storage.tables.base import Base, Name, RowKey

DONE, FAILED, QUARANTINED = "done", "failed", "quarantined"
"""Final states of a job; one that crashed its process or exceeded its time or memory too often ends as quarantined."""


class JobRow(Base):
    """An identification job: queued, running or finished. options: the settings that differ from the usual ones."""

    __tablename__ = "identification_jobs"
    __table_args__ = (
        Index(None, "state", "priority", "turn", "id"),
        Index(None, "state", "priority", "plant", "turn"),
        Index(None, "machine_id", "state"),
        Index(None, "asked_by", "state"),
    )

    id: Mapped[int] = mapped_column(RowKey, primary_key=True)
    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"))
    plant: Mapped[str] = mapped_column(Name(64), server_default="?")
    priority: Mapped[int] = mapped_column(server_default="0")
    """Determines with `turn` when the job is taken, see `storage.findings.job_order`."""
    turn: Mapped[int] = mapped_column(server_default="0")
    asked_by: Mapped[str | None] = mapped_column(Name(255))
    """Identity of the person who requested it; null when the service did by itself."""
    scope: Mapped[str] = mapped_column(Name(16))
    run_ids: Mapped[list[int]]
    request: Mapped[str] = mapped_column(Name(200), unique=True)
    state: Mapped[str] = mapped_column(Name(16))
    attempts: Mapped[int]
    created_at: Mapped[int]
    finished_at: Mapped[int | None]
    error: Mapped[str | None] = mapped_column(Text)
    options: Mapped[dict[str, Any] | None]
    holder: Mapped[int | None]
    """Number of the replica that computes it, see `storage.operation.replicas`."""


class IdentificationRow(Base):
    """One finished fit, with all that is needed to repeat it."""

    __tablename__ = "identifications"
    __table_args__ = (
        ForeignKeyConstraint(["machine_id", "revision"], ["machine_revisions.machine_id", "machine_revisions.revision"]),
        Index(None, "machine_id", "measured_at"),
        Index(None, "computed_at"),
    )

    id: Mapped[int] = mapped_column(RowKey, primary_key=True)
    machine_id: Mapped[str] = mapped_column(Name(64))
    revision: Mapped[int]
    job_id: Mapped[int] = mapped_column(ForeignKey("identification_jobs.id"), unique=True)
    scope: Mapped[str] = mapped_column(Name(16))
    run_kind: Mapped[str] = mapped_column(Name(16))
    run_ids: Mapped[list[int]]
    measured_at: Mapped[int]
    computed_at: Mapped[int]
    accepted: Mapped[bool]
    verdict: Mapped[str] = mapped_column(Text)
    chi_square: Mapped[float]
    degrees_of_freedom: Mapped[int]
    condition_number: Mapped[float]
    samples: Mapped[int]
    speed_minimum: Mapped[float]
    speed_maximum: Mapped[float]
    starts: Mapped[int]
    iterations: Mapped[int]
    options: Mapped[dict[str, Any]]
    code_version: Mapped[str] = mapped_column(Name(64))
    coordinates: Mapped[list[str]]
    covariance: Mapped[bytes] = mapped_column(LargeBinary, deferred=True)
    # Null for identifications by older releases.
    noise_relative: Mapped[float | None]
    noise_floor: Mapped[float | None]
    outliers: Mapped[dict[str, Any] | None]
    point: Mapped[bytes | None] = mapped_column(LargeBinary, deferred=True)
    slow_roll_version: Mapped[int | None]
    channel_effects: Mapped[bytes | None] = mapped_column(LargeBinary, deferred=True)
    load_balance: Mapped[int | None]
    """Version of the balance of loads on oil films that the values follow from; null where couplings and pedestals are known,
    without films, and by releases before the second."""
    conditions: Mapped[dict[str, Any] | None]
    """Mean of each operating condition over the runs, null for one not measured; null as a whole without any."""


class DiagnosisRow(Base):
    """The diagnosis of an identification when it was filed. baseline: ids of those it was compared with."""

    __tablename__ = "diagnoses"
    __table_args__ = (Index(None, "machine_id", "measured_at"),)

    identification_id: Mapped[int] = mapped_column(ForeignKey("identifications.id"), primary_key=True)
    machine_id: Mapped[str] = mapped_column(Name(64))
    measured_at: Mapped[int]
    made_at: Mapped[int]
    baseline: Mapped[list[int]]
    runs: Mapped[int]
    causes: Mapped[list[dict[str, Any]]]


class EstimateRow(Base):
    """One parameter of one identification, a point of its history. Values are null when the data do not determine them."""

    __tablename__ = "estimates"
    __table_args__ = (Index(None, "machine_id", "parameter", "measured_at"),)

    identification_id: Mapped[int] = mapped_column(ForeignKey("identifications.id"), primary_key=True)
    parameter: Mapped[str] = mapped_column(Name(160), primary_key=True)
    machine_id: Mapped[str] = mapped_column(Name(64))
    measured_at: Mapped[int]
    quantity: Mapped[str] = mapped_column(Name(32))
    element: Mapped[str] = mapped_column(Name(80))
    unit: Mapped[str] = mapped_column(Name(16))
    value: Mapped[float | None]
    standard_error: Mapped[float | None]
    lower: Mapped[float | None]
    upper: Mapped[float | None]
    imaginary: Mapped[float | None]
    imaginary_standard_error: Mapped[float | None]
    reason: Mapped[str | None] = mapped_column(Text)


class DerivedRow(Base):
    """One quantity derived from an identification. Values may be null, for a `reason`."""

    __tablename__ = "derived_quantities"
    __table_args__ = (Index(None, "machine_id", "name", "measured_at"),)

    identification_id: Mapped[int] = mapped_column(ForeignKey("identifications.id"), primary_key=True)
    name: Mapped[str] = mapped_column(Name(160), primary_key=True)
    place: Mapped[int]
    machine_id: Mapped[str] = mapped_column(Name(64))
    measured_at: Mapped[int]
    unit: Mapped[str] = mapped_column(Name(16))
    value: Mapped[float | None]
    lower: Mapped[float | None]
    upper: Mapped[float | None]
    reason: Mapped[str | None] = mapped_column(Text)
