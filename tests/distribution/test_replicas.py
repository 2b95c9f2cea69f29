"""Several processes on one PostgreSQL database: who stores what, owners that are killed or frozen, samples over HTTP."""

import contextlib
import signal
import time
from pathlib import Path

import pytest
from sqlalchemy.exc import DBAPIError

from formats.wire import JSON, encode_body
from service.replication.lease_keeper import LeaseKeeper
from service.replication.work_share import lease_of
from storage.database.engine import Database
from storage.operation import leases, replicas
from tests.databases import PostgresqlDatabases
from tests.distribution.layout import Layout
from tests.end_to_end.processes import rundown, until
from tests.faults.measured import measured
from tests.plant import KEY
from tests.ports import free_port
from tests.postgresql import PostgresServer

TAKEN_OVER_WITHIN_S = 30.0


def owner(layout: Layout, among: tuple[str, ...]) -> str:
    """The replica that stores the machine's samples."""
    for row in layout.get("api1", "/replicas"):
        if lease_of(KEY.machine) in row["leases"]:
            return next(name for name in among if layout.pid(name) == row["process"])
    raise AssertionError("nobody owns the machine")


@pytest.mark.long
def test_an_owner_that_is_killed_or_freezes_is_replaced_and_nothing_is_lost(layout: Layout) -> None:
    samples, rate = 6000, 150.0
    layout.start_ready("api1", "ingest1", "ingest2")
    layout.create_machine("api1")
    until(lambda: sorted(layout.shares("api1").values()) == [0, 16, 16], within_s=15, what="both ingests have their share")
    layout.start_source(samples=samples, rate=rate)
    both = ("ingest1", "ingest2")
    until(lambda: layout.received("api1") >= 300, within_s=30, what="samples come")

    killed = owner(layout, both)
    other = next(name for name in both if name != killed)
    layout.kill(killed)
    stopped_at, before = time.monotonic(), layout.received("api1")
    until(lambda: layout.received("api1") > before + 200, within_s=TAKEN_OVER_WITHIN_S, what="the other takes over")
    assert time.monotonic() - stopped_at < TAKEN_OVER_WITHIN_S
    assert owner(layout, (other,)) == other

    layout.start_ready(killed)
    until(lambda: sorted(layout.shares("api1").values()) == [0, 16, 16], within_s=15, what="the shares are fair again")
    frozen = owner(layout, both)
    layout.send(frozen, signal.SIGSTOP)
    try:
        before = layout.received("api1")
        until(lambda: layout.received("api1") > before + 200, within_s=TAKEN_OVER_WITHIN_S, what="a frozen one is replaced")
    finally:
        layout.send(frozen, signal.SIGCONT)
    layout.check_exact("api1", samples, within_s=90)


@pytest.mark.long
def test_samples_over_http_reach_the_owner_whichever_replica_is_asked(layout: Layout) -> None:
    layout.start_ready("api1", "ingest1", "ingest2")
    layout.create_machine("api1")
    until(lambda: sorted(layout.shares("api1").values()) == [0, 16, 16], within_s=15, what="both ingests have their share")
    first = 0
    for name in ("api1", "ingest1", "ingest2"):
        body = encode_body(measured(first, 50), JSON)
        answer = layout.client(name).post(f"/machines/{KEY.machine}/samples", content=body, headers={"content-type": JSON})
        assert answer.status_code == 200, answer.text
        assert (answer.json()["received"], answer.json()["missing_before"]) == (50, 0)
        first += 50
    answer = layout.client("api1").post(f"/machines/{KEY.machine}/samples", content=b"{}", headers={"content-type": JSON})
    assert answer.status_code == 400
    layout.stop("ingest1")
    layout.stop("ingest2")
    answer = layout.client("api1").post(
        f"/machines/{KEY.machine}/samples", content=encode_body(measured(first, 50), JSON), headers={"content-type": JSON}
    )
    assert answer.status_code == 503
    assert "no replica takes samples" in answer.json()["detail"]
    assert layout.received("api1") == 150


def test_a_replica_that_stops_leaves_its_share_at_once(layout: Layout) -> None:
    layout.start_ready("ingest1", "ingest2")
    until(lambda: sorted(layout.shares("ingest1").values()) == [16, 16], within_s=15, what="both ingests have their share")
    layout.stop("ingest2")
    until(lambda: list(layout.shares("ingest1").values()) == [32], within_s=5, what="one has it all")


def test_roles_need_postgresql(tmp_path: Path) -> None:
    told = rundown("serve", "--role", "ingest", "--database", f"sqlite:///{tmp_path / 'rundown.db'}")
    assert told.returncode == 1
    assert "needs a PostgreSQL database" in told.stderr
    assert not (tmp_path / "rundown.db").exists()


@pytest.mark.long
def test_who_hangs_in_the_middle_of_a_transaction_keeps_nobody_waiting_for_long(
    tmp_path: Path, postgresql: PostgresServer
) -> None:
    """The server ends it: until then the others wait with what they write alone, and go on saying that they live."""
    databases = PostgresqlDatabases(postgresql)
    url = databases.new(tmp_path / "hangs.db")
    hanging, waiting = Database(url), Database(url)
    waiting.claim(shared=True)
    leasing = LeaseKeeper(waiting, "all")
    leasing.start()
    try:
        with contextlib.suppress(DBAPIError), hanging.transaction() as session:
            leases.release_all(session, holder=leasing.holder or 0)  # holds the writers' lock and the rows
            began = time.monotonic()
            with waiting.transaction(beside_others=True) as own:
                assert replicas.heartbeat(own, leasing.holder or 0)
            assert time.monotonic() - began < 2.0
            with waiting.transaction() as own:  # waits for the server's patience to end
                leases.require(own, [lease_of(KEY.machine)], holder=leasing.holder or 0)
            assert time.monotonic() - began < TAKEN_OVER_WITHIN_S / 2
    finally:
        leasing.stop()
        hanging.close()
        waiting.close()
        databases.drop(url)


def test_a_router_is_not_opened_to_everybody_unless_told_twice() -> None:
    told = rundown("router", "--listen", f"tcp/0.0.0.0:{free_port()}")
    assert told.returncode == 1
    assert "RUNDOWN_ZENOH_ACCESS" in told.stderr
