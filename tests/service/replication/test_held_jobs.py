"""Jobs that a replica holds: finished and put back by it alone, never those that another took over."""

from collections.abc import Callable, Iterator

import pytest

from service.replication.held_jobs import HeldJobs
from service.replication.lease_keeper import LeaseKeeper
from service.replication.work_share import WholeShare
from storage.database.engine import Database
from storage.findings import jobs
from storage.operation import replicas
from storage.tables.findings import JobRow
from tests.plant import KEY


def taken(database: Database, *, run: int = 1, holder: int | None = None) -> int:
    """Return a job that somebody holds."""
    with database.transaction() as session:
        jobs.enqueue(session, KEY.machine, scope=jobs.RUN, run_ids=[run])
        (row,) = jobs.claim_next(session, 1, holder=holder)
        return row.id


def state(database: Database, job_id: int) -> tuple[str, int, str | None]:
    with database.reading() as session:
        row = jobs.get(session, job_id)
        return row.state, row.attempts, row.error


@pytest.fixture
def leasing(plant: Database) -> Iterator[LeaseKeeper]:
    """A replica that is registered."""
    plant.claim(shared=True)
    found = LeaseKeeper(plant, "all")
    found.start()
    yield found
    found.stop()


Ending = Callable[[HeldJobs, int], None]
ENDINGS: list[tuple[Ending, tuple[str, int, str | None]]] = [
    (lambda held, job: held.finish(job), (jobs.DONE, 1, None)),
    (lambda held, job: held.fail(job, "too few samples"), (jobs.FAILED, 1, "too few samples")),
    (lambda held, job: held.fail_unread(job, "a page", damaged=True), (jobs.FAILED, 1, "its data cannot be read: a page")),
    (lambda held, job: held.requeue(job, "out of time"), (jobs.QUEUED, 1, None)),
    (lambda held, job: held.requeue_uncounted(job), (jobs.QUEUED, 0, None)),
]


@pytest.mark.parametrize(("ending", "expected"), ENDINGS)
def test_a_job_ends_as_its_holder_says(plant: Database, ending: Ending, expected: tuple[str, int, str | None]) -> None:
    job = taken(plant)
    ending(HeldJobs(plant, WholeShare()), job)
    assert state(plant, job) == expected


@pytest.mark.parametrize("ending", [ending for ending, _ in ENDINGS])
def test_a_job_that_another_took_over_is_left_to_that_one(plant: Database, leasing: LeaseKeeper, ending: Ending) -> None:
    with plant.transaction() as session:
        other = replicas.join(session, role="all", host="there", process=2)
    job = taken(plant, holder=other)
    held = HeldJobs(plant, leasing)
    assert held.holder == leasing.holder != other
    ending(held, job)
    assert state(plant, job) == (jobs.RUNNING, 1, None)


def test_a_job_that_is_gone_is_nobodys(plant: Database) -> None:
    job = taken(plant)
    with plant.transaction() as session:
        session.delete(session.get_one(JobRow, job))
    with plant.transaction() as session:
        assert HeldJobs(plant, WholeShare()).own(session, job) is None


def test_damage_is_reported_for_the_machine(plant: Database) -> None:
    HeldJobs(plant, WholeShare()).fail_unread(taken(plant), "a page", damaged=True)
    assert KEY.machine in (plant.damage.trouble or "")


def test_the_last_attempt_is_the_last(plant: Database) -> None:
    held = HeldJobs(plant, WholeShare())
    job = taken(plant)
    for _ in range(jobs.LARGEST_ATTEMPTS - 1):
        held.requeue(job, "out of time")
        with plant.transaction() as session:
            assert [row.id for row in jobs.claim_next(session, 1)] == [job]
    held.requeue(job, "out of time")
    assert state(plant, job)[0] == jobs.QUARANTINED


def test_what_an_earlier_process_left_is_taken_again(plant: Database) -> None:
    job = taken(plant)
    HeldJobs(plant, WholeShare()).requeue_unfinished()
    assert state(plant, job) == (jobs.QUEUED, 0, None)


def test_jobs_of_living_replicas_are_left_to_them(plant: Database, leasing: LeaseKeeper) -> None:
    own, dead = leasing.holder, 10_000
    job, lost = taken(plant, run=1, holder=own), taken(plant, run=2, holder=own)
    with plant.transaction() as session:
        jobs.get(session, lost).holder = dead
    HeldJobs(plant, leasing).requeue_unfinished()
    assert [state(plant, one)[0] for one in (job, lost)] == [jobs.RUNNING, jobs.QUEUED]


def test_jobs_taken_but_not_begun_are_put_back(plant: Database) -> None:
    begun, lost = taken(plant, run=1), taken(plant, run=2)
    HeldJobs(plant, WholeShare()).requeue_lost([begun])
    assert [state(plant, one)[:2] for one in (begun, lost)] == [(jobs.RUNNING, 1), (jobs.QUEUED, 0)]
