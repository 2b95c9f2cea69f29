"""Archives of PostgreSQL's own client programs, `pg_dump -Fc` and `pg_restore`."""

import os
import re
import shutil
import subprocess
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from sqlalchemy import URL, Connection, Engine, inspect, text

ASIDE = "rundown_before_restore"
"""Schema in which the old tables wait until the new ones are complete."""
_INSTALLED = Path("/usr/lib/postgresql")
_QUERY = {"host": "PGHOST", "port": "PGPORT", "passfile": "PGPASSFILE", "service": "PGSERVICE"} | {
    name: f"PG{name.upper()}" for name in ("sslmode", "sslrootcert", "sslcert", "sslkey")
}
"""Query parameters of a database URL that are passed on, and the variables in which the tools look for them."""
_NEUTRAL = ("--no-owner", "--no-privileges", "--no-password")
_TABLE_BEGINS = re.compile(r'(?:dumping contents of|processing data for) table "(?:[^"]*\.)?([^".]+)"')
"""Pattern of what the tools say, with `--verbose`, when they begin with the rows of a table."""
Report = Callable[[int, int], None]


class ToolFailed(RuntimeError):
    """A PostgreSQL tool is missing or failed; the message is the tool's."""


def dump(connection: Connection, file: Path, rows: Mapping[str, int], report: Report) -> None:
    """Write what a REPEATABLE READ transaction sees into an archive.

    rows: number of rows of each table. report: receives the numbers of rows done and to do.

    Raises ToolFailed.
    """
    connection.execute(
        text("SET LOCAL idle_in_transaction_session_timeout = 0")
    )  # this transaction is idle while the tool runs
    snapshot = connection.scalar(text("SELECT pg_export_snapshot()"))
    arguments = (f"--schema={_schema(connection)}", f"--snapshot={snapshot}", f"--file={file}", *_NEUTRAL)
    _run("pg_dump", "--format=custom", *arguments, url=connection.engine.url, note_line=_table_by_table(rows, report))


def load(engine: Engine, file: Path, rows: Mapping[str, int], report: Report) -> None:
    """Restore an archive in one transaction; rows and report as for `dump`. Raises ToolFailed."""
    with engine.connect() as connection:
        schema = _schema(connection)
    arguments = (f"--schema={schema}", f"--dbname={engine.url.database}", *_NEUTRAL, str(file))
    note_line = _table_by_table(rows, report)
    _run("pg_restore", "--single-transaction", "--exit-on-error", *arguments, url=engine.url, note_line=note_line)


@contextmanager
def set_aside(engine: Engine) -> Iterator[None]:
    """Move all existing objects into another schema during a restore; move them back when it fails. Raises ToolFailed."""
    with engine.begin() as connection:
        schema = _schema(connection)
        if interrupted(connection):
            _put_back(connection, schema)
        connection.execute(text(f"CREATE SCHEMA {ASIDE}"))
        _move(connection, schema, ASIDE)
    try:
        yield
    except BaseException:
        with engine.begin() as connection:
            _put_back(connection, schema)
        raise
    with engine.begin() as connection:
        connection.execute(text(f"DROP SCHEMA {ASIDE} CASCADE"))
        connection.execute(text("ANALYZE"))


def interrupted(connection: Connection) -> bool:
    """Return whether a restore was killed: the old data are set aside, and the present ones must not be used."""
    return connection.engine.dialect.name == "postgresql" and inspect(connection).has_schema(ASIDE)


def _put_back(connection: Connection, schema: str) -> None:
    for one in _objects(connection, schema):
        connection.execute(text(f"DROP {one} CASCADE"))
    _move(connection, ASIDE, schema)
    connection.execute(text(f"DROP SCHEMA {ASIDE}"))


def _schema(connection: Connection) -> str:
    return str(connection.scalar(text("SELECT current_schema()")))


def _move(connection: Connection, old: str, new: str) -> None:
    for one in _objects(connection, old):
        connection.execute(text(f'ALTER {one} SET SCHEMA "{new}"'))


def _objects(connection: Connection, schema: str) -> list[str]:
    """Return the tables, and the functions that belong to no extension, as SQL commands name them."""
    functions = """
        SELECT format('FUNCTION %I.%I(%s)', n.nspname, p.proname, pg_get_function_identity_arguments(p.oid))
        FROM pg_proc p JOIN pg_namespace n ON n.oid = p.pronamespace
        WHERE n.nspname = :schema AND NOT EXISTS (SELECT 1 FROM pg_depend d WHERE d.objid = p.oid AND d.deptype = 'e')
    """
    tables = [f'TABLE "{schema}"."{name}"' for name in inspect(connection).get_table_names(schema)]
    return [*tables, *connection.scalars(text(functions), {"schema": schema})]


def _table_by_table(rows: Mapping[str, int], report: Report) -> Callable[[str], None]:
    """Return what listens to a tool: a table is done when the next one begins, and what follows the last takes no bar."""
    done, total = 0, max(sum(rows.values()), 1)
    running = 0

    def note_line(line: str) -> None:
        nonlocal done, running
        begins = _TABLE_BEGINS.search(line)
        if begins:
            done, running = done + running, rows.get(begins[1], 0)
            report(done, total)

    return note_line


def _run(tool: str, *arguments: str, url: URL, note_line: Callable[[str], None]) -> None:
    command = [_program(tool), "--verbose", *arguments]
    # In English, which `note_line` understands.
    environment = os.environ | _environment(url) | {"LC_ALL": "C"}
    said: list[str] = []
    try:
        process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment)
    except OSError as error:
        raise ToolFailed(f"{tool} cannot be run: {error}") from error
    with process as running:
        try:
            for line in running.stderr or ():
                note_line(line)
                if said or "error: " in line:
                    said.append(line)
        except BaseException:
            running.kill()  # it would go on while what it has done is taken back
            raise
    if running.returncode != 0:
        raise ToolFailed(f"{tool} failed: {''.join(said).strip() or f'status {running.returncode}'}")


def _environment(url: URL) -> Mapping[str, str]:
    """Return the connection settings as environment variables: everybody can see the arguments of a process."""
    found = {
        "PGHOST": url.host,
        "PGPORT": None if url.port is None else str(url.port),
        "PGUSER": url.username,
        "PGPASSWORD": url.password,
        "PGDATABASE": url.database,
    }
    found |= {_QUERY[name]: value for name, value in url.query.items() if name in _QUERY and isinstance(value, str)}
    return {name: value for name, value in found.items() if value is not None}


def _program(tool: str) -> str:
    """Return the newest installed version of a tool: it must not be older than the server. Raises ToolFailed."""
    versions = sorted(_INSTALLED.glob(f"*/bin/{tool}"), key=lambda path: int(path.parts[-3]))
    found = str(versions[-1]) if versions else shutil.which(tool)
    if found is None:
        raise ToolFailed(f"{tool} is not installed: it belongs to PostgreSQL's client programs (package postgresql-client)")
    return found
