"""Replicas and leases: who lives, who owns what, and that nobody writes what is another's."""

import pytest

from service.replication.work_share import DELIVERY, INGEST
from storage.database.engine import Database
from storage.database.errors import LeaseLost
from storage.findings import jobs
from storage.operation import leases, replicas
from storage.tables.findings import JobRow
from tests.plant import KEY


def join(database: Database) -> int:
    with database.transaction() as session:
        leases.ensure(session, [*INGEST, DELIVERY])
        return replicas.join(session, role="all", host="here", process=1)


def test_a_lease_is_one_replicas_at_a_time(database: Database) -> None:
    first, second = join(database), join(database)
    assert first < second
    with database.transaction() as session:
        assert leases.acquire(session, INGEST, holder=first, most=3) == set(INGEST[:3])
        assert leases.acquire(session, INGEST, holder=second, most=3) == set(INGEST[3:6])
    with database.transaction(beside_others=True) as session:
        leases.require(session, INGEST[:2], holder=first)
        with pytest.raises(LeaseLost, match=INGEST[3]):
            leases.require(session, [INGEST[0], INGEST[3]], holder=first)
    with database.transaction() as session:
        leases.release(session, INGEST[:1], holder=first)
        leases.release(session, INGEST[3:4], holder=first)  # not its own: nothing
        assert leases.held(session, holder=first) == set(INGEST[1:3])
        leases.release_all(session, holder=second)
        assert leases.held(session, holder=second) == set()


def test_numbers_are_never_given_twice(database: Database) -> None:
    first = join(database)
    with database.transaction() as session:
        replicas.forget(session, first)
        assert not replicas.heartbeat(session, first)
    assert join(database) > first


def test_who_was_taken_for_gone_gets_no_job_and_what_nobody_computes_is_put_back(plant: Database) -> None:
    number = join(plant)
    with plant.transaction() as session:
        jobs.enqueue(session, KEY.machine, scope=jobs.RUN, run_ids=[1])
        assert len(jobs.claim_next(session, 5, holder=number)) == 1
        replicas.forget(session, number)
        assert jobs.requeue_running(session, living=[number + 1]) == 1
        assert jobs.claim_next(session, 5, holder=number) == []
        (row,) = session.query(JobRow).all()
        assert (row.state, row.attempts, row.holder) == (jobs.QUEUED, 0, None)
