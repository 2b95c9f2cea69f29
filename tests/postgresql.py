"""A throwaway PostgreSQL server: its own directory, a free port on loopback, ended by its process id.

The server refuses to be run by root, who runs it as the user `postgres` that its package makes, or as `nobody`.
"""

import contextlib
import functools
import os
import pwd
import re
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import psutil
import psycopg
import pytest
from sqlalchemy import make_url

from tests.ports import free_port

START_TIMEOUT_S = 30.0
FAST = ("fsync=off", "full_page_writes=off", "synchronous_commit=off", "max_wal_size=128MB")
"""Settings of a server whose data nobody needs after a crash."""
MEMORY = Path("/dev/shm")
"""Files that lie in memory, on Linux: a database, hundreds of files, is made there in a fifth of the time."""
ROOM_BYTES = 4 * 2**30
"""Room there from which a server may take its own; containers have 64 MB."""


class PostgresServer:
    """A server that can be stopped and started again. url: of its database `postgres`, as its owner."""

    def __init__(self, folder: Path, *settings: str) -> None:
        self._folder = folder
        self._settings = settings
        self._process: subprocess.Popen[bytes] | None = None
        self.log = folder / "server.log"
        self.port = free_port()
        command = [program("initdb"), "--pgdata", str(folder / "data"), "--username", "rundown", "--auth", "trust"]
        # A plant's server has a language's collation: lists must not depend on it.
        command += ["--encoding", "UTF8", "--locale-provider", "icu", "--icu-locale", "en-US", "--locale", "C.UTF-8"]
        subprocess.run([*command, "--no-sync"], check=True, stdout=subprocess.DEVNULL, user=_user(), cwd=folder)

    @property
    def url(self) -> str:
        return self.database("postgres")

    def database(self, name: str) -> str:
        """URL of one of its databases."""
        return f"postgresql+psycopg://rundown@127.0.0.1:{self.port}/{name}"

    def start(self) -> None:
        """Start it, and wait until it answers."""
        options = [f"port={self.port}", "listen_addresses=127.0.0.1", f"unix_socket_directories={self._folder}"]
        flags = [part for option in [*options, *self._settings] for part in ("-c", option)]
        with self.log.open("ab") as output:
            self._process = subprocess.Popen(
                [program("postgres"), "-D", str(self._folder / "data"), *flags],
                stdout=output,
                stderr=subprocess.STDOUT,
                user=_user(),
                cwd=self._folder,
            )
        deadline = time.monotonic() + START_TIMEOUT_S
        while not self._answers():
            assert self._process.poll() is None, self.log.read_text()
            assert time.monotonic() < deadline, f"no answer from PostgreSQL: {self.log.read_text()}"
            time.sleep(0.02)

    def stop(self, how: signal.Signals = signal.SIGINT) -> None:
        """SIGINT: connections are ended, then it shuts down; SIGQUIT: at once, as after a crash."""
        if self._process is not None:
            self._process.send_signal(how)
            self._process.wait(START_TIMEOUT_S)
            self._process = None

    @contextlib.contextmanager
    def away(self) -> Iterator[None]:
        """Shut it down, and start it again afterwards."""
        self.stop()
        try:
            yield
        finally:
            self.start()

    @contextlib.contextmanager
    def frozen(self) -> Iterator[None]:
        """Let it accept connections and queries and answer none, like a machine that is stopped or starved."""
        assert self._process is not None
        every = [psutil.Process(self._process.pid)]
        every[0].suspend()
        every += every[0].children()
        for one in every[1:]:
            one.suspend()
        try:
            yield
        finally:
            for one in every:
                one.resume()

    def execute(self, command: str, database: str = "postgres") -> None:
        """One command, outside a transaction."""
        with connection(self.database(database)) as session:
            session.execute(command)

    def _answers(self) -> bool:
        with contextlib.suppress(psycopg.OperationalError), connection(self.url):
            return True
        return False


@contextlib.contextmanager
def server(*settings: str) -> Iterator[PostgresServer]:
    """A running server; skips the test, or fails it where nothing may be missing, when PostgreSQL is not installed."""
    if program("postgres") == "":
        if os.environ.get("RUNDOWN_REQUIRE_ALL"):
            pytest.fail("PostgreSQL is not installed; .ci/run installs it")
        pytest.skip("PostgreSQL is not installed")
    # Not below pytest's own folders, into which no other user may look.
    folder = Path(tempfile.mkdtemp(prefix="rundown-postgresql-", dir=_in_memory() if "fsync=off" in settings else None))
    try:
        if (user := _user()) is not None:
            shutil.chown(folder, user)
        one = PostgresServer(folder, *settings)
        one.start()
        try:
            yield one
        finally:
            one.stop(signal.SIGQUIT)
    finally:
        shutil.rmtree(folder)


@contextlib.contextmanager
def connection(url: str) -> "Iterator[psycopg.Connection[tuple[object, ...]]]":
    """A connection past SQLAlchemy, each statement a transaction of its own."""
    parts = make_url(url)
    with psycopg.connect(host=parts.host, port=parts.port, dbname=parts.database, user=parts.username, autocommit=True) as one:
        yield one


def program(name: str) -> str:
    """A program of the server, which distributions keep out of the path; the newest one, empty where there is none."""
    versions = sorted(Path("/usr/lib/postgresql").glob(f"*/bin/{name}"), key=lambda path: int(path.parts[-3]))
    return str(versions[-1]) if versions else shutil.which(name) or ""


@functools.cache
def version() -> int:
    """Version of the server's programs."""
    told = subprocess.run([program("postgres"), "--version"], capture_output=True, text=True, check=True).stdout
    return int(re.findall(r"\d+", told)[0])


def _in_memory() -> Path | None:
    if MEMORY.is_dir() and os.access(MEMORY, os.W_OK) and shutil.disk_usage(MEMORY).free >= ROOM_BYTES:
        return MEMORY
    return None


def _user() -> str | None:
    if os.geteuid() != 0:
        return None
    with contextlib.suppress(KeyError):
        return pwd.getpwnam("postgres").pw_name
    return "nobody"
