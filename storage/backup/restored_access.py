"""Access after a restore: a backup does not know which keys were revoked, or who logged out, since it was made.

The replaced store's state of a key is kept. A key that the replaced store does not know waits for a confirmation; all keys do
when that store cannot be read. The statements are plain SQL and not the tables of this release, since a backup may have an
older schema, which is kept.
"""

from dataclasses import dataclass

from sqlalchemy import Connection, inspect, text

from storage.backup.backup_file import BackupUnusable
from storage.clock import now

KEYS = "api_keys"
LOGGED_IN = ("browser_sessions", "logins")


@dataclass(frozen=True)
class KnownKey:
    """The state of an API key in a store: its expiry [ns] and when it was revoked [ns]."""

    hash: str
    expires_at: int
    revoked_at: int | None


@dataclass(frozen=True)
class RestoredAccess:
    """The access that a restore withdrew. revoked, waiting: keys by their prefixes; sessions: number of sessions dropped.

    keyless: the replaced store had keys and the backup has none, so that by itself nothing asks for one any more.
    """

    revoked: tuple[str, ...]
    waiting: tuple[str, ...]
    sessions: int
    keyless: bool = False

    @property
    def changed(self) -> bool:
        """Return whether the restore withdrew any access that the backup granted."""
        return bool(self.revoked or self.waiting or self.sessions)


def known_keys(connection: Connection, *, schema: str | None = None) -> dict[str, KnownKey]:
    """Return the keys of a store by their prefixes. Raises DBAPIError."""
    if not inspect(connection).has_table(KEYS, schema=schema):
        return {}
    table = f"{schema}.{KEYS}" if schema else KEYS
    rows = connection.execute(text(f"SELECT prefix, hash, expires_at, revoked_at FROM {table} ORDER BY id"))
    return {row.prefix: KnownKey(row.hash, row.expires_at, row.revoked_at) for row in rows}


def amend(connection: Connection, known: dict[str, KnownKey], *, without_keys: bool = False) -> RestoredAccess:
    """Apply the replaced store's state of the keys to a restored backup, and drop all sessions and logins.

    Args:
        connection: To the restored backup.
        known: The replaced store's keys.
        without_keys: Whether the restored store may have no key though the replaced one had some.

    Raises:
        BackupUnusable: It has none, and may not.
    """
    there = set(inspect(connection).get_table_names())
    held = known_keys(connection) if KEYS in there else {}
    keyless = bool(known) and not held
    if keyless and not without_keys:
        raise BackupUnusable(
            "the backup is older than the first API key: without one nobody would be asked who they are. Say --without-keys "
            "to restore it all the same, and make a key before the start (rundown key create), or set authentication=required"
        )
    sessions = 0
    for table in there & {*LOGGED_IN}:
        dropped = connection.execute(text(f"DELETE FROM {table}")).rowcount
        sessions += dropped if table == LOGGED_IN[0] else 0
    revoked, waiting = [], []
    for prefix, key in held.items():
        if key.revoked_at is not None or key.expires_at <= now():
            continue
        last = known.get(prefix)
        if last is None or last.hash != key.hash:
            last = KnownKey(key.hash, -key.expires_at, None)  # as `api_keys.awaits_confirmation` has it
        if last.revoked_at is not None:
            revoked.append(prefix)
        elif last.expires_at < 0:
            waiting.append(prefix)
        connection.execute(
            text(f"UPDATE {KEYS} SET expires_at = :expires_at, revoked_at = :revoked_at WHERE prefix = :prefix"),
            {"expires_at": min(key.expires_at, last.expires_at), "revoked_at": last.revoked_at, "prefix": prefix},
        )
    return RestoredAccess(tuple(revoked), tuple(waiting), sessions, keyless=keyless)
