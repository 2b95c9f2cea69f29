"""The service's user loses the right to the store's folder for a while: it says so, loses nothing, and goes on by itself."""

import os
import subprocess
import sys
from pathlib import Path

from tests.paths import ROOT

PREPARED = """
import os, sqlite3, sys
from contextlib import closing, suppress
from pathlib import Path
from sqlalchemy import text
from sqlalchemy.exc import OperationalError
from storage.database.claim import DatabaseUnusable
from storage.database.engine import Database
from storage.machines import machines
from tests.plant import machine, sqlite_url

folder = Path(sys.argv[1])

def by_the_owner(mode):
    if os.getuid() == 0:
        os.seteuid(0)
    folder.chmod(mode)
    if os.getuid() == 0:
        os.seteuid(65534)

def add(name):
    with database.transaction() as session:
        machines.create(session, machine(id=name))

# What is imported on first use may not be readable to somebody else.
Database(sqlite_url(folder.with_name("first.db"))).close()
if os.getuid() == 0:
    os.chown(folder, 65534, 65534)
by_the_owner(0o700)
database = Database(sqlite_url(folder / "rundown.db"))
add("before")
"""

GIVEN_BACK = """
by_the_owner(0)
for attempt in (lambda: add("refused"), database.check):
    try:
        attempt()
    except (OperationalError, DatabaseUnusable) as error:
        assert "has lost the permission" in str(error), error
    else:
        raise AssertionError("it was taken")
assert not database.needs_restart
by_the_owner(0o700)
database.check()
add("after")
with database.reading() as session:
    print(*session.scalars(text("SELECT id FROM machines ORDER BY id")))
database.close()
"""

DELETED = """
by_the_owner(0)
with suppress(DatabaseUnusable):
    database.check()
by_the_owner(0o700)
(folder / "rundown.db-wal").unlink()
by_the_owner(0)
try:
    database.check()
except DatabaseUnusable as error:
    assert "has lost the permission" in str(error), error
by_the_owner(0o700)
try:
    database.check()
except DatabaseUnusable as error:
    assert "rundown.db-wal was deleted" in str(error), error
assert database.needs_restart
with closing(sqlite3.connect(f"file:{folder / 'rundown.db'}?immutable=1", uri=True)) as other:
    print(*other.execute("SELECT id FROM machines").fetchone())
"""


def said_by(script: str, tmp_path: Path) -> list[str]:
    """Run a script over a store in a folder of its own, and return the words that it prints."""
    # Root may look into every folder: there the script goes on as somebody else.
    tmp_path.chmod(0o755)
    for above in tmp_path.parents:
        if not above.stat().st_mode & 0o001:
            above.chmod(above.stat().st_mode | 0o011)
    folder = tmp_path / "store"
    folder.mkdir()
    command = [sys.executable, "-c", PREPARED + script, str(folder)]
    done = subprocess.run(
        command, cwd=ROOT, env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


def test_a_folder_that_may_not_be_looked_into_for_a_while_costs_nothing(tmp_path: Path) -> None:
    assert said_by(GIVEN_BACK, tmp_path) == ["after", "before"]


def test_a_log_that_is_deleted_meanwhile_is_noticed_when_the_folder_is_given_back_and_loses_nothing(tmp_path: Path) -> None:
    assert said_by(DELETED, tmp_path) == ["before"]
