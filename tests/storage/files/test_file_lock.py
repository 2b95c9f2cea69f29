"""One service at a time on an SQLite file, by whatever name; nothing else opens it by another name while one runs."""

import os
import shutil
import sqlite3
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest

from storage.backup import backup
from storage.database.claim import DatabaseUnusable, in_use
from storage.database.engine import Database
from storage.machines import machines
from tests.plant import machine, sqlite_url

HOLDS = """
import sys
from storage.database.engine import Database
database = Database(sys.argv[1])
database.claim()
print("held", flush=True)
sys.stdin.read()
database.close()
"""


@contextmanager
def service(url: str) -> Iterator[None]:
    """Another process that has the claim on a store."""
    command = [sys.executable, "-c", HOLDS, url]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as other:
        assert other.stdin is not None
        assert other.stdout is not None
        assert other.stdout.readline() == "held\n"
        yield
        other.stdin.close()
        assert other.wait(10) == 0


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A store that nobody uses."""
    found = tmp_path / "rundown.db"
    database = Database(sqlite_url(found))
    with database.transaction() as session:
        machines.create(session, machine())
    database.close()
    return found


@pytest.fixture
def other_name(path: Path) -> Path:
    """A hard link to it, in another folder."""
    found = path.parent / "elsewhere" / "same.db"
    found.parent.mkdir()
    os.link(path, found)
    return found


def test_a_second_service_on_a_hard_link_is_refused(path: Path, other_name: Path) -> None:
    backup.back_up(sqlite_url(path), path.parent / "backup")
    with service(sqlite_url(path)):
        with pytest.raises(DatabaseUnusable, match=r"same\.db is another name of a file that a service uses"):
            Database(sqlite_url(other_name))
        with pytest.raises(DatabaseUnusable, match=r"is another name"):
            backup.back_up(sqlite_url(other_name), path.parent / "second")
        with pytest.raises(DatabaseUnusable, match="in use by another service"):
            backup.restore(sqlite_url(other_name), path.parent / "backup", overwrite=True)
    assert [one.name for one in other_name.parent.iterdir()] == ["same.db"]


def test_so_it_is_in_one_process(path: Path, other_name: Path) -> None:
    first = Database(sqlite_url(path))
    second = Database(sqlite_url(other_name))
    first.claim()
    with pytest.raises(DatabaseUnusable, match="in use by another service"):
        second.claim()
    second.close()
    first.close()


def test_by_the_same_name_others_may_look(path: Path) -> None:
    with service(sqlite_url(path)):
        assert in_use(path)
        with closing(Database(sqlite_url(path))) as database, database.reading() as session:
            assert machines.list_ids(session) == ["pump-7"]
    assert not in_use(path)


def opened(path: Path) -> int:
    """Return how many descriptors of a file this process has."""
    links = [Path(f"/proc/self/fd/{name}") for name in os.listdir("/proc/self/fd")]
    return sum(one.exists() and one.samefile(path) for one in links)


def test_what_is_closed_leaves_nothing_open(path: Path) -> None:
    """A disk could not be unmounted otherwise."""
    first, second = Database(sqlite_url(path)), Database(sqlite_url(path))
    first.claim()
    first.close()
    assert opened(path) > 0
    second.close()
    backup.back_up(sqlite_url(path), path.parent / "backup")
    assert opened(path) == 0


@pytest.mark.parametrize("end", ["-wal", "-shm"])
def test_beside_a_service_no_command_makes_a_second_log(path: Path, end: str) -> None:
    backup.back_up(sqlite_url(path), path.parent / "before")
    with service(sqlite_url(path)):
        path.with_name(path.name + end).unlink()
        with pytest.raises(DatabaseUnusable, match=rf"rundown\.db{end} is missing though a service uses .*: stop it cleanly"):
            Database(sqlite_url(path))
        with pytest.raises(DatabaseUnusable, match="is missing"):
            backup.back_up(sqlite_url(path), path.parent / "backup")
        assert not path.with_name(path.name + end).exists()
    Database(sqlite_url(path)).close()


@pytest.mark.skipif(os.geteuid() != 0 or shutil.which("unshare") is None, reason="only root may mount")
def test_a_second_service_on_a_bind_mount_is_refused(path: Path, tmp_path: Path) -> None:
    mounted = tmp_path / "mounted" / "rundown.db"
    mounted.parent.mkdir()
    mounted.touch()
    script = f"mount --bind {path} {mounted} || exit 77; exec {sys.executable} -c '{HOLDS}' {sqlite_url(mounted)}"
    with service(sqlite_url(path)):
        second = subprocess.run(["unshare", "-m", "sh", "-c", script], input="", capture_output=True, text=True, check=False)
    if second.returncode == 77:
        pytest.skip("nothing can be mounted here")
    assert second.returncode == 1
    assert "is another name of a file that a service uses" in second.stderr


def test_the_claim_neither_takes_sqlites_locks_nor_meets_them(path: Path) -> None:
    """Closing a descriptor of the file would let another process take this one's place."""
    database, refused = Database(sqlite_url(path)), Database(sqlite_url(path))
    with database.transaction() as session:
        machines.create(session, machine(id="second"))
        database.claim()
        with pytest.raises(DatabaseUnusable, match="in use"):
            refused.claim()
        script = f"import sqlite3; sqlite3.connect({str(path)!r}, timeout=0).execute('BEGIN IMMEDIATE')"
        other = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
        assert "database is locked" in other.stderr
    refused.close()
    # The shared lock that every open connection has: without it another one would take itself for the last.
    script = f"import sqlite3; sqlite3.connect({str(path)!r}).execute('SELECT count(*) FROM machines').fetchall()"
    subprocess.run([sys.executable, "-c", script], check=True)
    assert path.with_name("rundown.db-wal").exists()
    database.close()
    with closing(sqlite3.connect(path)) as again:
        assert again.execute("SELECT count(*) FROM machines").fetchone() == (2,)
