"""The log of an SQLite store is deleted, cut off or damaged under the service, or its main file written over: it says so.

Of a deleted log nothing is lost; of one that was cut off, what stood behind the cut, and the store stays whole. Where later
pages of the log hold what a damaged one held, nothing is lost and it goes on; otherwise nothing more is taken.
"""

import itertools
import os
import sqlite3
import subprocess
from collections.abc import Callable
from contextlib import closing, suppress
from pathlib import Path

import httpx
import pytest

from formats.wire import JSON, encode_body
from storage.database.engine import Database
from storage.machines import machines
from tests.end_to_end.processes import Service, rundown, until
from tests.faults.measured import SIZE, expected, measured, stored
from tests.plant import KEY, assert_same_samples, document, machine, sqlite_url
from tests.ports import free_port

BEFORE, TOLD_S = 15, 3.0
"""Batches that are acknowledged before the log is deleted; within this time the service says that it is gone [s]."""


def in_the_log(folder: Path) -> Service:
    """Return where a service makes a new store, of which all is in the log at first."""
    return Service(folder, database=sqlite_url(folder / "rundown.db"))


def send(service: Service, number: int) -> httpx.Response:
    body = encode_body(measured(number * SIZE), JSON)
    return service.client.post(f"/machines/{KEY.machine}/samples", content=body, headers={"content-type": JSON})


def acknowledged(service: Service, first: int, last: int) -> int:
    """Return how many of these batches were acknowledged, one after the other."""
    for number in range(first, last):
        if send(service, number).status_code != 200:
            return number
    return last


def nobody(_service: Service) -> None:
    """Do nothing meanwhile."""


def doctor(service: Service) -> None:
    """`rundown doctor`, as the runbook says."""
    told = rundown(
        "doctor",
        RUNDOWN_DATABASE=service.database,
        RUNDOWN_PORT=str(service.port),
        RUNDOWN_ZENOH_LISTEN=f'["tcp/127.0.0.1:{free_port()}"]',
    )
    assert "wrong    database" in told.stdout, told.stdout
    assert "was deleted or replaced" in told.stdout, told.stdout


def another_program(service: Service) -> None:
    """One that knows nothing of this, and makes logs of its own."""
    with closing(sqlite3.connect(service.folder / "rundown.db")) as other, suppress(sqlite3.Error):
        other.execute("SELECT count(*) FROM machines").fetchall()


def killed(started: "subprocess.Popen[bytes]") -> None:
    started.kill()
    started.wait()


def stopped(started: "subprocess.Popen[bytes]") -> None:
    started.terminate()
    assert started.wait(20) == 0


Meanwhile = Callable[[Service], None]
Ended = Callable[["subprocess.Popen[bytes]"], None]


def survives(folder: Path, ends: tuple[str, ...], *times: tuple[Meanwhile, Ended]) -> None:
    """Delete the log of a store that many times: each start goes on where the one before has ended."""
    service, count = in_the_log(folder), 0
    for meanwhile, ended in times:
        with service.running() as started:
            if count == 0:
                assert service.client.post("/machines", json=document()).status_code == 201
            else:
                require_all(service, count)
            assert acknowledged(service, count, count + BEFORE) == count + BEFORE
            for end in ends:
                (folder / f"rundown.db{end}").unlink()
            count = acknowledged(service, count + BEFORE, count + 2 * BEFORE)
            until(lambda: service.client.get("/ready").status_code == 503, within_s=TOLD_S, what="it is said")
            told = service.client.get("/health").json()["parts"]["database"]
            assert "was deleted or replaced" in told
            assert "is saved in" in told
            assert service.client.get("/alive").status_code == 503
            refused = send(service, count)
            assert refused.status_code == 503
            assert "was deleted or replaced" in refused.json()["detail"]
            meanwhile(service)
            ended(started)
    with service.running():
        require_all(service, count)
        assert send(service, count).status_code == 200
    service.client.close()
    numbers, samples = stored(folder / "rundown.db")
    assert numbers == list(range((count + 1) * SIZE))
    assert_same_samples(samples, expected((count + 1) * SIZE))


def require_all(service: Service, count: int) -> None:
    """Everything that was acknowledged is stored, and nothing counts as lost."""
    (row,) = service.get("/sources")
    assert (row["received"], row["lost"]) == (count * SIZE, 0)


def test_after_it_was_told_a_kill_loses_nothing(tmp_path: Path) -> None:
    survives(tmp_path, ("-wal",), (doctor, killed))


@pytest.fixture
def place(tmp_path: Path) -> Service:
    """Return where a service runs whose machine is in the main file, and not in the log."""
    database = Database(sqlite_url(tmp_path / "rundown.db"))
    with database.transaction() as session:
        machines.create(session, machine())
    database.close()
    return Service(tmp_path)


@pytest.mark.parametrize("ended", [killed, stopped])
def test_of_a_log_that_was_cut_off_the_store_stays_whole(tmp_path: Path, place: Service, ended: Ended) -> None:
    """Its source sends again what the service says that it lacks."""
    service = place
    with service.running() as started:
        assert acknowledged(service, 0, BEFORE) == BEFORE
        os.truncate(tmp_path / "rundown.db-wal", (tmp_path / "rundown.db-wal").stat().st_size // 2)
        until(lambda: service.client.get("/ready").status_code == 503, within_s=TOLD_S, what="it is said")
        assert "was cut off" in service.client.get("/health").json()["parts"]["database"]
        until(lambda: service.client.get("/alive").status_code == 503, within_s=TOLD_S, what="only a new start helps")
        refused = send(service, BEFORE)
        assert refused.status_code == 503
        assert "was cut off" in refused.json()["detail"]
        ended(started)
    with service.running():
        (row,) = service.get("/sources")
        assert 0 < row["received"] < BEFORE * SIZE
        assert (row["received"] % SIZE, row["lost"]) == (0, 0)
        assert acknowledged(service, row["received"] // SIZE, BEFORE) == BEFORE
    service.client.close()
    numbers, samples = stored(tmp_path / "rundown.db")
    assert numbers == list(range(BEFORE * SIZE))
    assert_same_samples(samples, expected(BEFORE * SIZE))


@pytest.mark.long
@pytest.mark.parametrize("ends", [("-wal",), ("-shm",), ("-wal", "-shm")])
def test_whatever_is_deleted_and_done_meanwhile(tmp_path: Path, ends: tuple[str, ...]) -> None:
    survives(tmp_path, ends, *itertools.product([nobody, doctor, another_program], [killed, stopped]))


def overwritten(service: Service, count: int, *, complete: bool) -> None:
    """A backup is copied over the open store; until the service has said so, and takes nothing more."""
    backup, store = service.folder / "backup", service.folder / "rundown.db"
    assert rundown("backup", str(backup), "--database", service.database).returncode == 0
    assert acknowledged(service, count, 2 * count) == 2 * count
    subprocess.run(["cp", str(backup), str(store)], check=True)
    until(lambda: service.client.get("/ready").status_code == 503, within_s=TOLD_S, what="it is said")
    refused = send(service, 2 * count)
    assert refused.status_code == 503
    assert "another file was written over the database file" in refused.json()["detail"]
    until(lambda: service.client.get("/alive").status_code == 503, within_s=3 * TOLD_S, what="only a new start helps")
    told = service.client.get("/health").json()["parts"]["database"]
    assert ("is written back" if complete else "`rundown restore`") in told


@pytest.mark.parametrize("ended", [killed, stopped])
def test_a_backup_copied_over_the_open_store_is_not_mixed_with_its_log(tmp_path: Path, place: Service, ended: Ended) -> None:
    """All that came since the backup is gone with the file; its source sends again what the service says that it lacks."""
    service = place
    with service.running() as started:
        assert acknowledged(service, 0, BEFORE) == BEFORE
        overwritten(service, BEFORE, complete=False)
        ended(started)
    with service.running():
        (row,) = service.get("/sources")
        assert (row["received"], row["lost"]) == (BEFORE * SIZE, 0)
        assert acknowledged(service, BEFORE, 2 * BEFORE) == 2 * BEFORE
    service.client.close()
    numbers, samples = stored(tmp_path / "rundown.db")
    assert numbers == list(range(2 * BEFORE * SIZE))
    assert_same_samples(samples, expected(2 * BEFORE * SIZE))


def test_where_the_log_has_all_a_copied_backup_costs_nothing(tmp_path: Path) -> None:
    service = in_the_log(tmp_path)
    with service.running() as started:
        assert service.client.post("/machines", json=document()).status_code == 201
        assert acknowledged(service, 0, BEFORE) == BEFORE
        overwritten(service, BEFORE, complete=True)
        killed(started)
    with service.running():
        (row,) = service.get("/sources")
        assert (row["received"], row["lost"]) == (2 * BEFORE * SIZE, 0)
    service.client.close()
    assert stored(tmp_path / "rundown.db")[0] == list(range(2 * BEFORE * SIZE))


def test_a_page_of_the_log_that_is_damaged_stops_nobody(tmp_path: Path) -> None:
    """A later page holds the same; behind a kill, SQLite would take nothing from the damaged one on."""
    service, log = in_the_log(tmp_path), tmp_path / "rundown.db-wal"
    with service.running() as started:
        assert service.client.post("/machines", json=document()).status_code == 201
        assert acknowledged(service, 0, BEFORE) == BEFORE
        frame = 24 + 4096
        content = log.read_bytes()[32:]
        pages = [content[at : at + 4] for at in range(0, len(content) - frame + 1, frame)]
        number = next(number for number, page in enumerate(pages) if page in pages[number + 1 :])
        with log.open("r+b") as opened:
            opened.seek(32 + number * frame + 24)
            opened.write(b"\xa5" * 4096)
        until(lambda: log.stat().st_size < 32 + (number + 1) * frame, within_s=TOLD_S, what="the log is begun anew")
        assert acknowledged(service, BEFORE, 2 * BEFORE) == 2 * BEFORE
        until(lambda: service.client.get("/health").status_code == 200, within_s=30, what="all was looked through")
        killed(started)
    assert "pages of its log were overwritten" in service.log.read_text()
    with service.running():
        (row,) = service.get("/sources")
        assert (row["received"], row["lost"]) == (2 * BEFORE * SIZE, 0)
    service.client.close()
    assert stored(tmp_path / "rundown.db")[0] == list(range(2 * BEFORE * SIZE))
