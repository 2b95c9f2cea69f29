"""Identification jobs in real worker processes over a real database: done once, with their results filed and judged."""

import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msgspec import structs
from sqlalchemy.exc import IntegrityError, OperationalError

from estimator.machine.document import Machine
from estimator.machine.rules import Condition, Operation
from service.configuration.settings import Settings
from service.identification import job_options
from service.identification.result_filing import ResultFiling
from service.identification.scheduler import JobScheduler
from service.identification.task import IdentificationOutcome, IdentificationTask
from service.identification.task_builder import task
from service.replication.lease_keeper import LeaseKeeper, _release_dead
from service.workers.executors import LocalExecutor
from storage.database.engine import Database
from storage.findings import derived, identifications, jobs
from storage.machines import limits, machines
from storage.measurements import quarantine, runs
from tests.api_in_process import Api
from tests.damage import damage
from tests.identification import chapter_3, close_run, counts, identifying, working
from tests.plant import sqlite_url, wait_until


@pytest.fixture(scope="module")
def executor() -> Iterator[LocalExecutor]:
    """Two worker processes for all these tests: to start one and import all that it needs takes longer than most of them."""
    with working(2) as both:
        yield both


@pytest.fixture
def train() -> Machine:
    """The train of the thesis's Chapter 3."""
    return chapter_3()


def test_closed_run_is_identified_once_and_stored_with_uncertainties(
    database: Database, train: Machine, executor: LocalExecutor
) -> None:
    with database.transaction() as session:
        machines.create(session, train)
    close_run(database, train, seed=1, start_s=1_700_000_000)
    with identifying(database, executor):
        wait_until(lambda: counts(database) == {"done": 1})
    with database.reading() as session:
        (row,) = identifications.of_machine(session, train.id)
        assert row.accepted
        assert row.code_version
        stored = identifications.estimates(session, row.id)
        assert [one.parameter for one in stored][:2] == ["bearing.B1.kxx", "bearing.B1.kxy"]
        assert all((one.value is None) == (one.standard_error is None) for one in stored)
        assert identifications.covariance(identifications.get(session, row.id)).shape == (50, 50)
        quantities = {one.name: one for one in derived.of_identification(session, row.id)}
        force = quantities["coupling.C1.misalignment_force"]
        assert (force.unit, force.measured_at, force.reason) == ("N", row.measured_at, None)
        assert 0.0 < (force.lower or 0.0) < (force.value or 0.0) < (force.upper or 0.0)


def test_a_result_is_kept_where_what_it_is_judged_by_is_damaged(
    tmp_path: Path, train: Machine, executor: LocalExecutor
) -> None:
    path = tmp_path / "rundown.db"
    with closing(Database(sqlite_url(path))) as one:
        with one.transaction() as session:
            machines.create(session, train)
            limits.add(session, train.id, document={"filler": "limits of the train " * 2_000}, by="nobody", comment="")
        close_run(one, train, seed=1, start_s=1_700_000_000)
    damage(path, b"limits of the train")
    with closing(Database(sqlite_url(path))) as one:
        with identifying(one, executor):
            wait_until(lambda: counts(one) == {"done": 1})
        assert train.id in (one.damage.trouble or "")
        with one.reading() as session:
            assert len(identifications.of_machine(session, train.id)) == 1


def test_the_balance_of_loads_is_that_of_the_worker_that_computed(
    database: Database, train: Machine, executor: LocalExecutor, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A worker of another release knows another version than the service that files its result."""
    store = ResultFiling._store

    def by_another(self: ResultFiling, taken: Any, outcome: IdentificationOutcome) -> None:
        store(self, taken, replace(outcome, load_balance=7))

    monkeypatch.setattr(ResultFiling, "_store", by_another)
    with database.transaction() as session:
        machines.create(session, train)
    close_run(database, train, seed=1, start_s=1_700_000_000)
    with identifying(database, executor):
        wait_until(lambda: counts(database) == {"done": 1})
    with database.reading() as session:
        assert [row.load_balance for row in identifications.of_machine(session, train.id)] == [7]


def test_conditions_and_derived_quantities_of_a_run_are_kept(
    database: Database, train: Machine, executor: LocalExecutor
) -> None:
    conditions = Condition(name="oil", unit="degC"), Condition(name="load", unit="%")
    train = train.model_copy(update={"conditions": conditions, "operation": Operation(running_rpm=3000)})
    with database.transaction() as session:
        machines.create(session, train)
    run_id = close_run(database, train, seed=1, start_s=1_700_000_000)
    with database.transaction() as session:
        held = runs.samples(session, run_id)
        assert held is not None
        oil = np.column_stack([np.linspace(60.0, 50.0, len(held)), np.full(len(held), np.nan)])
        told = structs.replace(held, conditions=oil, second=0.25 * held.phasor)
        runs.close(runs.get(session, run_id), samples=told, state=runs.CLOSED, reason="the speed left the speed range")
    with identifying(database, executor):
        wait_until(lambda: counts(database) == {"done": 1})
    with database.reading() as session:
        (row,) = identifications.of_machine(session, train.id)
        assert row.conditions == {"oil": pytest.approx(55.0), "load": None}
        found = {one.name: one for one in derived.of_identification(session, row.id)}
        speed, ratio = found["critical_speed.1"], found["probe.B1X.second_over_first"]
        assert (speed.unit, ratio.unit) == ("rad/s", "1")
        assert ratio.value == pytest.approx(0.25)
        assert speed.value == pytest.approx(121.8, rel=0.1)  # nominal
        assert (speed.lower or 0.0) < (speed.value or 0.0) < (speed.upper or 0.0)
        for one in found.values():
            assert (one.value is None) == (one.reason is not None)


def test_a_result_is_kept_and_the_next_one_computed_when_nothing_can_be_concluded_from_it(
    database: Database, train: Machine, executor: LocalExecutor
) -> None:
    with database.transaction() as session:
        machines.create(session, train)
        limits.add(session, train.id, document={"misalignment": "damaged"}, by="nobody", comment="")
    for number in (1, 2):
        close_run(database, train, seed=1, start_s=1_700_000_000 + 3600 * number)
    with identifying(database, executor):
        wait_until(lambda: counts(database) == {"done": 2})
    with database.reading() as session:
        assert [row.accepted for row in identifications.of_machine(session, train.id)] == [True, True]


def made_anew(database: Database, run_id: int) -> int:
    """Rebuild a run as late samples do, here with fewer samples; return how many."""
    with database.transaction() as session:
        held, row = runs.samples(session, run_id), runs.get(session, run_id)
        assert held is not None
        fewer = held.pick(np.arange(len(held)) % 10 != 0)
        runs.close(row, samples=fewer, state=runs.CLOSED, reason="the speed left the speed range")
        row.times_reopened = (row.times_reopened or 0) + 1
        return len(fewer)


def test_of_a_run_that_was_rebuilt_meanwhile_the_new_samples_are_identified(
    database: Database, train: Machine, executor: LocalExecutor, monkeypatch: pytest.MonkeyPatch
) -> None:
    with database.transaction() as session:
        machines.create(session, train)
    run_id = close_run(database, train, seed=1, start_s=1_700_000_000)
    counted: list[int] = []
    store = ResultFiling._store

    def late(self: ResultFiling, *arguments: Any) -> None:
        if not counted:
            counted.append(made_anew(database, run_id))
        store(self, *arguments)

    monkeypatch.setattr(ResultFiling, "_store", late)
    with identifying(database, executor):
        wait_until(lambda: counts(database) == {"done": 1})
    with database.reading() as session:
        (row,) = identifications.of_machine(session, train.id)
        assert row.samples == counted[0]
        flags = runs.flags(session, run_id)
        assert flags is not None
        assert len(flags) == counted[0]
        assert jobs.of_machine(session, train.id, limit=1)[0].attempts == 1


def test_interrupted_job_is_computed_after_the_next_start(database: Database, train: Machine, executor: LocalExecutor) -> None:
    with database.transaction() as session:
        machines.create(session, train)
    close_run(database, train, seed=1, start_s=1_700_000_000)
    with database.transaction() as session:
        assert len(jobs.claim_next(session, 5)) == 1  # as by a process that was killed then
    with identifying(database, executor):
        wait_until(lambda: counts(database) == {"done": 1})


def test_job_without_enough_data_fails_with_its_reason(database: Database, train: Machine, executor: LocalExecutor) -> None:
    with database.transaction() as session:
        machines.create(session, train)
    run_id = close_run(database, train, seed=1, start_s=1_700_000_000)
    with database.transaction() as session:
        held = runs.samples(session, run_id)
        assert held is not None
        runs.close(runs.get(session, run_id), samples=held.pick(slice(0, 2)), state=runs.CLOSED, reason="cut short")
    with identifying(database, executor):
        wait_until(lambda: counts(database) == {"failed": 1})
    with database.reading() as session:
        (job,) = jobs.of_machine(session, train.id, limit=10)
        assert "cannot determine 50 unknowns" in (job.error or "")


def test_damaged_run_fails_without_stopping_the_others(database: Database, train: Machine, executor: LocalExecutor) -> None:
    with database.transaction() as session:
        machines.create(session, train)
    first = close_run(database, train, seed=1, start_s=1_700_000_000)
    close_run(database, train, seed=2, start_s=1_700_086_400)
    with database.transaction() as session:
        runs.get(session, first).data = b"RDSB nonsense"
    with identifying(database, executor):
        wait_until(lambda: counts(database) == {"done": 1, "failed": 1})


def stored_of(database: Database, train: Machine) -> list[int]:
    """The identifications of a train, by their ids: in the order in which they were stored."""
    with database.reading() as session:
        return sorted(row.id for row in identifications.of_machine(session, train.id, limit=200))


def test_what_is_asked_for_in_one_plant_delays_no_alert_of_another(
    database: Database, train: Machine, executor: LocalExecutor
) -> None:
    other = train.model_copy(update={"id": "train-b", "plant": "plant-b"})
    with database.transaction() as session:
        machines.create(session, train)
        machines.create(session, other)
    run_id = close_run(database, train, seed=1, start_s=1_700_000_000, ask=False)
    run_of_other = close_run(database, other, seed=2, start_s=1_700_000_000, ask=False)
    with database.transaction() as session:
        for seed in range(1, 100):
            job_options.request_identification(session, run_id, job_options.Request(seed=seed), job_options.Requester("anna"))
    with identifying(database, executor):
        wait_until(lambda: counts(database).get("done", 0) >= 2)
        with database.transaction() as session:
            before = len(identifications.of_machine(session, train.id, limit=200))
            jobs.enqueue(session, other.id, scope=jobs.RUN, run_ids=[run_of_other])
        wait_until(lambda: stored_of(database, other) != [])
    (first,) = stored_of(database, other)
    assert sum(one < first for one in stored_of(database, train)) - before <= 5
    with database.reading() as session:
        assert all(row.asked_by == "anna" for row in jobs.of_machine(session, train.id, limit=200))


def test_what_cannot_be_filed_now_is_filed_behind_the_others(
    database: Database, train: Machine, executor: LocalExecutor, monkeypatch: pytest.MonkeyPatch
) -> None:
    with database.transaction() as session:
        machines.create(session, train)
    for number in range(2):
        close_run(database, train, seed=1, start_s=1_700_000_000 + 86_400 * number)
    tried: list[int] = []
    store = ResultFiling._store

    def away(self: ResultFiling, taken: Any, outcome: IdentificationOutcome) -> None:
        tried.append(taken.job_id)
        if taken.job_id == 1 and 2 not in tried:
            raise OperationalError(None, None, OSError("the database is away"))
        store(self, taken, outcome)

    monkeypatch.setattr(ResultFiling, "_store", away)
    monkeypatch.setattr("service.identification.scheduler.RETRY_S", 0.05)
    with identifying(database, executor):
        wait_until(lambda: counts(database) == {"done": 2})
    assert tried[-2:] == [2, 1]


def test_newest_runs_are_identified_together_on_schedule(database: Database, train: Machine, executor: LocalExecutor) -> None:
    with database.transaction() as session:
        machines.create(session, train)
    wanted = [close_run(database, train, seed=1, start_s=1_700_000_000 + 86_400 * i, ask=False) for i in range(3)]
    with identifying(database, executor, gathered_interval_s=0.2, gathered_runs=2):
        wait_until(lambda: counts(database) == {"done": 1})
        time.sleep(1.0)  # the same runs are not identified together again
        assert counts(database) == {"done": 1}
    with database.reading() as session:
        (row,) = identifications.of_machine(session, train.id)
        assert (row.scope, row.run_kind, row.run_ids) == ("gathered", "gathered", wanted[1:])
        assert row.accepted
        assert row.samples == 200
    fewer = made_anew(database, wanted[2])
    with identifying(database, executor, gathered_interval_s=0.2, gathered_runs=2):
        wait_until(lambda: counts(database) == {"done": 2})
    with database.reading() as session:
        again, _ = identifications.of_machine(session, train.id)
        assert (again.run_ids, again.samples) == (wanted[1:], 100 + fewer)


@pytest.mark.parametrize("place", [0, 1, 2])
def test_jobs_that_were_taken_when_the_database_went_away_are_taken_again(
    database: Database, train: Machine, executor: LocalExecutor, monkeypatch: pytest.MonkeyPatch, place: int
) -> None:
    """They are marked as running in one transaction, and read in others."""
    calls = [0]

    def interrupted(*given: Any, **more: Any) -> IdentificationTask:
        calls[0] += 1
        if calls[0] == place + 1:
            raise OperationalError(None, None, OSError("the database is away"))
        return task(*given, **more)

    monkeypatch.setattr("service.identification.job_submission.task", interrupted)
    with database.transaction() as session:
        machines.create(session, train)
    for number in range(3):
        close_run(database, train, seed=number, start_s=1_700_000_000 + 10_000 * number)
    with identifying(database, executor):
        wait_until(lambda: counts(database) == {"done": 3}, seconds=60.0)


def test_a_replica_thought_dead_stores_no_job_twice(
    database: Database, train: Machine, executor: LocalExecutor, caplog: pytest.LogCaptureFixture
) -> None:
    """It takes its own job again under its new number, while the earlier computation still goes on."""
    with database.transaction() as session:
        machines.create(session, train)
    close_run(database, train, seed=1, start_s=1_700_000_000)
    replica = LeaseKeeper(database, "all")
    replica.run_once()
    work = JobScheduler(database, Settings(workers=2), replica, executor=executor)
    work.run_once()
    assert counts(database) == {"running": 1}
    with database.transaction() as session:
        frozen = replica.holder
        assert frozen is not None
        _release_dead(session, frozen)
    assert counts(database) == {"queued": 1}
    replica.run_once()
    assert replica.holder != frozen

    def settled() -> bool:
        work.run_once()
        return set(counts(database)) <= {"done", "failed"}

    wait_until(settled, seconds=60.0)
    work.stop()
    assert counts(database) == {"done": 1}
    assert "its earlier result is left out" in caplog.text
    with database.reading() as session:
        assert len(identifications.of_machine(session, train.id)) == 1


CONFUSED = ZeroDivisionError("a fault of ours")
REFUSED = IntegrityError("INSERT", {}, Exception("an alert that the database does not take"))


@pytest.mark.parametrize("step", ["context_loading.load_context", "conclusions.apply"])
@pytest.mark.parametrize("error", [CONFUSED, REFUSED], ids=["unforeseen", "refused by the database"])
def test_a_result_that_cannot_be_judged_is_kept_and_that_no_alert_follows_is_reported(
    database: Database, train: Machine, executor: LocalExecutor, monkeypatch: pytest.MonkeyPatch, error: Exception, step: str
) -> None:
    def confused(*_: Any, **__: Any) -> None:
        raise error

    monkeypatch.setattr(f"service.monitoring.{step}", confused)
    with database.transaction() as session:
        machines.create(session, train)
    close_run(database, train, seed=1, start_s=1_700_000_000)
    with identifying(database, executor):
        wait_until(lambda: counts(database) == {"done": 1})
    with database.reading() as session:
        (stored,) = identifications.of_machine(session, train.id)
        (told,) = quarantine.newest(session, reason="unexpected_error", machine_id=train.id, limit=9)
    assert told.key == f"identification {stored.id}"
    assert type(error).__name__ in told.detail
    assert Api(database).value("/quarantine", reason="unexpected_error")["entries"][0]["key"] == told.key
