"""Identification by a Dask cluster: a real scheduler and workers as processes, killed mid-job and brought back."""

import contextlib
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest

from estimator.machine.document import Machine
from service.configuration.settings import Settings
from service.identification.scheduler import JobScheduler
from storage.database.engine import Database
from storage.findings import identifications, jobs
from storage.machines import machines
from tests.distribution.killed_computation import FILE
from tests.end_to_end.processes import process, python, until
from tests.identification import chapter_3, close_run, counts
from tests.ports import free_port


class Cluster:
    """A scheduler and workers, in `folder`."""

    def __init__(self, folder: Path, stack: contextlib.ExitStack) -> None:
        self._folder, self._stack = folder, stack
        self.port = free_port()
        self.address = f"tcp://127.0.0.1:{self.port}"

    def start_scheduler(self) -> subprocess.Popen[bytes]:
        arguments = ["--host", "127.0.0.1", "--port", str(self.port), "--no-dashboard"]
        return self._stack.enter_context(
            python(self._folder / "scheduler.log", "-m", "distributed.cli.dask_scheduler", *arguments)
        )

    def start_worker(self, name: str) -> subprocess.Popen[bytes]:
        log = self._folder / f"{name}.log"
        return self._stack.enter_context(process(log, "worker", self.address, "--processes", "1"))

    def start_other_worker(self, name: str, *changes: str) -> subprocess.Popen[bytes]:
        log = self._folder / f"{name}.log"
        return self._stack.enter_context(python(log, "-m", "tests.distribution.dask_worker", self.address, *changes))

    def log(self, name: str) -> str:
        return (self._folder / f"{name}.log").read_text()


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    """The test starts its parts."""
    with contextlib.ExitStack() as stack:
        yield Cluster(tmp_path, stack)


@pytest.fixture
def train() -> Machine:
    """The train of the thesis's Chapter 3."""
    return chapter_3()


@contextlib.contextmanager
def identifying(database: Database, cluster: Cluster, *, timeout_s: float = 300.0) -> Iterator[JobScheduler]:
    """The identification thread with the cluster."""
    work = JobScheduler(database, Settings(dask_scheduler=cluster.address, identification_timeout_s=timeout_s))
    work.start()
    try:
        yield work
    finally:
        work.stop()


@pytest.mark.long
def test_jobs_are_done_by_workers_also_when_one_is_killed_and_when_the_scheduler_comes_back(
    cluster: Cluster, database: Database, train: Machine
) -> None:
    with database.transaction() as session:
        machines.create(session, train)
    for number in range(8):
        close_run(database, train, seed=number, start_s=1_700_000_000 + 3600 * number)
    with identifying(database, cluster) as work:
        until(lambda: work.trouble is not None and "does not answer" in work.trouble, within_s=20, what="no scheduler is said")
        scheduler = cluster.start_scheduler()
        until(lambda: work.trouble is not None and "no workers" in work.trouble, within_s=20, what="no workers is said")
        first = cluster.start_worker("first")
        until(lambda: counts(database).get("done", 0) >= 1, within_s=60, what="the worker computes")
        cluster.start_worker("second")
        until(lambda: counts(database).get("running", 0) >= 1, within_s=30, what="it computes on")
        first.kill()
        until(lambda: counts(database) == {"done": 8}, within_s=90, what="the other worker does the rest")

        close_run(database, train, seed=9, start_s=1_800_000_000)
        scheduler.kill()
        scheduler.wait()
        time.sleep(1.0)
        close_run(database, train, seed=10, start_s=1_800_100_000)
        cluster.start_scheduler()
        until(lambda: counts(database) == {"done": 10}, within_s=90, what="all jobs are done")
        until(lambda: work.trouble is None, within_s=10, what="no trouble is left")
    with database.reading() as session:
        rows = identifications.of_machine(session, train.id)
        assert len(rows) == 10
        assert all(row.accepted for row in rows)


@pytest.mark.long
def test_a_job_that_kills_its_process_every_time_is_put_aside_and_others_go_on(
    cluster: Cluster, database: Database, train: Machine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    killing = tmp_path / "killing"
    killing.touch()
    monkeypatch.setenv(FILE, str(killing))
    with database.transaction() as session:
        machines.create(session, train)
    cluster.start_scheduler()
    cluster.start_other_worker("worker", "killing=1")
    close_run(database, train, seed=1, start_s=1_700_000_000)
    with identifying(database, cluster):
        until(lambda: counts(database) == {jobs.QUARANTINED: 1}, within_s=90, what="the job is put aside")
        assert attempts(database) == [3]
        killing.unlink()
        close_run(database, train, seed=2, start_s=1_700_100_000)
        until(lambda: counts(database) == {"quarantined": 1, "done": 1}, within_s=60, what="the next one is computed")


def attempts(database: Database) -> list[int]:
    """Return the jobs' attempts, oldest first."""
    with database.reading() as session:
        return [row.attempts for row in reversed(jobs.of_machine(session, "thesis-chapter-3", limit=100))]


@pytest.mark.long
@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("release=0.0.1, tasks of form 0", "runs release 0.0.1, tasks of form 0, this service "),
        pytest.param(
            "pretends=0.0.1, tasks of form 0", "runs release 0.0.1, tasks of form 0, this service ", marks=pytest.mark.long
        ),
        pytest.param(
            "without=service.workers.dask_task",
            "does not say its release: start it as `rundown worker` of release",
            marks=pytest.mark.long,
        ),
    ],
)
def test_a_worker_of_another_release_is_refused_with_words_and_the_job_goes_back_unhurt(
    cluster: Cluster, database: Database, train: Machine, monkeypatch: pytest.MonkeyPatch, change: str, words: str
) -> None:
    monkeypatch.setattr("service.workers.dask_worker_states.REFUSED_S", 3.0)
    with database.transaction() as session:
        machines.create(session, train)
    close_run(database, train, seed=1, start_s=1_700_000_000)
    cluster.start_scheduler()
    cluster.start_other_worker("other", change)
    with identifying(database, cluster) as work:
        until(lambda: words in (work.trouble or ""), within_s=40, what="the other release is named")
        assert counts(database) == {"queued": 1}
        assert attempts(database) == [0]
        cluster.start_worker("right")
        until(lambda: "working for the scheduler" in cluster.log("right"), within_s=30, what="another worker is there")
        until(lambda: counts(database) == {"done": 1}, within_s=30, what="the right one computes")
        assert attempts(database) == [1]


@pytest.mark.long
def test_what_a_frozen_worker_has_is_given_up_and_another_one_computes_it(
    cluster: Cluster, database: Database, train: Machine, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.workers.dask_worker_states.SILENT_S", 4.0)
    monkeypatch.setattr("service.workers.dask_executor.GRACE_S", 2.0)
    with database.transaction() as session:
        machines.create(session, train)
    cluster.start_scheduler()
    frozen = cluster.start_worker("frozen")
    until(lambda: "working for the scheduler" in cluster.log("frozen"), within_s=30, what="the worker is there")
    frozen.send_signal(signal.SIGSTOP)
    close_run(database, train, seed=1, start_s=1_700_000_000)
    with identifying(database, cluster, timeout_s=15.0) as work:  # also on a busy machine the second worker is quicker
        until(lambda: "has said nothing for" in (work.trouble or ""), within_s=60, what="it is named")
        assert counts(database) == {"queued": 1}
        assert attempts(database) == [1]
        assert work.gauges["rundown_stuck_identifications"] == 1
        cluster.start_worker("second")
        until(lambda: counts(database) == {"done": 1}, within_s=60, what="another one computes it")
        assert attempts(database) == [2]
        assert any("has said nothing for" in words for words in work.warnings)
        frozen.send_signal(signal.SIGCONT)
        close_run(database, train, seed=2, start_s=1_700_100_000)
        until(lambda: counts(database) == {"done": 2}, within_s=30, what="the next one is computed")


@pytest.mark.long
def test_a_worker_replaces_a_process_that_was_stopped(cluster: Cluster, database: Database, train: Machine) -> None:
    with database.transaction() as session:
        machines.create(session, train)
    cluster.start_scheduler()
    worker = cluster.start_other_worker("worker", "hand_over=1.5")
    close_run(database, train, seed=1, start_s=1_700_000_000)
    with identifying(database, cluster) as work:
        until(lambda: counts(database) == {"done": 1}, within_s=60, what="the worker computes")
        for child in psutil.Process(worker.pid).children(recursive=True):
            if "spawn_main" in " ".join(child.cmdline()):
                child.send_signal(signal.SIGSTOP)
        close_run(database, train, seed=2, start_s=1_700_100_000)
        until(lambda: counts(database) == {"done": 2}, within_s=60, what="a new process computes")
        assert "did not answer" in work.warnings[0]
    assert attempts(database) == [1, 2]


@pytest.mark.long
def test_a_frozen_scheduler_is_noticed(
    cluster: Cluster, database: Database, train: Machine, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("service.workers.dask_executor.CONNECT_S", 2.0)
    with database.transaction() as session:
        machines.create(session, train)
    scheduler = cluster.start_scheduler()
    cluster.start_worker("worker")
    close_run(database, train, seed=1, start_s=1_700_000_000)
    with identifying(database, cluster) as work:
        until(lambda: counts(database) == {"done": 1}, within_s=60, what="the worker computes")
        scheduler.send_signal(signal.SIGSTOP)
        close_run(database, train, seed=2, start_s=1_700_100_000)
        until(lambda: "does not answer" in (work.trouble or ""), within_s=30, what="the scheduler is named")
        scheduler.send_signal(signal.SIGCONT)
        until(lambda: counts(database) == {"done": 2}, within_s=60, what="it goes on")


def test_a_worker_that_waits_for_its_scheduler_ends_when_it_is_told_to(cluster: Cluster) -> None:
    worker = cluster.start_worker("waiting")
    until(lambda: "Waiting to connect" in cluster.log("waiting"), within_s=30, what="it waits")
    worker.send_signal(signal.SIGTERM)
    assert worker.wait(timeout=20) == 0, cluster.log("waiting")
