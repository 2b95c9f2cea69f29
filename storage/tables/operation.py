"""Tables of the service itself: processes, leases, retention, access and audit."""

from sqlalchemy import Index, LargeBinary, String, Text
from sqlalchemy.orm import Mapped, mapped_column

from storage.tables.base import Base, Name, RowKey


class IdempotencyKeyRow(Base):
    """A key under which a client makes a request only once, and the response; status is null until there is one."""

    __tablename__ = "idempotency_keys"
    __table_args__ = (Index(None, "created_at"),)

    key: Mapped[str] = mapped_column(Name(255), primary_key=True)
    fingerprint: Mapped[str] = mapped_column(Name(64))
    created_at: Mapped[int]
    status: Mapped[int | None]
    headers: Mapped[list[list[str]] | None]
    body: Mapped[bytes | None] = mapped_column(LargeBinary)


class ReplicaRow(Base):
    """A process of the service that works on this database. Numbers are never reused."""

    __tablename__ = "replicas"
    __table_args__ = {"sqlite_autoincrement": True}  # noqa: RUF012

    id: Mapped[int] = mapped_column(RowKey, primary_key=True)
    role: Mapped[str] = mapped_column(String(16))
    host: Mapped[str] = mapped_column(String(255))
    process: Mapped[int]
    started_at: Mapped[int]
    seen_at: Mapped[int]
    """Last heartbeat by the database's clock, like `started_at`: hosts may differ."""


class LeaseRow(Base):
    """A part of the work that one replica at a time does; free when `holder` is null."""

    __tablename__ = "leases"

    name: Mapped[str] = mapped_column(String(32), primary_key=True)
    holder: Mapped[int | None]
    since: Mapped[int]


class RetentionRow(Base):
    """Progress of a tier of retention.

    cut_off: what ended before it may be deleted [ns]; allowance: how much further than the elapsed service time it may move
    [ns].
    """

    __tablename__ = "retention"

    tier: Mapped[str] = mapped_column(String(32), primary_key=True)
    cut_off: Mapped[int]
    allowance: Mapped[int]


class ChangeCountRow(Base):
    """Number of rows written to a table, see `storage.database.change_counts`; on SQLite only."""

    __tablename__ = "change_counts"

    table_name: Mapped[str] = mapped_column(String(64), primary_key=True)
    count: Mapped[int]


class ApiKeyRow(Base):
    """An API key, of which only the hash is stored. prefix: identifies the key in look-ups and messages; plants: null for
    all."""

    __tablename__ = "api_keys"

    id: Mapped[int] = mapped_column(RowKey, primary_key=True)
    prefix: Mapped[str] = mapped_column(String(16), unique=True)
    hash: Mapped[str] = mapped_column(String(64))
    name: Mapped[str] = mapped_column(String(120))
    role: Mapped[str] = mapped_column(String(16))
    plants: Mapped[list[str] | None]
    created_at: Mapped[int]
    expires_at: Mapped[int]
    revoked_at: Mapped[int | None]
    last_used_at: Mapped[int | None]


class BrowserSessionRow(Base):
    """A login on the page. hash: hash of the cookie; key_prefix: key prefix of the API key it was made with, if any."""

    __tablename__ = "browser_sessions"
    __table_args__ = (Index(None, "expires_at"),)

    hash: Mapped[str] = mapped_column(String(64), primary_key=True)
    name: Mapped[str] = mapped_column(String(120))
    role: Mapped[str] = mapped_column(String(16))
    plants: Mapped[list[str] | None]
    key_prefix: Mapped[str | None] = mapped_column(String(16))
    token: Mapped[str] = mapped_column(String(64))
    """Token that every change must carry, so that another site's page cannot make it."""
    created_at: Mapped[int]
    expires_at: Mapped[int]


class LoginRow(Base):
    """A login in progress at an issuer, with hashes of the state it returns with and of the cookie of the browser that began
    it."""

    __tablename__ = "logins"
    __table_args__ = (Index(None, "expires_at"),)

    state_hash: Mapped[str] = mapped_column(String(64), primary_key=True)
    browser_hash: Mapped[str] = mapped_column(String(64))
    verifier: Mapped[str] = mapped_column(String(64))
    nonce: Mapped[str] = mapped_column(String(64))
    expires_at: Mapped[int]


class AuditRow(Base):
    """One entry of the audit trail; its hash covers it and the hash of the entry before. The database refuses changes."""

    __tablename__ = "audit"

    number: Mapped[int] = mapped_column(RowKey, primary_key=True, autoincrement=False)
    at: Mapped[int]
    who: Mapped[str] = mapped_column(String(200))
    address: Mapped[str] = mapped_column(String(64))
    operation: Mapped[str] = mapped_column(String(80))
    target: Mapped[str] = mapped_column(Text)
    outcome: Mapped[str] = mapped_column(String(80))
    previous: Mapped[str] = mapped_column(String(64))
    hash: Mapped[str] = mapped_column(String(64))


class AuditHeadRow(Base):
    """The head of the audit trail: its last rows cannot be removed without forging this one as well."""

    __tablename__ = "audit_head"

    id: Mapped[int] = mapped_column(RowKey, primary_key=True, autoincrement=False)
    number: Mapped[int]
    hash: Mapped[str] = mapped_column(String(64))
