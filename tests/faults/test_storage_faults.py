"""The store is locked, full, read-only or away for a while: the service says so, recovers by itself, and nothing is lost.

These are the short forms; `python -m benchmarks.faults --only store` has the long ones.
"""

from pathlib import Path

import pytest

from tests.faults.storage_faults import full, hindered, locked, own_disk, own_server, read_only, stopped
from tests.plant import sqlite_url


@pytest.mark.long
def test_a_file_that_is_locked_and_then_read_only(tmp_path: Path) -> None:
    hindered(tmp_path, {"locked": locked, "read-only": read_only}, seconds=3.0, samples=1400)


@pytest.mark.long
def test_a_disk_that_is_full(tmp_path: Path) -> None:
    with own_disk(tmp_path / "disk") as folder:
        hindered(tmp_path, {"full": full}, seconds=3.0, samples=700, database=sqlite_url(folder / "rundown.db"))


@pytest.mark.long
def test_a_server_that_is_stopped(tmp_path: Path) -> None:
    with own_server() as (one, database):
        hindered(tmp_path, {"stopped": stopped(one)}, seconds=4.0, samples=900, database=database)
