"""The version of SQLite or PostgreSQL in use, and the known objections to it.

SQLite's WAL-reset bug (https://www.sqlite.org/wal.html#walresetbug): in 3.7.0 to 3.51.2, except the patched 3.44.6 and 3.50.7,
a commit during the second of two checkpoints can damage the file. `storage.database.engine` prevents overlapping commits and
checkpoints within one process; it cannot prevent those of another process that writes to the same file.
"""

import sqlite3

from sqlalchemy import Engine

OLDEST_POSTGRESQL = 15

Version = tuple[int | str, ...]


def named(engine: Engine) -> str:
    """Return the database's product and version, such as `PostgreSQL 15.4`."""
    if engine.dialect.name == "sqlite":
        return f"SQLite {sqlite3.sqlite_version}"
    return "PostgreSQL " + ".".join(map(str, engine.dialect.server_version_info or ()))


def objections(engine: Engine) -> list[str]:
    """Return the objections to the database's version, as sentences; empty when none are known."""
    if engine.dialect.name == "sqlite":
        return sqlite_objections(sqlite3.sqlite_version_info)
    return postgresql_objections(engine.dialect.server_version_info or ())


def sqlite_objections(version: Version) -> list[str]:
    """Return the objections to a version of SQLite."""
    if not has_wal_reset_bug(version):
        return []
    return [
        f"SQLite {_text(version)} has the WAL-reset bug, which is fixed in 3.51.3 (and in 3.50.7 and 3.44.6): "
        "the service does not meet it by itself, but let no other program write to its database file"
    ]


def postgresql_objections(version: Version) -> list[str]:
    """Return the objections to a version of PostgreSQL."""
    if version >= (OLDEST_POSTGRESQL,):
        return []
    return [f"PostgreSQL {_text(version)} is older than {OLDEST_POSTGRESQL}, the oldest that Rundown is tested with"]


def has_wal_reset_bug(version: Version) -> bool:
    """Return whether a version of SQLite can damage a file in WAL mode when several processes write to it."""
    patched = (version[:2] == (3, 44) and version >= (3, 44, 6)) or (version[:2] == (3, 50) and version >= (3, 50, 7))
    return (3, 7) <= version < (3, 51, 3) and not patched


def _text(version: Version) -> str:
    return ".".join(map(str, version))
