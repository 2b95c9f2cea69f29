"""Identification jobs: taken from the queue, computed in worker processes, stored with the alerts that follow from them."""

import logging
import multiprocessing
import threading
import time
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict, replace
from importlib.metadata import version as version_of_the_code

from sqlalchemy.exc import DBAPIError, IntegrityError
from sqlalchemy.orm import Session

from estimator.identification import Options
from estimator.machine import DocumentError, parse_machine
from service import requesting, watching, worker
from service.settings import Settings
from storage import derived, identifications, jobs, machines, runs, slow_roll
from storage.blocks import DamagedBlock, encode
from storage.database import Database
from storage.identifications import Origin
from storage.tables import IdentificationRow, JobRow

logger = logging.getLogger(__name__)

POLL_S = 0.1
RETRY_S = 1.0
GATHERED_KIND = "gathered"
"""`run_kind` of an identification from several runs, which may be of both kinds."""


def process_pool(workers: int) -> ProcessPoolExecutor:
    """Spawned worker processes: a fork with a zenoh session open would crash."""
    context = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(workers, mp_context=context, initializer=worker.prepare)


class Identifying:
    """The thread that keeps the workers busy and files their results."""

    def __init__(self, database: Database, settings: Settings) -> None:
        self._database = database
        self._settings = settings
        self._options = Options()
        self._executor: Executor = process_pool(settings.workers)
        self._running: dict[Future[worker.Outcome], tuple[int, Executor]] = {}
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="identifying", daemon=True)
        self.trouble: str | None = None
        """Why jobs cannot be taken or filed at the moment."""

    def start(self) -> None:
        """Put back what an earlier process left unfinished, then begin."""
        with self._database.transaction() as session:
            left = jobs.put_back_running(session)
        if left:
            logger.info("%d identifications were interrupted and are computed again", left)
        self._thread.start()

    def stop(self) -> None:
        """Take no more jobs and end the workers; what they were computing is computed again after the next start."""
        self._stop.set()
        self._thread.join()
        for child in multiprocessing.active_children():
            child.terminate()
        self._executor.shutdown(wait=True, cancel_futures=True)

    @property
    def alive(self) -> bool:
        """Whether the thread runs."""
        return self._thread.is_alive()

    def _run(self) -> None:
        gathered_at = time.monotonic()
        while not self._stop.wait(POLL_S):
            try:
                for future in [future for future in self._running if future.done()]:
                    self._file(future, *self._running[future])
                    del self._running[future]  # only now: what could not be filed is filed later
                self._submit()
                if time.monotonic() - gathered_at >= self._settings.gathered_interval_s:
                    gathered_at = time.monotonic()
                    self._ask_gathered()
                self.trouble = None
            except DBAPIError as error:
                self.trouble = str(error.orig)
                logger.error("identification jobs cannot be read or filed, trying again: %s", error.orig)
                self._stop.wait(RETRY_S)
            except Exception:
                logger.exception("unexpected error in the identification thread")
                self._stop.wait(RETRY_S)

    def _submit(self) -> None:
        free = self._settings.workers - len(self._running)
        if free <= 0:
            return
        with self._database.reading() as session:
            if not jobs.waiting(session):
                return
        tasks: list[tuple[int, worker.Task]] = []
        with self._database.transaction() as session:
            for row in jobs.take(session, free):
                try:
                    tasks.append((row.id, _task(session, row, self._options, self._settings)))
                except (DamagedBlock, DocumentError, KeyError) as error:
                    jobs.finish(row, state=jobs.FAILED, error=f"its data cannot be read: {error}")
        for job_id, task in tasks:
            try:
                self._running[self._executor.submit(worker.compute, task)] = job_id, self._executor
            except BrokenProcessPool as error:
                self._replace_workers(self._executor)
                self._put_back(job_id, str(error))

    def _file(self, future: Future[worker.Outcome], job_id: int, executor: Executor) -> None:
        try:
            result = future.result()
        except BrokenProcessPool as error:
            logger.error("an identification process died; its job is tried again")
            self._replace_workers(executor)
            self._put_back(job_id, str(error))
            return
        except Exception as error:  # noqa: BLE001 - whatever a fit raises becomes the job's recorded failure
            self._fail(job_id, f"{type(error).__name__}: {error}")
            return
        try:
            self._store(job_id, result)
        except IntegrityError as error:
            self._fail(job_id, f"its result cannot be stored: {error.orig}")

    def _store(self, job_id: int, outcome: worker.Outcome) -> None:
        result = outcome.identification
        with self._database.transaction() as session:
            row = jobs.get(session, job_id)
            if row.scope == jobs.RUN:
                runs.keep_quality(session, row.run_ids[0], outcome.qualities[0])
            if result is None:
                jobs.finish(row, state=jobs.FAILED, error=outcome.error)
                logger.warning("identification job %d failed: %s", job_id, outcome.error)
                return
            origin = replace(_origin(session, row, self._options, outcome.beginning), conditions=outcome.conditions or None)
            stored = identifications.add(session, origin, result)
            derived.add(session, stored, outcome.derived)
            if outcome.underived is not None:
                logger.warning("nothing is derived from identification %d: %s", stored.id, outcome.underived)
            jobs.finish(row, state=jobs.DONE)
            session.flush()
            self._judge(session, stored)
        logger.info("%s: identification %d %s", row.machine_id, stored.id, result.verdict)

    def _judge(self, session: Session, stored: IdentificationRow) -> None:
        """Draw the conclusions, all or none of them. A result is kept, and the next job taken, also where that fails."""
        try:
            with session.begin_nested():
                watching.judge(session, stored, baseline_runs=self._settings.baseline_runs)
        except DBAPIError:
            raise  # of the database, which is tried again as a whole
        except Exception:
            logger.exception("identification %d of %s is stored, but no alert follows from it", stored.id, stored.machine_id)

    def _put_back(self, job_id: int, error: str) -> None:
        with self._database.transaction() as session:
            jobs.put_back(jobs.get(session, job_id), error)

    def _fail(self, job_id: int, error: str) -> None:
        logger.warning("identification job %d failed: %s", job_id, error)
        with self._database.transaction() as session:
            jobs.finish(jobs.get(session, job_id), state=jobs.FAILED, error=error)

    def _replace_workers(self, broken: Executor) -> None:
        """A pool that lost a worker takes no more; its other jobs learn of it one after the other."""
        if broken is self._executor:
            broken.shutdown(wait=False, cancel_futures=True)
            self._executor = process_pool(self._settings.workers)

    def _ask_gathered(self) -> None:
        """Queue an identification over the newest runs of each machine that has more than one."""
        with self._database.transaction() as session:
            for machine in machines.every(session):
                newest = runs.newest_closed(session, machine.id, revision=machine.revision, limit=self._settings.gathered_runs)
                if len(newest) > 1:
                    jobs.ask(session, machine.id, scope=jobs.GATHERED, run_ids=sorted(run.id for run in newest))


def _task(session: Session, row: JobRow, options: Options, settings: Settings) -> worker.Task:
    revision = runs.get(session, row.run_ids[0]).revision
    blocks = [encode(held) for run_id in row.run_ids if (held := runs.samples(session, run_id)) is not None]
    document = machines.revision(session, row.machine_id, revision).document
    version = requesting.slow_roll_version(session, row)
    machine, vectors = parse_machine(document), None
    if version is not None:
        vectors = slow_roll.vectors(slow_roll.get(session, row.machine_id, version), machine)
    return worker.Task(
        document,
        blocks,
        requesting.fit_options(row, options),
        settings.identification_timeout_s,
        rules=requesting.quality_rules(row, machine.quality),
        earlier=_earlier(session, row) if row.scope == jobs.RUN else None,
        slow_roll=vectors,
        beginning=_beginning(session, row, revision, version),
    )


def _beginning(session: Session, row: JobRow, revision: int, slow_roll_version: int | None) -> tuple[int, bytes] | None:
    """The point of the machine's first good identification: from there outliers lead no fit astray."""
    first = identifications.first_of(session, row.machine_id, revision=revision, slow_roll_version=slow_roll_version)
    return None if first is None or first.point is None else (first.id, first.point)


def _earlier(session: Session, row: JobRow) -> tuple[str, bytes] | None:
    """The run that a run is compared with: the one before it of the same kind, revision and sense of rotation."""
    before = runs.before(session, runs.get(session, row.run_ids[0]))
    if before is None:
        return None
    try:
        held = runs.samples(session, before.id)
    except DamagedBlock as error:
        logger.warning("run %d is not compared with run %d: %s", row.run_ids[0], before.id, error)
        return None
    return None if held is None else (f"run {before.id}", encode(held))


def _origin(session: Session, row: JobRow, options: Options, beginning: int | None) -> Origin:
    used = [runs.get(session, run_id) for run_id in row.run_ids]
    version = requesting.slow_roll_version(session, row)
    described = asdict(requesting.fit_options(row, options))
    if beginning is not None:
        described["beginning"] = beginning
    if version is not None:
        machine = machines.document(session, row.machine_id, used[0].revision)
        described["slow_roll_left_out"] = slow_roll.doubtful(slow_roll.get(session, row.machine_id, version), machine)
    return Origin(
        machine_id=row.machine_id,
        revision=used[0].revision,
        job_id=row.id,
        scope=row.scope,
        run_kind=GATHERED_KIND if row.scope == jobs.GATHERED else used[0].kind,
        run_ids=row.run_ids,
        measured_at=max(run.time_last or run.time_first for run in used),
        options=described,
        code_version=version_of_the_code("rundown"),
        slow_roll_version=version,
    )
