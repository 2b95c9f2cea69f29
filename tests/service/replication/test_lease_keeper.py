"""The thread that keeps a replica registered: it takes over what the dead held, and tells what hinders it."""

import pytest

from service.replication import lease_keeper
from service.replication.lease_keeper import LeaseKeeper
from service.replication.work_share import INGEST, lease_of
from storage.database.engine import Database
from storage.database.errors import LeaseLost
from storage.findings import jobs
from storage.operation import leases, replicas
from storage.tables.findings import JobRow
from tests.plant import KEY, wait_until


def test_a_round_takes_over_what_the_dead_held_and_were_computing(plant: Database) -> None:
    """On PostgreSQL as well: the dead one holds no lock of its number."""
    with plant.transaction() as session:
        dead = replicas.join(session, role="all", host="gone", process=2)
        leases.ensure(session, INGEST)
        leases.acquire(session, INGEST, holder=dead, most=32)
        jobs.enqueue(session, KEY.machine, scope=jobs.RUN, run_ids=[1])
        jobs.claim_next(session, 1, holder=dead)
        row = next(one for one in replicas.list_all(session) if one.id == dead)
        row.seen_at -= int(2 * replicas.LEASE_S * 1e9)
    plant.claim(shared=True)
    living = LeaseKeeper(plant, "all")
    living.start()
    try:
        assert living.is_owner(KEY.machine)
        with plant.transaction(beside_others=True) as session:
            living.require(session, [KEY.machine])
            assert [one.id for one in replicas.list_all(session)] == [living.holder]
            assert session.query(JobRow).one().state == jobs.QUEUED
    finally:
        living.stop()
    with plant.transaction() as session:
        assert set(leases.holders(session).values()) == {None}
        with pytest.raises(LeaseLost, match=lease_of(KEY.machine)):
            living.require(session, [KEY.machine])


class FailingKeeper(LeaseKeeper):
    """Meets what nobody expected, until it is told that this is over."""

    puzzled = False

    def _round(self) -> None:
        if self.puzzled:
            raise LookupError("no such thing")
        super()._round()


def test_what_nobody_expected_is_reported_until_it_is_over(plant: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lease_keeper, "ROUND_S", 0.02)
    plant.claim(shared=True)
    living = FailingKeeper(plant, "all")
    living.start()
    try:
        living.puzzled = True
        wait_until(lambda: living.trouble == "this replica's heartbeat cannot be stored: unexpected error; the log has it")
        living.puzzled = False
        wait_until(lambda: living.trouble is None)
    finally:
        living.stop()
