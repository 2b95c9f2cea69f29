"""Identification jobs whose worker processes are killed, stopped, hang or use up what they may: tried again, or put aside."""

import os
import re
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import psutil
import pytest

from estimator.machine.document import Machine
from service.identification import computation
from service.identification.task import IdentificationOutcome, IdentificationTask
from service.workers import executors
from service.workers.executors import LocalExecutor
from storage.database.engine import Database
from storage.findings import identifications, jobs
from storage.machines import machines
from tests.identification import chapter_3, close_run, counts, identifying
from tests.plant import wait_until

MOST_ALARMS = 10
"""Most alarms that are set: one that falls where Python drops exceptions, as in a finaliser, is lost."""


@pytest.fixture
def train() -> Machine:
    """The train of the thesis's Chapter 3."""
    return chapter_3()


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


def test_stopped_workers_are_replaced_their_jobs_tried_again_and_that_is_reported(
    database: Database, train: Machine, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.workers.process_pool.GRACE_S", 1.0)
    monkeypatch.setattr("service.workers.process_pool.HAND_OVER_S", 2.0)
    with database.transaction() as session:
        machines.create(session, train)
    with identifying(database, workers=2) as work:
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


def test_where_no_worker_can_be_started_jobs_wait_unhurt_and_that_is_reported(
    database: Database, train: Machine, monkeypatch: pytest.MonkeyPatch
) -> None:
    def no_memory(_: object) -> None:
        raise OSError(12, "Cannot allocate memory")

    monkeypatch.setattr("service.workers.process_pool._Slot._begin", no_memory)
    monkeypatch.setattr("service.workers.process_pool.RETRY_S", 0.05)
    with database.transaction() as session:
        machines.create(session, train)
    with identifying(database) as work:
        close_run(database, train, seed=1, start_s=1_700_000_000)
        wait_until(lambda: work.trouble == "no worker process can be started: [Errno 12] Cannot allocate memory")
    assert counts(database).keys() <= {"queued", "running"}
    with database.reading() as session:
        assert [row.attempts for row in jobs.of_machine(session, train.id, limit=10)] in ([0], [1])


@pytest.mark.long
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


def costly(tries: Path, until: int, error: str, task: IdentificationTask) -> IdentificationOutcome:
    """Compute from one try on; exceed a limit of the process before. tries: file with a line for each try."""
    with tries.open("a") as counted:
        counted.write("tried\n")
    if len(tries.read_text().splitlines()) < until:
        if error == "MemoryError":
            np.ones(2**33, np.uint8)  # more than the process may hold
        if error == "OutOfTime":
            for _ in range(MOST_ALARMS):
                computation.compute(replace(task, timeout_s=0.005))
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
    executor: LocalExecutor,
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
    with computing(monkeypatch, partial(costly, tmp_path / "tries", until, error)), identifying(database, executor):
        wait_until(lambda: counts(database) == {state: 1})
    with database.reading() as session:
        (job,) = jobs.of_machine(session, train.id, limit=10)
        assert job.attempts == attempts
        assert re.search(said, job.error or "")


def spoiled(tries: Path, task: IdentificationTask) -> IdentificationOutcome:
    """Return a result that cannot be stored at the first try, raise such an error at the second. tries: as in `costly`."""
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
    executor: LocalExecutor,
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
    with computing(monkeypatch, partial(spoiled, tmp_path / "tries")), identifying(database, executor) as work:
        wait_until(lambda: counts(database) == {"failed": 2, "done": 1})
        wait_until(lambda: work.trouble is None)
    with database.reading() as session:
        errors = {one.error for one in jobs.of_machine(session, train.id, limit=10)}
    assert errors == {
        "its result cannot be stored: IndexError: tuple index out of range",
        "ValueError: half a character: \\ud800",
        None,
    }


@pytest.mark.long
def test_a_job_out_of_time_every_time_does_not_stop_the_next(
    database: Database, train: Machine, executor: LocalExecutor
) -> None:
    with database.transaction() as session:
        machines.create(session, train)
    with identifying(database, executor, identification_timeout_s=0.005):
        for number in range(MOST_ALARMS):  # a job whose alarm was lost is done all the same
            close_run(database, train, seed=number, start_s=1_700_000_000 + 86_400 * number)
            wait_until(lambda: counts(database).keys() <= {"quarantined", "done"})
            if "quarantined" in counts(database):
                break
    before = counts(database)
    assert before["quarantined"] == 1
    close_run(database, train, seed=MOST_ALARMS, start_s=1_700_000_000 + 86_400 * MOST_ALARMS)
    with identifying(database, executor):
        wait_until(lambda: counts(database) == {"quarantined": 1, "done": before.get("done", 0) + 1})
