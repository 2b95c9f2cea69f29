"""Tables of alerts, their events, suppressions, subscriptions and deliveries."""

from typing import Any

from sqlalchemy import ForeignKey, Index, String, Text, UniqueConstraint, false, text
from sqlalchemy.orm import Mapped, mapped_column, relationship

from storage.tables.base import Base, Name, RowKey


class AlertRow(Base):
    """An alert: one episode of a finding, at most one open per machine, rule and element.

    condition, severity, latching, suppressions: see `service.alerts.lifecycle`; state: derived from these for display.
    evidence: the finding's numbers, from which the text is made when it is reported. message: empty, but for alerts of
    releases that stored words and too few numbers.
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

    id: Mapped[int] = mapped_column(RowKey, primary_key=True)
    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"))
    rule: Mapped[str] = mapped_column(Name(64))
    element: Mapped[str] = mapped_column(Name(80))
    state: Mapped[str] = mapped_column(Name(32))
    message: Mapped[str] = mapped_column(Text)
    evidence: Mapped[dict[str, Any]]
    identification_id: Mapped[int] = mapped_column(ForeignKey("identifications.id"))
    measured_at: Mapped[int]
    first_measured_at: Mapped[int] = mapped_column(server_default="0")
    opened_at: Mapped[int]
    updated_at: Mapped[int]
    closed_at: Mapped[int | None]
    condition: Mapped[str] = mapped_column(Name(32), server_default="unacknowledged")
    severity: Mapped[int] = mapped_column(server_default="1")
    latching: Mapped[bool] = mapped_column(server_default=false())
    suppressions: Mapped[list[str]] = mapped_column(server_default="[]")
    event_count: Mapped[int] = mapped_column(server_default="0")


class AlertEventRow(Base):
    """One transition of an alert, or a comment on it: who, when, why. Rows are only added.

    evidence: the alert's then. message: empty, but for events of releases that stored words in place of evidence.
    """

    __tablename__ = "alert_events"
    __table_args__ = (UniqueConstraint("alert_id", "number"), Index(None, "machine_id", "at"), Index(None, "at"))

    id: Mapped[int] = mapped_column(RowKey, primary_key=True)
    alert_id: Mapped[int] = mapped_column(ForeignKey("alerts.id"))
    number: Mapped[int]
    machine_id: Mapped[str] = mapped_column(Name(64))
    rule: Mapped[str] = mapped_column(Name(64))
    element: Mapped[str] = mapped_column(Name(80))
    at: Mapped[int]
    kind: Mapped[str] = mapped_column(Name(32))
    state_before: Mapped[str] = mapped_column(Name(32))
    state: Mapped[str] = mapped_column(Name(32))
    severity: Mapped[int]
    evidence: Mapped[dict[str, Any] | None]
    message: Mapped[str] = mapped_column(Text)
    by: Mapped[str] = mapped_column(Name(120))
    comment: Mapped[str] = mapped_column(Text)
    opened_at: Mapped[int]
    identification_id: Mapped[int]


class SuppressionRow(Base):
    """A shelving, a suppression by design or a removal from service of all that its fields match; null matches anything.

    until_cleared: it ends before `until` when the cause is gone.
    """

    __tablename__ = "suppressions"
    __table_args__ = (Index(None, "machine_id", "ended_at"),)

    id: Mapped[int] = mapped_column(RowKey, primary_key=True)
    machine_id: Mapped[str] = mapped_column(ForeignKey("machines.id"))
    rule: Mapped[str | None] = mapped_column(Name(64))
    element: Mapped[str | None] = mapped_column(Name(80))
    kind: Mapped[str] = mapped_column(Name(32))
    since: Mapped[int]
    until: Mapped[int | None]
    until_cleared: Mapped[bool] = mapped_column(default=False, server_default=false())
    by: Mapped[str] = mapped_column(Name(120))
    comment: Mapped[str] = mapped_column(Text)
    ended_at: Mapped[int | None]
    ended_by: Mapped[str | None] = mapped_column(Name(120))


class SubscriptionRow(Base):
    """A recipient of alert events: a webhook, an Alertmanager, a mailbox, the zenoh network.

    reports: how often it also gets reports of its machines; null: never. reported_until: end of the newest period of which it
    has them all.
    """

    __tablename__ = "subscriptions"

    id: Mapped[int] = mapped_column(RowKey, primary_key=True)
    kind: Mapped[str] = mapped_column(Name(32))
    name: Mapped[str] = mapped_column(Name(120), unique=True)
    target: Mapped[str] = mapped_column(Text)
    secret: Mapped[str | None] = mapped_column(Text)
    state: Mapped[str] = mapped_column(Name(16))
    reason: Mapped[str | None] = mapped_column(Text)
    created_at: Mapped[int]
    reports: Mapped[str | None] = mapped_column(Name(16))
    reported_until: Mapped[int | None]
    told_of: Mapped[list["SubscriptionPlantRow"]] = relationship(lazy="selectin")


class SubscriptionPlantRow(Base):
    """A plant whose events a subscription receives; a subscription without any receives all."""

    __tablename__ = "subscription_plants"

    subscription_id: Mapped[int] = mapped_column(ForeignKey("subscriptions.id"), primary_key=True)
    plant: Mapped[str] = mapped_column(String(64), primary_key=True)


class DeliveryRow(Base):
    """The delivery of one event to one subscription: the outbox, written together with the event."""

    __tablename__ = "deliveries"
    __table_args__ = (
        UniqueConstraint("subscription_id", "event_id"),
        Index(None, "state", "next_try_at"),
        Index(None, "subscription_id", "state", "alert_id"),
    )

    id: Mapped[int] = mapped_column(RowKey, primary_key=True)
    subscription_id: Mapped[int] = mapped_column(ForeignKey("subscriptions.id"))
    event_id: Mapped[int] = mapped_column(ForeignKey("alert_events.id"))
    alert_id: Mapped[int]
    state: Mapped[str] = mapped_column(Name(16))
    attempts: Mapped[int]
    next_try_at: Mapped[int]
    last_try_at: Mapped[int | None]
    answer: Mapped[str | None] = mapped_column(Text)
