"""API keys: 256 random bits behind a prefix that identifies the row.

Only the SHA-256 of a key is stored. Slow hashes, as for passwords, protect guessable secrets; 256 random bits are not, and
every request would pay for a slow hash.
"""

import hashlib
import hmac
import secrets
from collections.abc import Sequence

from sqlalchemy.orm import Session

from service.security.principal import Principal
from service.security.role import Role
from storage.clock import now
from storage.operation import api_keys, audit
from storage.operation.audit import AuditedOperation
from storage.tables.operation import ApiKeyRow

BEGIN = "rundown_"
SECRET_BYTES = 32
PREFIX_BYTES = 4
A_DAY_NS = 24 * 3600 * 1_000_000_000
COMMAND = "rundown key"
"""Author in the audit trail of changes made by commands on the store."""


def prefix_of(text: str) -> str | None:
    """Return the prefix of a text in the form of a key; None for any other text."""
    parts = text.split("_", 2)
    return parts[1] if len(parts) == 3 and text.startswith(BEGIN) and parts[1] and parts[2] else None


def key_hash(text: str) -> str:
    """Hash a key; only the hash is stored."""
    return hashlib.sha256(text.encode()).hexdigest()


def create(
    session: Session, *, name: str, role: Role, plants: Sequence[str] | None, days: float, address: str = "local"
) -> tuple[ApiKeyRow, str]:
    """Return a new key with its text, which is not stored. plants: None for all; days: until it expires."""
    prefix = secrets.token_hex(PREFIX_BYTES)
    text = f"{BEGIN}{prefix}_{secrets.token_urlsafe(SECRET_BYTES)}"
    expires_at = now() + round(days * A_DAY_NS)
    row = api_keys.add(
        session, prefix=prefix, key_hash=key_hash(text), name=name, role=role.label, plants=plants, expires_at=expires_at
    )
    scope = "all plants" if plants is None else ", ".join(sorted(plants))
    audit.append(
        session, AuditedOperation(COMMAND, address, "create_key", f"{prefix} {name}: {role.label} of {scope}", "done")
    )
    return row, text


def rotate(session: Session, prefix: str, *, overlap_days: float, days: float) -> tuple[ApiKeyRow, str]:
    """Replace a key by a new one; the old one stays valid for overlap_days. Raises KeyUnknown; ValueError if invalid."""
    old = api_keys.get(session, prefix)
    if not api_keys.valid(old, at=now()):
        raise ValueError(f"key {prefix} is revoked, has expired or waits for a confirmation: create a new one, or confirm it")
    api_keys.expire_by(old, now() + round(overlap_days * A_DAY_NS))
    audit.append(session, AuditedOperation(COMMAND, "local", "rotate_key", prefix, "done"))
    return create(session, name=old.name, role=Role.of(old.role), plants=old.plants, days=days)


def confirm(session: Session, prefix: str) -> None:
    """Reactivate a key that awaits confirmation since a restore. Raises KeyUnknown, ValueError for one that does not."""
    row = api_keys.get(session, prefix)
    if not api_keys.awaits_confirmation(row):
        raise ValueError(f"key {prefix} does not wait for a confirmation")
    api_keys.confirm(row)
    audit.append(session, AuditedOperation(COMMAND, "local", "confirm_key", prefix, "done"))


def revoke(session: Session, prefix: str) -> None:
    """Revoke a key. Raises KeyUnknown."""
    api_keys.revoke(api_keys.get(session, prefix))
    audit.append(session, AuditedOperation(COMMAND, "local", "revoke_key", prefix, "done"))


def principal(row: ApiKeyRow) -> Principal:
    """Return the principal of a key."""
    plants = None if row.plants is None else frozenset(row.plants)
    return Principal(row.name, Role.of(row.role), plants, "key", f"key {row.prefix}")


def is_valid_secret(row: ApiKeyRow | None, text: str) -> bool:
    """Check whether a text is that key, and the key is valid."""
    given = key_hash(text)
    return hmac.compare_digest(row.hash if row else "", given) and row is not None and api_keys.valid(row, at=now())
