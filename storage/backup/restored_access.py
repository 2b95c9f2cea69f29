"""Who gets in behind a restore: a backup knows nothing of keys that were revoked since, nor of who has logged out.

What the replaced store knows of a key goes on to hold. A key that it does not know waits until somebody confirms it, and so do
all where it cannot be read. In SQL, not by the tables of this release: a backup may be of an older schema, and is left so.
"""

from dataclasses import dataclass

from sqlalchemy import Connection, inspect, text

from storage.clock import now

KEYS = "api_keys"
LOGGED_IN = ("browser_sessions", "logins")


@dataclass(frozen=True)
class KnownKey:
    """What a store says of a key: until when it is good [ns], and since when it is revoked."""

    hash: str
    expires_at: int
    revoked_at: int | None


@dataclass(frozen=True)
class RestoredAccess:
    """What became of who could get in. revoked, waiting: keys by their prefixes; sessions: how many were dropped."""

    revoked: tuple[str, ...]
    waiting: tuple[str, ...]
    sessions: int

    @property
    def changed(self) -> bool:
        """Whether anybody gets in less than with the backup."""
        return bool(self.revoked or self.waiting or self.sessions)


def known_keys(connection: Connection, *, schema: str | None = None) -> dict[str, KnownKey]:
    """What a store knows of its keys, by their prefixes. Raises DBAPIError."""
    if not inspect(connection).has_table(KEYS, schema=schema):
        return {}
    table = f"{schema}.{KEYS}" if schema else KEYS
    rows = connection.execute(text(f"SELECT prefix, hash, expires_at, revoked_at FROM {table} ORDER BY id"))
    return {row.prefix: KnownKey(row.hash, row.expires_at, row.revoked_at) for row in rows}


def amend(connection: Connection, known: dict[str, KnownKey]) -> RestoredAccess:
    """Take over what the replaced store knew of the keys of a backup that was read in, and let nobody stay logged in."""
    there = set(inspect(connection).get_table_names())
    sessions = 0
    for table in there & {*LOGGED_IN}:
        dropped = connection.execute(text(f"DELETE FROM {table}")).rowcount
        sessions += dropped if table == LOGGED_IN[0] else 0
    revoked, waiting = [], []
    for prefix, key in known_keys(connection).items() if KEYS in there else ():
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
    return RestoredAccess(tuple(revoked), tuple(waiting), sessions)
