"""Identification jobs over a real database: asked for once, taken once, given up in the end."""

import pytest
from sqlalchemy.orm import Session

from storage.database.engine import Database
from storage.findings import jobs


def ask(session: Session, *run_ids: int, scope: str = jobs.RUN) -> int | None:
    row = jobs.enqueue(session, "pump-7", scope=scope, run_ids=list(run_ids))
    return None if row is None else row.id


def states(session: Session) -> list[str]:
    return [row.state for row in reversed(jobs.of_machine(session, "pump-7", limit=100))]


def test_the_same_identification_is_asked_for_once(plant: Database) -> None:
    with plant.transaction() as session:
        assert ask(session, 1, 2, scope=jobs.GATHERED) is not None
        assert ask(session, 2, 1, scope=jobs.GATHERED) is None
        assert ask(session, 1, scope=jobs.GATHERED) is not None
        assert ask(session, 1, scope=jobs.RUN) is not None
        jobs.finish(jobs.claim_next(session, 1)[0], state=jobs.DONE)
    with plant.transaction() as session:
        assert ask(session, 1, 2, scope=jobs.GATHERED) is None


def test_jobs_are_taken_oldest_first_and_only_once(plant: Database) -> None:
    with plant.transaction() as session:
        asked = [ask(session, run_id) for run_id in (5, 3, 4)]
        assert jobs.any_waiting(session)
    with plant.transaction() as session:
        assert [row.id for row in jobs.claim_next(session, 2)] == asked[:2]
    with plant.transaction() as session:
        assert [row.id for row in jobs.claim_next(session, 2)] == asked[2:]
        assert jobs.claim_next(session, 2) == []
        assert not jobs.any_waiting(session)
        assert states(session) == [jobs.RUNNING] * 3


def test_a_finished_job_says_how_and_when(plant: Database) -> None:
    with plant.transaction() as session:
        ask(session, 1)
        ask(session, 2)
        done, failed = jobs.claim_next(session, 2)
        jobs.finish(done, state=jobs.DONE)
        jobs.finish(failed, state=jobs.FAILED, error="NotEnoughData: too few")
    with plant.reading() as session:
        assert jobs.get(session, done.id).error is None
        assert jobs.get(session, failed.id).error == "NotEnoughData: too few"
        assert (jobs.get(session, done.id).finished_at or 0) >= done.created_at
        assert jobs.count(session) == {jobs.DONE: 1, jobs.FAILED: 1}


def test_a_job_that_costs_every_worker_is_given_up(plant: Database) -> None:
    with plant.transaction() as session:
        ask(session, 1)
        for attempt in range(1, jobs.LARGEST_ATTEMPTS + 1):
            (row,) = jobs.claim_next(session, 1)
            assert row.attempts == attempt
            jobs.requeue(session, row, "the worker died")
        assert jobs.claim_next(session, 1) == []
        assert row.state == jobs.QUARANTINED
        assert row.error == "given up after 3 attempts: the worker died"


def test_a_job_that_did_harm_waits_behind_all_others(plant: Database) -> None:
    with plant.transaction() as session:
        first, second, third = (ask(session, run_id) for run_id in (1, 2, 3))
        (harmful,) = jobs.claim_next(session, 1)
        jobs.requeue(session, harmful, "it took too long")
    with plant.transaction() as session:
        assert [row.id for row in jobs.claim_next(session, 1)] == [second]
        assert [row.id for row in jobs.claim_next(session, 2)] == [third, first]


def test_what_an_earlier_process_left_running_is_queued_again(plant: Database) -> None:
    with plant.transaction() as session:
        for run_id in range(4):
            ask(session, run_id)
        jobs.finish(jobs.claim_next(session, 1)[0], state=jobs.DONE)
        jobs.claim_next(session, 2)
    with plant.transaction() as session:
        assert jobs.requeue_running(session) == 2
        assert states(session) == [jobs.DONE, jobs.QUEUED, jobs.QUEUED, jobs.QUEUED]
        # A stop of the service is no attempt.
        assert [row.attempts for row in jobs.claim_next(session, 3)] == [1, 1, 1]


def test_jobs_of_a_machine_newest_first(plant: Database) -> None:
    with plant.transaction() as session:
        asked = [ask(session, run_id) for run_id in range(3)]
        assert [row.id for row in jobs.of_machine(session, "pump-7", limit=2)] == asked[:0:-1]
        with pytest.raises(jobs.JobUnknown):
            jobs.get(session, 99)
