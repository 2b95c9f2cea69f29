"""Opening a database, upgrading its schema, and transactions.

For both kinds of database: one transaction writes at a time, and a reading one sees a single state from its first query to its
last.
"""

import json
import re
import sqlite3
import time
import weakref
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, closing, contextmanager
from typing import Any, Protocol

import msgspec
from sqlalchemy import URL, Engine, create_engine, event, make_url, select
from sqlalchemy.exc import ArgumentError, DatabaseError, DBAPIError, NoSuchModuleError, OperationalError
from sqlalchemy.orm import Session, sessionmaker

from storage.database import versions, writer_turn
from storage.database.claim import CLAIM_KEY, Claim, DatabaseUnusable, file_of, require_logs, require_own_name
from storage.database.damage import MALFORMED_JSON, Damage, marker_of
from storage.database.errors import error_outline
from storage.database.file_inspection import damages
from storage.database.schema_upgrade import bring_up_to_date
from storage.database.sqlite_files import SqliteFiles
from storage.database.writer_turn import WriterTurn
from storage.encoding.text import json_text
from storage.files import file_lock, private_files
from storage.recent_maximum import RecentMaximum

LARGEST_LOG = 64 * 2**20
"""Size [bytes] to which a checkpoint cuts SQLite's log back after readers have let it grow."""
FRAMES_AT_A_LOOK, EVERY_FRAME = 300, 2**31
"""Numbers of the log's frames that a regular look, and the one before the last checkpoint, take in."""
MENDED = "pages of its log were overwritten, and newer ones or the file itself have all they held"
"""Finding that is reported until a check has found all pages whole."""
CLOSING_S, LOOK_S = 4.0, 0.1
"""Longest time for which closing tries to save what can be saved, and the interval between attempts [s]."""
WRITER_KEY = CLAIM_KEY + 1
"""Key of the PostgreSQL advisory lock that each writing transaction holds."""
_CONNECTION = {
    "connect_timeout": 5,
    "keepalives_idle": 10,
    "keepalives_interval": 5,
    "keepalives_count": 3,
    "tcp_user_timeout": 10_000,
    # The server lets go of what a client holds that has vanished, or hangs in the middle of a transaction.
    "options": "-c idle_in_transaction_session_timeout=10s "
    "-c tcp_keepalives_idle=5 -c tcp_keepalives_interval=5 -c tcp_keepalives_count=2",
}
"""Timeouts [s, tcp_user_timeout in ms] by which we notice that a PostgreSQL server vanished, and the server that we did."""


class Follower(Protocol):
    """Something with connections of its own to a database, which is closed with it."""

    def close(self) -> None:
        """Close these connections."""


class Database:
    """A database, SQLite or PostgreSQL by URL."""

    def __init__(self, url: str) -> None:
        """Open a database and upgrade its schema. Raises DatabaseUnusable."""
        self.engine = engine_of(url)
        try:
            bring_up_to_date(self.engine)
        except (DBAPIError, DatabaseUnusable, OSError) as error:
            self.engine.dispose()
            cause = error.orig if isinstance(error, DBAPIError) else error
            raise DatabaseUnusable(f"database {redacted_url(url)} cannot be used: {cause}") from error
        self.url = url
        self._claim = Claim(self.engine)
        self.longest_transaction = RecentMaximum()
        """Durations of the writing transactions, from the beginning of their turn until they are durable."""
        self._files = _kept_files(self.engine)
        self._turn = WriterTurn(self._files, alone=self.kind == "sqlite")
        path = file_of(self.engine)
        self._place = None if path is None else file_lock.register(path)
        self.damage = Damage(None if path is None else marker_of(path))
        """Damage of the store, as far as it has been met."""
        self.followers: weakref.WeakSet[Follower] = weakref.WeakSet()
        """Holders of connections outside the pool, closed with this database."""
        event.listen(self.engine, "handle_error", self.damage.watch)
        consistent = {"isolation_level": "REPEATABLE READ"} if self.kind == "postgresql" else {}
        self.for_reading = self.engine.execution_options(**consistent)
        """Engine whose transactions see one state from the first query to the last."""
        self.for_writing = self.engine.execution_options(writing="alone")
        """Engine whose transactions wait for each other; on SQLite they also need the writers' `turn`."""
        self._reading = sessionmaker(self.for_reading, expire_on_commit=False)
        self._writing = sessionmaker(self.for_writing, expire_on_commit=False)
        self._sharing = sessionmaker(self.engine.execution_options(writing="beside others"), expire_on_commit=False)

    @property
    def kind(self) -> str:
        """Return `sqlite` or `postgresql`."""
        return self.engine.dialect.name

    @property
    def version(self) -> str:
        """Return product and version, such as `SQLite 3.51.3`."""
        return versions.named(self.engine)

    @property
    def objections(self) -> list[str]:
        """Return the known objections to the version of the database."""
        return versions.objections(self.engine)

    @contextmanager
    def transaction(self, *, beside_others: bool = False) -> Iterator[Session]:
        """Yield a session whose changes are committed together at the end, or not at all.

        beside_others: this process holds a lease on all that the transaction changes, so that on PostgreSQL other writers need
        not wait.
        """
        making = self._sharing if beside_others else self._writing
        with self.turn(), self.longest_transaction.measured(), making.begin() as session:
            yield session
            self._turn.require_content()

    @contextmanager
    def reading(self) -> Iterator[Session]:
        """Yield a session for reading only."""
        session = self._reading()
        try:
            yield session
        finally:
            _close_reading(session)

    def claim(self, *, shared: bool = False) -> None:
        """Claim this database for one service, or for several that share it, until `close`.

        SQLite files cannot be shared. Raises DatabaseUnusable when another service has the claim.
        """
        self._claim.acquire(shared=shared)

    def hold_lock(self, number: int, second: int) -> bool:
        """Hold a PostgreSQL advisory lock as long as the claim; return False while another connection holds it.

        Always True on SQLite, where there is no other process.
        """
        return self._claim.hold_lock(number, second)

    @property
    def needs_restart(self) -> bool:
        """Return whether this process cannot go on with its open files, and its end loses nothing."""
        return self._files is not None and not self._files.check() and self._files.saved

    def save_lost_files(self) -> None:
        """Save data whose file has lost its name, or was cut off or overwritten.

        Raises DatabaseUnusable when a file of an SQLite store was deleted, replaced, overwritten or cut off.
        """
        files = self._files
        if files is None or files.check(further=FRAMES_AT_A_LOOK):
            return
        mended = files.mended
        self._turn.save(files)
        if files.mended > mended:
            self.damage.record_findings([MENDED])
        if (trouble := files.trouble) is not None:
            raise files.unusable(trouble)

    def check_integrity(self, *, within_s: float, stopped: Callable[[], bool]) -> None:
        """Check all pages of a damaged SQLite store; clear the record of the damage when they are whole.

        On PostgreSQL, and when the time does not suffice, the record stays.
        """
        if self.kind != "sqlite":
            return
        met = self.damage.met
        with closing(self.own_connection(check_same_thread=False)) as connection:
            found = damages(connection, within_s=within_s, thorough=True, stopped=stopped)
        if found:
            self.damage.record_findings(found)
        elif found is not None:
            self.damage.clear(met=met)

    def own_connection(self, **options: Any) -> sqlite3.Connection:
        """Return a connection of the driver to an SQLite store, outside the pool. Raises OperationalError."""
        where, how = self.engine.dialect.create_connect_args(self.engine.url)
        connect: Callable[..., sqlite3.Connection] = sqlite3.connect
        if self._files is not None:
            self._files.require()
        return connect(*where, **{**how, **options})

    def check(self) -> None:
        """Raise DatabaseUnusable unless the database answers, its files exist and the claim still holds.

        The claim is lost when another service took it while a PostgreSQL server was away.
        """
        self.save_lost_files()
        try:
            with self.reading() as session:
                session.execute(select(1))
            self._claim.reacquire()
        except DBAPIError as error:
            said, told = f"the database does not answer: {error.orig}", f"the database does not answer: {error_outline(error)}"
            raise DatabaseUnusable(said, outline=told) from error

    def close(self) -> None:
        """Close all connections and release the claim."""
        self._claim.release()
        until = time.monotonic() + CLOSING_S
        while self._files is not None and not self._files.check(further=EVERY_FRAME):  # what it says afterwards
            self._turn.save(self._files)  # no checkpoint may copy what is missing in a log, or into a foreign file
            if self._files.saved or time.monotonic() > until:
                break
            time.sleep(LOOK_S)
        for follower in list(self.followers):
            follower.close()
        self.engine.dispose()
        if self._files is not None:
            self._files.close()
        if self._place is not None:
            file_lock.unregister(self._place)
            self._place = None

    def turn(self) -> AbstractContextManager[None]:
        """Take the writers' turn of this process, see `storage.database.writer_turn`. Raises OperationalError."""
        return self._turn.taken()


def _kept_files(engine: Engine) -> SqliteFiles | None:
    """Open the files of an SQLite store; return None when it has none. Raises DatabaseUnusable."""
    path = file_of(engine)
    if path is None:
        return None
    try:
        files = SqliteFiles(path)
    except (sqlite3.Error, OSError) as error:
        engine.dispose()
        raise DatabaseUnusable(f"database {redacted_url(engine.url)} cannot be used: {error}") from error

    def require_behind(connection: Any, _record: Any) -> None:
        try:
            files.require()
        except OperationalError:
            connection.close()  # nobody else knows of it yet
            raise

    event.listen(engine, "do_connect", lambda *_: files.require())
    event.listen(engine, "connect", require_behind)
    return files


def _close_reading(session: Session) -> None:
    try:
        session.close()
    except DBAPIError:
        # What was read stays read: that the connection broke behind it is the next one's to find out.
        session.invalidate()


def redacted_url(url: str | URL) -> str:
    """Return a URL without its passwords.

    Of a URL that cannot be parsed only the scheme is shown if it may hold a password.
    """
    try:
        parsed = make_url(url)
    except (ArgumentError, ValueError):
        url = str(url)
        secret = "@" in url or "password" in url.lower()
        return repr(re.match(r"[\w+]*", url)[0] + "…") if secret else repr(url)  # type: ignore[index]
    hidden = {name: "hidden" for name in parsed.query if "password" in name.lower()}
    return parsed.update_query_dict(hidden).render_as_string(hide_password=True)


def require_file(url: str) -> None:
    """Raise DatabaseUnusable unless the database file exists: opening it would create an empty one."""
    path = file_of(engine_of(url))
    try:
        there = path is None or path.is_file()
    except OSError as error:  # of a folder that may not be looked into
        raise DatabaseUnusable(f"database {redacted_url(url)} cannot be used: {error}") from error
    if not there:
        raise DatabaseUnusable(f"there is no database file {path}: start the service once, or name the right one")


def engine_of(url: str | URL) -> Engine:
    """Return an engine for a database; nothing is opened or migrated yet. Raises DatabaseUnusable."""
    try:
        return _engine(url)
    except (ArgumentError, NoSuchModuleError, ModuleNotFoundError) as error:
        raise DatabaseUnusable(f"database {redacted_url(url)} cannot be used: {error}") from error
    except ValueError:  # its text may hold a part of the password
        raise DatabaseUnusable(f"database {redacted_url(url)} cannot be used: its port is no number") from None


@contextmanager
def temporary_engine(url: str | URL) -> Iterator[Engine]:
    """Yield an engine for a database and close its connections at the end.

    Raises DatabaseUnusable, also for the driver's errors.
    """
    engine = engine_of(url)
    path = file_of(engine)
    place = file_lock.register(path) if path is not None and path.is_file() else None
    try:
        yield engine
    except DBAPIError as error:
        raise DatabaseUnusable(f"database {redacted_url(url)} cannot be used: {error.orig}") from error
    finally:
        engine.dispose()
        if place is not None:
            file_lock.unregister(place)


def _engine(url: str | URL) -> Engine:
    try:
        parsed = make_url(url)
    except ArgumentError:
        raise DatabaseUnusable(
            f"database {redacted_url(url)} cannot be used: it is no URL of a database; one is written as "
            "sqlite:///rundown.db, or postgresql+psycopg://user@server/name"
        ) from None
    dialect = parsed.get_dialect().name
    if dialect == "sqlite" and "uri" in parsed.query:
        raise DatabaseUnusable(
            f"database {redacted_url(url)} cannot be used: `uri` is not taken: name the file itself, as in sqlite:////folder/name.db"
        )
    engine = create_engine(
        url,
        pool_pre_ping=True,
        connect_args=_CONNECTION if dialect == "postgresql" else {},
        json_serializer=json_text,
        json_deserializer=_stored_json,
    )
    if dialect == "postgresql":
        event.listen(engine, "begin", _begin_postgresql)
    elif dialect == "sqlite":
        event.listen(engine, "do_connect", lambda *_: _prepare_sqlite(engine))
        event.listen(engine, "connect", _configure_sqlite)
        event.listen(engine, "begin", _begin_sqlite)
    return engine


def _stored_json(text: str | bytes) -> Any:
    """Return the value of stored JSON. Raises DatabaseError, as of a damaged file, where it cannot be decoded."""
    try:
        return msgspec.json.decode(text)  # in a fifth of the time
    except (ValueError, RecursionError, msgspec.DecodeError):
        pass
    try:
        return json.loads(text)
    except ValueError:
        raise DatabaseError(None, None, sqlite3.DatabaseError(MALFORMED_JSON)) from None  # without any stored text


def _prepare_sqlite(engine: Engine) -> None:
    if (path := file_of(engine)) is None:
        return
    try:
        require_own_name(path)
        require_logs(path)
    except (DatabaseUnusable, OSError) as error:
        raise OperationalError(None, None, error) from error
    private_files.prepare(path)


def _configure_sqlite(connection: Any, _record: Any) -> None:
    # Transactions are begun by `_begin_sqlite`: the driver's own handling starts them too late for a safe upgrade to writing.
    connection.isolation_level = None
    try:
        connection.execute(f"PRAGMA busy_timeout = {writer_turn.BUSY_TIMEOUT_MS}")
        if connection.execute("PRAGMA page_count").fetchone() == (0,):
            # Of a new file only; of an older one it would change nothing, and wait for its writer.
            connection.execute("PRAGMA auto_vacuum = INCREMENTAL")
        connection.execute("PRAGMA journal_mode = WAL")
        connection.execute(f"PRAGMA journal_size_limit = {LARGEST_LOG}")
        # A sample is durable before it counts as received, also when the power fails.
        connection.execute("PRAGMA synchronous = FULL")
        connection.execute("PRAGMA foreign_keys = ON")
    except Exception:
        connection.close()  # nobody else knows of it yet
        raise


def _begin_sqlite(connection: Any) -> None:
    # A writer takes its lock at once: one that upgrades a read lock later may fail without the busy timeout being tried.
    connection.exec_driver_sql("BEGIN IMMEDIATE" if connection.get_execution_options().get("writing") else "BEGIN")


def _begin_postgresql(connection: Any) -> None:
    # What reads before it writes would otherwise have to expect that another one wrote in between.
    writing = connection.get_execution_options().get("writing")
    if writing:
        connection.exec_driver_sql(f"SET LOCAL lock_timeout = {writer_turn.BUSY_TIMEOUT_MS}")
    if writing == "alone":
        connection.exec_driver_sql(f"SELECT pg_advisory_xact_lock({WRITER_KEY})")
