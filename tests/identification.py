"""Closed runs of the train of the thesis's Chapter 3, with their jobs, as the collector leaves them."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from sqlalchemy import select

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.phasors.channel_status import ChannelStatus
from estimator.simulation.simulated_plant import draw_truth, measured_phasors, speed_law
from formats.files.document_files import read_machine
from service.configuration.settings import Settings
from service.identification.scheduler import JobScheduler
from service.identification.worker_tasks import TASKS
from service.workers.executor import Executor
from service.workers.executors import LocalExecutor
from storage.database.engine import Database
from storage.encoding.sample_blocks import Samples
from storage.findings import jobs
from storage.measurements import runs
from storage.tables.findings import JobRow
from tests.plant import SECOND


def chapter_3() -> Machine:
    """The train of the thesis's Chapter 3."""
    return read_machine(Path(__file__).parents[1] / "examples" / "thesis-chapter-3.yaml")


def forward_samples(time_ns: Floats, speed: Floats, phasor: Complexes) -> Samples:
    """Samples of 1x phasors in the positive direction, good where there is one."""
    return Samples(
        time=time_ns.astype(np.int64),
        speed=speed,
        direction=np.ones(speed.size, np.int8),
        phasor=phasor,
        status=np.where(np.isfinite(phasor), ChannelStatus.GOOD, ChannelStatus.NOT_AVAILABLE).astype(np.uint8),
        scatter=np.full(phasor.shape, np.nan),
        second=np.full(phasor.shape, complex(np.nan, np.nan)),
    )


def close_run(database: Database, train: Machine, *, seed: int, start_s: int, ask: bool = True) -> int:
    """Store a run-down as the collector would, with its job."""
    rng = np.random.default_rng(seed)
    seconds, speed = speed_law(train, "run-down", duration=300.0, samples=100)
    phasor = measured_phasors(train, draw_truth(train, rng), speed, rng)
    held = forward_samples(start_s * SECOND + seconds * 1e9, speed, phasor)
    with database.transaction() as session:
        row = runs.open_run(session, train.id, revision=1, kind="run-down", direction=1, time_first=int(held.time[0]))
        runs.close(row, samples=held, state=runs.CLOSED, reason="the speed left the speed range")
        if ask:
            jobs.enqueue(session, train.id, scope=jobs.RUN, run_ids=[row.id])
        return row.id


@contextmanager
def working(workers: int) -> Iterator[LocalExecutor]:
    """Worker processes for several schedulers, one after the other."""
    executor = LocalExecutor(workers, memory_bytes=Settings().identification_memory_mb * 2**20, tasks=TASKS)
    try:
        yield executor
    finally:
        executor.close()


@contextmanager
def identifying(database: Database, executor: Executor | None = None, **changes: object) -> Iterator[JobScheduler]:
    """The identification thread at work. executor: one that others use too; by default processes of its own."""
    work = JobScheduler(database, Settings(workers=1).model_copy(update=changes), executor=executor)
    work.start()
    try:
        yield work
    finally:
        work.stop()


def unfinished(database: Database) -> list[tuple[object, ...]]:
    """Jobs that are not done, and what is known of them."""
    with database.reading() as session:
        rows = [row for row in session.scalars(select(JobRow)) if row.state != jobs.DONE]
        return [(row.id, row.state, row.attempts, row.holder, row.error) for row in rows]


def counts(database: Database) -> dict[str, int]:
    """Jobs by state."""
    with database.reading() as session:
        return jobs.count(session)
