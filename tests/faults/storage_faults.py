"""Faults of a store while samples come in, each as a context: it is so for a while, then it is over."""

import contextlib
import os
import resource
import shutil
import sqlite3
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path

from sqlalchemy import make_url

from tests.faults.chain import Chain
from tests.postgresql import PostgresServer, server

RATE = 100.0
UNREADY_S, RECOVERED_S = 12.0, 10.0
"""Within this time the service says that it cannot store; within that one after the end of it all is as before."""
TMPFS_MB = 24

Hindrance = Callable[[Chain], AbstractContextManager[None]]


def hindered(
    folder: Path, hindrances: dict[str, Hindrance], *, seconds: float, samples: int, database: str | None = None
) -> dict[str, float]:
    """One chain that meets these hindrances one after the other, each for so long; nothing is lost and nothing comes twice.

    Returns how long it took to be ready after each [s].
    """
    recovered = {}
    with Chain(folder, samples=samples, rate=RATE, database=database) as chain:
        chain.wait_received(50)
        for name, hindrance in hindrances.items():
            with hindrance(chain):
                began = time.monotonic()
                chain.wait_ready(ready=False, within_s=UNREADY_S)
                time.sleep(max(0.0, seconds - (time.monotonic() - began)))
                assert chain.service.client.get("/ready").status_code == 503, f"{name}: ready though it is not over"
            recovered[name] = chain.wait_ready(ready=True, within_s=RECOVERED_S)
            before = chain.received()
            chain.wait_received(min(before + 1, samples), within_s=RECOVERED_S)
        chain.check_exact()
    return recovered


@contextlib.contextmanager
def locked(chain: Chain) -> Iterator[None]:
    """Another process holds the writer's lock of the SQLite file."""
    with contextlib.closing(sqlite3.connect(_file(chain), isolation_level=None, timeout=30.0)) as other:
        other.execute("BEGIN IMMEDIATE")
        yield
        other.execute("ROLLBACK")


@contextlib.contextmanager
def full(chain: Chain) -> Iterator[None]:
    """No byte is free on the disk; where the store has no disk of its own, its files may not grow."""
    ballast = _file(chain).with_name("ballast")
    if not os.path.ismount(ballast.parent):
        with _largest_file(chain, max(one.stat().st_size for one in _files(chain))):
            yield
        return
    with contextlib.suppress(OSError), ballast.open("wb", buffering=0) as file:
        while True:
            file.write(bytes(4096))
    yield
    ballast.unlink()


@contextlib.contextmanager
def read_only(chain: Chain) -> Iterator[None]:
    """Make the store's files read-only; where that cannot be done, let no byte be written to any file."""
    changed = subprocess.run(["chattr", "+i", *map(str, _files(chain))], capture_output=True, check=False)
    if changed.returncode == 0:
        try:
            yield
        finally:
            subprocess.run(["chattr", "-i", *map(str, _files(chain))], capture_output=True, check=True)
    else:
        with _largest_file(chain, 0):
            yield


def stopped(one: PostgresServer) -> Hindrance:
    """The PostgreSQL server is shut down, and started again."""

    return lambda _chain: one.away()


@contextlib.contextmanager
def own_disk(folder: Path) -> Iterator[Path]:
    """A folder on a small file system of its own; just a folder where that cannot be made."""
    folder.mkdir()
    made = os.geteuid() == 0 and shutil.which("mount") is not None
    if made:
        command = ["mount", "-t", "tmpfs", "-o", f"size={TMPFS_MB}m", "tmpfs", str(folder)]
        made = subprocess.run(command, capture_output=True, check=False).returncode == 0
    try:
        yield folder
    finally:
        if made:
            subprocess.run(["umount", str(folder)], check=True)


@contextlib.contextmanager
def own_server() -> Iterator[tuple[PostgresServer, str]]:
    """A PostgreSQL server that may be stopped, as durable as a plant's, and a new database on it."""
    with server() as one:
        one.execute("CREATE DATABASE faults")
        yield one, one.database("faults")


@contextlib.contextmanager
def _largest_file(chain: Chain, size: int) -> Iterator[None]:
    """The service can write no file beyond a size."""
    pid = chain.pid("service")
    before = resource.prlimit(pid, resource.RLIMIT_FSIZE)
    resource.prlimit(pid, resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.prlimit(pid, resource.RLIMIT_FSIZE, before)


def _file(chain: Chain) -> Path:
    return Path(make_url(chain.service.database).database or "")


def _files(chain: Chain) -> list[Path]:
    return [one for one in (_file(chain), _file(chain).with_name(_file(chain).name + "-wal")) if one.exists()]
