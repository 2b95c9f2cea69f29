"""Identification jobs in real worker processes over a real database: done once, tried again, given up, gathered."""

import os
import re
import signal
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import closing, contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
from sqlalchemy.exc import IntegrityError, OperationalError

from estimator.machine.document import Machine
from estimator.machine.rules import Condition, Operation
from service.configuration.settings import Settings
from service.identification import computation, job_options
from service.identification.result_filing import ResultFiling
from service.identification.scheduler import JobScheduler
from service.identification.task import IdentificationOutcome, IdentificationTask
from service.identification.task_builder import task
from service.workers import executors
from storage.database.engine import Database
from storage.findings import derived, identifications, jobs
from storage.machines import limits, machines
from storage.measurements import quarantine, runs
from tests.api_in_process import Api
from tests.damage import damage
from tests.identification import chapter_3, close_run, counts
from tests.plant import sqlite_url, wait_until


@pytest.fixture
def train() -> Machine:
    """The train of the thesis's Chapter 3."""
    return chapter_3()


@contextmanager
def identifying(database: Database, **changes: object) -> Iterator[JobScheduler]:
    """The identification thread at work."""
    work = JobScheduler(database, Settings(workers=1).model_copy(update=changes))
    work.start()
    try:
        yield work
    finally:
        work.stop()


def test_closed_run_is_identified_once_and_stored_with_uncertainties(database: Database, train: Machine) -> None:
    with database.transaction() as session:
        machines.create(session, train)
    close_run(database, train, seed=1, start_s=1_700_000_000)
    with identifying(database):
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


def test_a_result_is_kept_where_what_it_is_judged_by_is_damaged(tmp_path: Path, train: Machine) -> None:
    path = tmp_path / "rundown.db"
    with closing(Database(sqlite_url(path))) as one:
        with one.transaction() as session:
            machines.create(session, train)
            limits.add(session, train.id, document={"filler": "limits of the train " * 2_000}, by="nobody", comment="")
        close_run(one, train, seed=1, start_s=1_700_000_000)
    damage(path, b"limits of the train")
    with closing(Database(sqlite_url(path))) as one:
        with identifying(one):
            wait_until(lambda: counts(one) == {"done": 1})
        assert train.id in (one.damage.trouble or "")
        with one.reading() as session:
            assert len(identifications.of_machine(session, train.id)) == 1


def test_conditions_and_derived_quantities_of_a_run_are_kept(database: Database, train: Machine) -> None:
    conditions = Condition(name="oil", unit="degC"), Condition(name="load", unit="%")
    train = train.model_copy(update={"conditions": conditions, "operation": Operation(running_rpm=3000)})
    with database.transaction() as session:
        machines.create(session, train)
    run_id = close_run(database, train, seed=1, start_s=1_700_000_000)
    with database.transaction() as session:
        held = runs.samples(session, run_id)
        assert held is not None
        oil = np.column_stack([np.linspace(60.0, 50.0, len(held)), np.full(len(held), np.nan)])
        told = replace(held, conditions=oil, second=0.25 * held.phasor)
        runs.close(runs.get(session, run_id), samples=told, state=runs.CLOSED, reason="the speed left the speed range")
    with identifying(database):
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
    database: Database, train: Machine
) -> None:
    with database.transaction() as session:
        machines.create(session, train)
        limits.add(session, train.id, document={"misalignment": "damaged"}, by="nobody", comment="")
    for number in (1, 2):
        close_run(database, train, seed=1, start_s=1_700_000_000 + 3600 * number)
    with identifying(database):
        wait_until(lambda: counts(database) == {"done": 2})
    with database.reading() as session:
        assert [row.accepted for row in identifications.of_machine(session, train.id)] == [True, True]


def made_anew(database: Database, run_id: int) -> int:
    """As late samples do it, here with fewer samples; returns how many."""
    with database.transaction() as session:
        held, row = runs.samples(session, run_id), runs.get(session, run_id)
        assert held is not None
        fewer = held.pick(np.arange(len(held)) % 10 != 0)
        runs.close(row, samples=fewer, state=runs.CLOSED, reason="the speed left the speed range")
        row.times_reopened = (row.times_reopened or 0) + 1
        return len(fewer)


def test_of_a_run_that_was_made_anew_meanwhile_the_new_samples_are_identified(
    database: Database, train: Machine, monkeypatch: pytest.MonkeyPatch
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
    with identifying(database):
        wait_until(lambda: counts(database) == {"done": 1})
    with database.reading() as session:
        (row,) = identifications.of_machine(session, train.id)
        assert row.samples == counted[0]
        flags = runs.flags(session, run_id)
        assert flags is not None
        assert len(flags) == counted[0]
        assert jobs.of_machine(session, train.id, limit=1)[0].attempts == 1


def test_interrupted_job_is_computed_after_the_next_start(database: Database, train: Machine) -> None:
    with database.transaction() as session:
        machines.create(session, train)
    close_run(database, train, seed=1, start_s=1_700_000_000)
    with database.transaction() as session:
        assert len(jobs.take(session, 5)) == 1  # as by a process that was killed then
    with identifying(database):
        wait_until(lambda: counts(database) == {"done": 1})


def test_killed_worker_costs_an_attempt_and_no_job(database: Database, train: Machine) -> None:
    with database.transaction() as session:
        machines.create(session, train)
    with identifying(database):
        for seed in range(4):
            close_run(database, train, seed=seed, start_s=1_700_000_000 + 86_400 * seed)
        wait_until(lambda: counts(database).get("done", 0) >= 1)
        for child in psutil.Process().children(recursive=True):
            if "spawn_main" in " ".join(child.cmdline()):
                os.kill(child.pid, signal.SIGKILL)
        wait_until(lambda: counts(database) == {"done": 4})
    with database.reading() as session:
        assert len(identifications.of_machine(session, train.id)) == 4


def test_stopped_workers_are_replaced_their_jobs_tried_again_and_that_is_told(
    database: Database, train: Machine, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.workers.process_pool.GRACE_S", 1.0)
    monkeypatch.setattr("service.workers.process_pool.HAND_OVER_S", 2.0)
    with database.transaction() as session:
        machines.create(session, train)
    with identifying(database, workers=2, identification_timeout_s=2.0) as work:
        close_run(database, train, seed=1, start_s=1_700_000_000)
        close_run(database, train, seed=2, start_s=1_700_086_400)
        wait_until(lambda: counts(database) == {"done": 2})
        assert (work.warnings, work.gauges) == ([], {"rundown_stuck_identifications": 0})
        for child in psutil.Process().children(recursive=True):
            if "spawn_main" in " ".join(child.cmdline()):
                os.kill(child.pid, signal.SIGSTOP)
        for number in range(2, 4):
            close_run(database, train, seed=number, start_s=1_700_000_000 + 86_400 * number)
        wait_until(lambda: counts(database) == {"done": 4})
        assert work.trouble is None
        assert work.gauges == {"rundown_stuck_identifications": 2}
        (told,) = work.warnings
        assert "given up in the last hour: 2" in told
        assert "did not answer for" in told
    with database.reading() as session:
        assert [row.attempts for row in jobs.of_machine(session, train.id, limit=10)] == [2, 2, 1, 1]


def test_a_job_that_hangs_its_process_every_time_is_put_aside(
    database: Database, train: Machine, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.workers.process_pool.GRACE_S", 0.2)
    with database.transaction() as session:
        machines.create(session, train)
    close_run(database, train, seed=1, start_s=1_700_000_000)
    with computing(monkeypatch, stopped), identifying(database, identification_timeout_s=0.2):
        wait_until(lambda: counts(database) == {"quarantined": 1})
    with database.reading() as session:
        (job,) = jobs.of_machine(session, train.id, limit=10)
        assert "given up after 3 attempts: Stuck: its process did not answer for" in (job.error or "")


def stopped(_: IdentificationTask) -> IdentificationOutcome:
    """Never comes to its end."""
    os.kill(os.getpid(), signal.SIGSTOP)
    raise AssertionError("nobody lets it go on")


def test_job_without_enough_data_fails_with_its_reason(database: Database, train: Machine) -> None:
    with database.transaction() as session:
        machines.create(session, train)
    run_id = close_run(database, train, seed=1, start_s=1_700_000_000)
    with database.transaction() as session:
        held = runs.samples(session, run_id)
        assert held is not None
        runs.close(runs.get(session, run_id), samples=held.pick(slice(0, 2)), state=runs.CLOSED, reason="cut short")
    with identifying(database):
        wait_until(lambda: counts(database) == {"failed": 1})
    with database.reading() as session:
        (job,) = jobs.of_machine(session, train.id, limit=10)
        assert "cannot determine 50 unknowns" in (job.error or "")


def test_damaged_run_fails_without_stopping_the_others(database: Database, train: Machine) -> None:
    with database.transaction() as session:
        machines.create(session, train)
    first = close_run(database, train, seed=1, start_s=1_700_000_000)
    close_run(database, train, seed=2, start_s=1_700_086_400)
    with database.transaction() as session:
        runs.get(session, first).data = b"RDSB nonsense"
    with identifying(database):
        wait_until(lambda: counts(database) == {"done": 1, "failed": 1})


def test_what_is_asked_for_in_one_plant_delays_no_alert_of_another(database: Database, train: Machine) -> None:
    other = train.model_copy(update={"id": "train-b", "plant": "plant-b"})
    with database.transaction() as session:
        machines.create(session, train)
        machines.create(session, other)
    run_id = close_run(database, train, seed=1, start_s=1_700_000_000, ask=False)
    with database.transaction() as session:
        for seed in range(1, 100):
            job_options.request_identification(session, run_id, job_options.Request(seed=seed), job_options.Requester("anna"))
    with identifying(database, workers=2):
        wait_until(lambda: counts(database).get("done", 0) >= 2)
        before = counts(database)["done"]
        close_run(database, other, seed=2, start_s=1_700_000_000)

        def of_other() -> list[str]:
            with database.reading() as session:
                return [row.state for row in jobs.of_machine(session, other.id, limit=9)]

        wait_until(lambda: of_other() == ["done"])
        assert counts(database)["done"] - before <= 5
    with database.reading() as session:
        assert all(row.asked_by == "anna" for row in jobs.of_machine(session, train.id, limit=200))


def costly(tries: Path, until: int, error: str, task: IdentificationTask) -> IdentificationOutcome:
    """Computes in its process from a try on; before that it uses it up. tries: file with a line for each try."""
    with tries.open("a") as counted:
        counted.write("tried\n")
    if len(tries.read_text().splitlines()) < until:
        if error == "MemoryError":
            np.ones(2**33, np.uint8)  # more than the process may hold
        if error == "OutOfTime":
            task = replace(task, timeout_s=0.005)
        if error == "ValueError":
            raise ValueError("the data are wrong")
    return computation.compute(task)


@contextmanager
def computing(monkeypatch: pytest.MonkeyPatch, work: Callable[[IdentificationTask], IdentificationOutcome]) -> Iterator[None]:
    """Let the processes do something else than identify."""

    def submit(
        self: executors.LocalExecutor, limit_s: float, _work: object, task: IdentificationTask
    ) -> Future[IdentificationOutcome]:
        return self._processes.submit(limit_s, work, task)

    with monkeypatch.context() as changed:
        changed.setattr(executors.LocalExecutor, "submit", submit)
        yield


@pytest.mark.parametrize(
    ("error", "until", "state", "attempts", "said"),
    [
        (
            "OutOfTime",
            99,
            "quarantined",
            3,
            "given up after 3 attempts: OutOfTime: the identification took longer than allowed",
        ),
        ("MemoryError", 99, "quarantined", 3, "given up after 3 attempts: .*MemoryError: Unable to allocate 8.00 GiB"),
        ("OutOfTime", 3, "done", 3, ""),
        ("MemoryError", 3, "done", 3, ""),
        ("ValueError", 99, "failed", 1, "^ValueError: the data are wrong"),
    ],
)
def test_a_job_that_takes_more_than_it_may_has_three_tries(
    database: Database,
    train: Machine,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    error: str,
    until: int,
    state: str,
    attempts: int,
    said: str,
) -> None:
    with database.transaction() as session:
        machines.create(session, train)
    close_run(database, train, seed=1, start_s=1_700_000_000)
    with computing(monkeypatch, partial(costly, tmp_path / "tries", until, error)), identifying(database):
        wait_until(lambda: counts(database) == {state: 1})
    with database.reading() as session:
        (job,) = jobs.of_machine(session, train.id, limit=10)
        assert job.attempts == attempts
        assert re.search(said, job.error or "")


def spoiled(tries: Path, task: IdentificationTask) -> IdentificationOutcome:
    """Of the first try a result that cannot be stored, of the second an error that cannot be. tries: as of `costly`."""
    with tries.open("a") as counted:
        counted.write("tried\n")
    count = len(tries.read_text().splitlines())
    if count == 1:
        return IdentificationOutcome((), None, "without the quality of its run")
    if count == 2:
        raise ValueError("half a character: \ud800")
    return computation.compute(task)


def test_a_result_that_cannot_be_stored_fails_with_its_reason_and_holds_up_no_other(
    database: Database,
    train: Machine,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
    tmp_path: Path,
) -> None:
    # What it logs, half a character, cannot be told to another process of tests.
    caplog.set_level("CRITICAL", logger="service")
    with database.transaction() as session:
        machines.create(session, train)
    for number in range(3):
        close_run(database, train, seed=1, start_s=1_700_000_000 + 86_400 * number)
    with computing(monkeypatch, partial(spoiled, tmp_path / "tries")), identifying(database) as work:
        wait_until(lambda: counts(database) == {"failed": 2, "done": 1})
        wait_until(lambda: work.trouble is None)
    with database.reading() as session:
        errors = {one.error for one in jobs.of_machine(session, train.id, limit=10)}
    assert errors == {
        "its result cannot be stored: IndexError: tuple index out of range",
        "ValueError: half a character: \\ud800",
        None,
    }


def test_what_cannot_be_filed_now_is_filed_behind_the_others(
    database: Database, train: Machine, monkeypatch: pytest.MonkeyPatch
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
    with identifying(database):
        wait_until(lambda: counts(database) == {"done": 2})
    assert tried[-2:] == [2, 1]


def test_a_job_out_of_time_every_time_does_not_stop_the_next(database: Database, train: Machine) -> None:
    with database.transaction() as session:
        machines.create(session, train)
    close_run(database, train, seed=1, start_s=1_700_000_000)
    with identifying(database, identification_timeout_s=0.005):
        wait_until(lambda: counts(database) == {"quarantined": 1})
    close_run(database, train, seed=2, start_s=1_700_086_400)
    with identifying(database):
        wait_until(lambda: counts(database) == {"quarantined": 1, "done": 1})


def test_newest_runs_are_identified_together_on_schedule(database: Database, train: Machine) -> None:
    with database.transaction() as session:
        machines.create(session, train)
    wanted = [close_run(database, train, seed=1, start_s=1_700_000_000 + 86_400 * i, ask=False) for i in range(3)]
    with identifying(database, gathered_interval_s=0.2, gathered_runs=2):
        wait_until(lambda: counts(database) == {"done": 1})
        time.sleep(1.0)  # the same runs are not identified together again
        assert counts(database) == {"done": 1}
    with database.reading() as session:
        (row,) = identifications.of_machine(session, train.id)
        assert (row.scope, row.run_kind, row.run_ids) == ("gathered", "gathered", wanted[1:])
        assert row.accepted
        assert row.samples == 200
    fewer = made_anew(database, wanted[2])
    with identifying(database, gathered_interval_s=0.2, gathered_runs=2):
        wait_until(lambda: counts(database) == {"done": 2})
    with database.reading() as session:
        again, _ = identifications.of_machine(session, train.id)
        assert (again.run_ids, again.samples) == (wanted[1:], 100 + fewer)


@pytest.mark.parametrize("place", [0, 1, 2])
def test_jobs_that_were_taken_when_the_database_went_away_are_taken_again(
    database: Database, train: Machine, monkeypatch: pytest.MonkeyPatch, place: int
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
    with identifying(database, workers=2):
        wait_until(lambda: counts(database) == {"done": 3}, seconds=60.0)


CONFUSED = ZeroDivisionError("a fault of ours")
REFUSED = IntegrityError("INSERT", {}, Exception("an alert that the database does not take"))


@pytest.mark.parametrize("step", ["assessment_context.load_context", "conclusions.apply"])
@pytest.mark.parametrize("error", [CONFUSED, REFUSED], ids=["unforeseen", "refused by the database"])
def test_a_result_that_cannot_be_judged_is_kept_and_that_no_alert_follows_is_told(
    database: Database, train: Machine, monkeypatch: pytest.MonkeyPatch, error: Exception, step: str
) -> None:
    def confused(*_: Any, **__: Any) -> None:
        raise error

    monkeypatch.setattr(f"service.monitoring.{step}", confused)
    with database.transaction() as session:
        machines.create(session, train)
    close_run(database, train, seed=1, start_s=1_700_000_000)
    with identifying(database):
        wait_until(lambda: counts(database) == {"done": 1})
    with database.reading() as session:
        (stored,) = identifications.of_machine(session, train.id)
        (told,) = quarantine.newest(session, reason="unexpected_error", machine_id=train.id, limit=9)
    assert told.key == f"identification {stored.id}"
    assert type(error).__name__ in told.detail
    assert Api(database).value("/quarantine", reason="unexpected_error")["entries"][0]["key"] == told.key
