"""The tables. Times are nanoseconds since 1970 in UTC; physical values are SI."""

from typing import Any

from sqlalchemy import (
    JSON,
    BigInteger,
    ForeignKey,
    ForeignKeyConstraint,
    Index,
    Integer,
    LargeBinary,
    MetaData,
    String,
    Text,
    UniqueConstraint,
    false,
    text,
)
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column

# SQLite numbers only INTEGER primary keys by itself.
Key = BigInteger().with_variant(Integer, "sqlite")

NAMING = {
    "ix": "ix_%(table_name)s_%(column_0_N_name)s",
    "uq": "uq_%(table_name)s_%(column_0_N_name)s",
    "fk": "fk_%(table_name)s_%(column_0_N_name)s",
    "pk": "pk_%(table_name)s",
}


class Base(DeclarativeBase):
    """Parent of all tables."""

    metadata = MetaData(naming_convention=NAMING)
    type_annotation_map = {  # noqa: RUF012
        int: BigInteger,
        dict[str, Any]: JSON,
        list[int]: JSON,
        list[str]: JSON,
        list[list[int]]: JSON,
        list[list[str]]: JSON,
        list[dict[str, Any]]: JSON,
    }


class MachineRow(Base):
    """A machine and the revision of its document that is in force."""

    __tablename__ = "machines"

    id: Mapped[str] = mapped_column(String(64), primary_key=True)
    plant: Mapped[str] = mapped_column(String(64))
    revision: Mapped[int]
    created_at: Mapped[int]
    slow_roll_version: Mapped[int | None]
    """Slow-roll vectors that new identifications subtract."""


class SlowRollRow(Base):
    """Slow-roll vectors of a machine's channels; never changed. Samples and runs keep what was measured, without them."""

    __tablename__ = "slow_roll_vectors"

    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"), primary_key=True)
    version: Mapped[int] = mapped_column(primary_key=True)
    created_at: Mapped[int]
    origin: Mapped[str] = mapped_column(String(16))
    direction: Mapped[int]
    vectors: Mapped[dict[str, Any]]
    """Per channel real and imaginary part, rms of the complex error [m] and the probe that it is of, or why there is none."""
    speed_minimum: Mapped[float | None]
    speed_maximum: Mapped[float | None]
    time_first: Mapped[int | None]
    time_last: Mapped[int | None]
    comment: Mapped[str] = mapped_column(Text)


class RevisionRow(Base):
    """One revision of a machine's document; never changed."""

    __tablename__ = "machine_revisions"

    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"), primary_key=True)
    revision: Mapped[int] = mapped_column(primary_key=True)
    document: Mapped[dict[str, Any]]
    created_at: Mapped[int]


class SourceRow(Base):
    """How far one start (epoch) of one source has been received."""

    __tablename__ = "sources"

    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"), primary_key=True)
    source: Mapped[str] = mapped_column(String(64), primary_key=True)
    epoch: Mapped[int] = mapped_column(primary_key=True)
    next_sequence: Mapped[int]
    received: Mapped[int]
    duplicates: Mapped[int]
    lost: Mapped[int]
    late: Mapped[int]
    last_time: Mapped[int]
    missing: Mapped[list[list[int]] | None]
    """Sequence numbers that never came, while they may still come: [first, last, after, before], the latter times [ns]."""


class SampleBlockRow(Base):
    """Samples of one source that were stored together, compressed; see `storage.blocks`."""

    __tablename__ = "sample_blocks"
    __table_args__ = (
        UniqueConstraint("machine_id", "source", "epoch", "first_sequence"),
        ForeignKeyConstraint(["machine_id", "revision"], ["machine_revisions.machine_id", "machine_revisions.revision"]),
        Index(None, "machine_id", "time_last"),
    )

    id: Mapped[int] = mapped_column(Key, primary_key=True)
    machine_id: Mapped[str] = mapped_column(String(64))
    revision: Mapped[int]
    source: Mapped[str] = mapped_column(String(64))
    epoch: Mapped[int]
    first_sequence: Mapped[int]
    count: Mapped[int]
    time_first: Mapped[int]
    time_last: Mapped[int]
    data: Mapped[bytes] = mapped_column(LargeBinary)


class CollectorRow(Base):
    """Where a machine's run collection stands, stored with the samples that brought it there."""

    __tablename__ = "collectors"

    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"), primary_key=True)
    state: Mapped[dict[str, Any]]


class MachineStateRow(Base):
    """What a machine did from a moment on, until the next row."""

    __tablename__ = "machine_states"
    __table_args__ = (Index(None, "machine_id", "since"),)

    id: Mapped[int] = mapped_column(Key, primary_key=True)
    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"))
    since: Mapped[int]
    mode: Mapped[str] = mapped_column(String(16))
    speed: Mapped[float | None]


class RunRow(Base):
    """A run-up, a run-down, or a rolling collection. Once closed it carries its own samples; late ones change it once."""

    __tablename__ = "runs"
    __table_args__ = (
        UniqueConstraint("machine_id", "time_first"),
        ForeignKeyConstraint(["machine_id", "revision"], ["machine_revisions.machine_id", "machine_revisions.revision"]),
        Index(None, "state"),
        Index(None, "time_first"),
        Index(None, "machine_id", "state"),
    )

    id: Mapped[int] = mapped_column(Key, primary_key=True)
    machine_id: Mapped[str] = mapped_column(String(64))
    revision: Mapped[int]
    kind: Mapped[str] = mapped_column(String(16))
    direction: Mapped[int]
    state: Mapped[str] = mapped_column(String(16))
    reason: Mapped[str | None] = mapped_column(Text)
    time_first: Mapped[int]
    time_last: Mapped[int | None]
    speed_minimum: Mapped[float | None]
    speed_maximum: Mapped[float | None]
    count: Mapped[int | None]
    data: Mapped[bytes | None] = mapped_column(LargeBinary, deferred=True)
    # Null in runs that an older release collected.
    reopened_at: Mapped[int | None]
    """When late samples made it anew; it happens once."""
    coverage: Mapped[dict[str, Any] | None]
    quality: Mapped[dict[str, Any] | None]
    flags: Mapped[bytes | None] = mapped_column(LargeBinary, deferred=True)
    """What is wrong with each point of each channel, see `storage.runs`."""


class JobRow(Base):
    """An identification that is to be computed, is being computed, or was. options: what differs from the usual."""

    __tablename__ = "identification_jobs"
    __table_args__ = (Index(None, "state"),)

    id: Mapped[int] = mapped_column(Key, primary_key=True)
    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"))
    scope: Mapped[str] = mapped_column(String(16))
    run_ids: Mapped[list[int]]
    request: Mapped[str] = mapped_column(String(200), unique=True)
    state: Mapped[str] = mapped_column(String(16))
    attempts: Mapped[int]
    created_at: Mapped[int]
    finished_at: Mapped[int | None]
    error: Mapped[str | None] = mapped_column(Text)
    options: Mapped[dict[str, Any] | None]


class IdentificationRow(Base):
    """One finished fit, with what is needed to repeat it."""

    __tablename__ = "identifications"
    __table_args__ = (
        ForeignKeyConstraint(["machine_id", "revision"], ["machine_revisions.machine_id", "machine_revisions.revision"]),
        Index(None, "machine_id", "measured_at"),
        Index(None, "computed_at"),
    )

    id: Mapped[int] = mapped_column(Key, primary_key=True)
    machine_id: Mapped[str] = mapped_column(String(64))
    revision: Mapped[int]
    job_id: Mapped[int] = mapped_column(ForeignKey("identification_jobs.id"), unique=True)
    scope: Mapped[str] = mapped_column(String(16))
    run_kind: Mapped[str] = mapped_column(String(16))
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
    code_version: Mapped[str] = mapped_column(String(64))
    coordinates: Mapped[list[str]]
    covariance: Mapped[bytes] = mapped_column(LargeBinary, deferred=True)
    # Null where an older release identified.
    noise_relative: Mapped[float | None]
    noise_floor: Mapped[float | None]
    outliers: Mapped[dict[str, Any] | None]
    point: Mapped[bytes | None] = mapped_column(LargeBinary, deferred=True)
    slow_roll_version: Mapped[int | None]
    channel_effects: Mapped[bytes | None] = mapped_column(LargeBinary, deferred=True)
    conditions: Mapped[dict[str, Any] | None]
    """Mean of each operating condition over the runs, null where it was not measured; null as a whole where none is named."""


class DiagnosisRow(Base):
    """What an identification said of its machine when it was filed. baseline: the ids that it was compared with."""

    __tablename__ = "diagnoses"
    __table_args__ = (Index(None, "machine_id", "measured_at"),)

    identification_id: Mapped[int] = mapped_column(ForeignKey("identifications.id"), primary_key=True)
    machine_id: Mapped[str] = mapped_column(String(64))
    measured_at: Mapped[int]
    made_at: Mapped[int]
    baseline: Mapped[list[int]]
    runs: Mapped[int]
    causes: Mapped[list[dict[str, Any]]]


class EstimateRow(Base):
    """One parameter of one identification: the parameter history. Values are null where the data do not determine them."""

    __tablename__ = "estimates"
    __table_args__ = (Index(None, "machine_id", "parameter", "measured_at"),)

    identification_id: Mapped[int] = mapped_column(ForeignKey("identifications.id"), primary_key=True)
    parameter: Mapped[str] = mapped_column(String(160), primary_key=True)
    machine_id: Mapped[str] = mapped_column(String(64))
    measured_at: Mapped[int]
    quantity: Mapped[str] = mapped_column(String(32))
    element: Mapped[str] = mapped_column(String(80))
    unit: Mapped[str] = mapped_column(String(16))
    value: Mapped[float | None]
    standard_error: Mapped[float | None]
    lower: Mapped[float | None]
    upper: Mapped[float | None]
    imaginary: Mapped[float | None]
    imaginary_standard_error: Mapped[float | None]
    reason: Mapped[str | None] = mapped_column(Text)


class DerivedRow(Base):
    """One quantity that follows from an identification, see `estimator.derived`. Values are null for a `reason`."""

    __tablename__ = "derived_quantities"
    __table_args__ = (Index(None, "machine_id", "name", "measured_at"),)

    identification_id: Mapped[int] = mapped_column(ForeignKey("identifications.id"), primary_key=True)
    name: Mapped[str] = mapped_column(String(160), primary_key=True)
    place: Mapped[int]
    machine_id: Mapped[str] = mapped_column(String(64))
    measured_at: Mapped[int]
    unit: Mapped[str] = mapped_column(String(16))
    value: Mapped[float | None]
    lower: Mapped[float | None]
    upper: Mapped[float | None]
    reason: Mapped[str | None] = mapped_column(Text)


class AlertRow(Base):
    """A statement about a machine that wants a person's attention: one episode, one open per machine, rule and element.

    condition, severity, latching, suppressions: see `service.alert_life`; state: what is to be seen of them.
    """

    __tablename__ = "alerts"
    __table_args__ = (
        Index(
            "uq_alerts_open",
            "machine_id",
            "rule",
            "element",
            unique=True,
            sqlite_where=text("closed_at IS NULL"),
            postgresql_where=text("closed_at IS NULL"),
        ),
        Index(None, "opened_at"),
        Index(None, "machine_id", "opened_at"),
    )

    id: Mapped[int] = mapped_column(Key, primary_key=True)
    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"))
    rule: Mapped[str] = mapped_column(String(64))
    element: Mapped[str] = mapped_column(String(80))
    state: Mapped[str] = mapped_column(String(32))
    message: Mapped[str] = mapped_column(Text)
    evidence: Mapped[dict[str, Any]]
    identification_id: Mapped[int] = mapped_column(ForeignKey("identifications.id"))
    measured_at: Mapped[int]
    opened_at: Mapped[int]
    updated_at: Mapped[int]
    closed_at: Mapped[int | None]
    condition: Mapped[str] = mapped_column(String(32), server_default="unacknowledged")
    severity: Mapped[int] = mapped_column(server_default="1")
    latching: Mapped[bool] = mapped_column(server_default=false())
    suppressions: Mapped[list[str]] = mapped_column(server_default="[]")
    event_count: Mapped[int] = mapped_column(server_default="0")


class AlertEventRow(Base):
    """One transition of an alert, or a comment on it: who, when, why. Only ever added to."""

    __tablename__ = "alert_events"
    __table_args__ = (UniqueConstraint("alert_id", "number"), Index(None, "machine_id", "at"), Index(None, "at"))

    id: Mapped[int] = mapped_column(Key, primary_key=True)
    alert_id: Mapped[int] = mapped_column(ForeignKey("alerts.id"))
    number: Mapped[int]
    machine_id: Mapped[str] = mapped_column(String(64))
    rule: Mapped[str] = mapped_column(String(64))
    element: Mapped[str] = mapped_column(String(80))
    at: Mapped[int]
    kind: Mapped[str] = mapped_column(String(32))
    state_before: Mapped[str] = mapped_column(String(32))
    state: Mapped[str] = mapped_column(String(32))
    severity: Mapped[int]
    message: Mapped[str] = mapped_column(Text)
    by: Mapped[str] = mapped_column(String(120))
    comment: Mapped[str] = mapped_column(Text)
    opened_at: Mapped[int]
    identification_id: Mapped[int]


class SuppressionRow(Base):
    """A shelving, a suppression by design or a removal from service, of all that its fields match; null matches anything."""

    __tablename__ = "suppressions"
    __table_args__ = (Index(None, "machine_id", "ended_at"),)

    id: Mapped[int] = mapped_column(Key, primary_key=True)
    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"))
    rule: Mapped[str | None] = mapped_column(String(64))
    element: Mapped[str | None] = mapped_column(String(80))
    kind: Mapped[str] = mapped_column(String(32))
    since: Mapped[int]
    until: Mapped[int | None]
    by: Mapped[str] = mapped_column(String(120))
    comment: Mapped[str] = mapped_column(Text)
    ended_at: Mapped[int | None]
    ended_by: Mapped[str | None] = mapped_column(String(120))


class TimelineRow(Base):
    """A note or a marker, such as a maintenance, on a machine's timeline."""

    __tablename__ = "timeline"
    __table_args__ = (Index(None, "machine_id", "at"),)

    id: Mapped[int] = mapped_column(Key, primary_key=True)
    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"))
    at: Mapped[int]
    kind: Mapped[str] = mapped_column(String(32))
    text: Mapped[str] = mapped_column(Text)
    by: Mapped[str] = mapped_column(String(120))
    created_at: Mapped[int]


class BaselineRow(Base):
    """From when on a machine is compared with itself: the first identifications behind `since`, or those that are named.

    Never changed: a newer one takes its place and this one stays readable.
    """

    __tablename__ = "baselines"
    __table_args__ = (Index(None, "machine_id", "since"),)

    id: Mapped[int] = mapped_column(Key, primary_key=True)
    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"))
    since: Mapped[int]
    identification_ids: Mapped[list[int] | None]
    reason: Mapped[str] = mapped_column(Text)
    by: Mapped[str] = mapped_column(String(120))
    created_at: Mapped[int]


class LimitsRow(Base):
    """One version of the limits that a person set for a machine; never changed. The newest is in force."""

    __tablename__ = "limits"

    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"), primary_key=True)
    version: Mapped[int] = mapped_column(primary_key=True)
    document: Mapped[dict[str, Any]]
    """As in `service.limits`, whole: later defaults change nothing that was set."""
    at: Mapped[int]
    by: Mapped[str] = mapped_column(String(120))
    comment: Mapped[str] = mapped_column(Text)


class SubscriptionRow(Base):
    """Who is told of alert events: a webhook, an Alertmanager, a mailbox, the zenoh network."""

    __tablename__ = "subscriptions"

    id: Mapped[int] = mapped_column(Key, primary_key=True)
    kind: Mapped[str] = mapped_column(String(32))
    name: Mapped[str] = mapped_column(String(120), unique=True)
    target: Mapped[str] = mapped_column(Text)
    secret: Mapped[str | None] = mapped_column(Text)
    state: Mapped[str] = mapped_column(String(16))
    reason: Mapped[str | None] = mapped_column(Text)
    created_at: Mapped[int]


class DeliveryRow(Base):
    """One event on its way to one subscription: the outbox, written with the event itself."""

    __tablename__ = "deliveries"
    __table_args__ = (
        UniqueConstraint("subscription_id", "event_id"),
        Index(None, "state", "next_try_at"),
        Index(None, "subscription_id", "state", "alert_id"),
    )

    id: Mapped[int] = mapped_column(Key, primary_key=True)
    subscription_id: Mapped[int] = mapped_column(ForeignKey("subscriptions.id"))
    event_id: Mapped[int] = mapped_column(ForeignKey("alert_events.id"))
    alert_id: Mapped[int]
    state: Mapped[str] = mapped_column(String(16))
    attempts: Mapped[int]
    next_try_at: Mapped[int]
    last_try_at: Mapped[int | None]
    answer: Mapped[str | None] = mapped_column(Text)


class QuarantineRow(Base):
    """A rejected message or sample, as far as it is kept, and why it was rejected."""

    __tablename__ = "quarantine"
    __table_args__ = (Index(None, "reason"),)

    id: Mapped[int] = mapped_column(Key, primary_key=True)
    received_at: Mapped[int]
    key: Mapped[str] = mapped_column(String(512))
    machine_id: Mapped[str | None] = mapped_column(String(64))
    reason: Mapped[str] = mapped_column(String(32))
    detail: Mapped[str] = mapped_column(Text)
    size: Mapped[int]
    payload: Mapped[bytes] = mapped_column(LargeBinary)


class QuarantineCountRow(Base):
    """How much was ever rejected for each reason, whether or not it is still kept."""

    __tablename__ = "quarantine_counts"

    reason: Mapped[str] = mapped_column(String(32), primary_key=True)
    count: Mapped[int]


class IdempotencyKeyRow(Base):
    """A key under which a client asks for something once, and what it was answered; status is null until then."""

    __tablename__ = "idempotency_keys"
    __table_args__ = (Index(None, "created_at"),)

    key: Mapped[str] = mapped_column(String(255), primary_key=True)
    fingerprint: Mapped[str] = mapped_column(String(64))
    created_at: Mapped[int]
    status: Mapped[int | None]
    headers: Mapped[list[list[str]] | None]
    body: Mapped[bytes | None] = mapped_column(LargeBinary)
