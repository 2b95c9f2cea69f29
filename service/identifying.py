"""Identification jobs: taken from the queue, computed in worker processes, stored with the alerts that follow from them."""

import logging
import threading
import time
from concurrent.futures import CancelledError, Future
from concurrent.futures.process import BrokenProcessPool
from dataclasses import asdict, dataclass, replace
from importlib.metadata import version as version_of_the_code

from sqlalchemy.exc import DataError, DBAPIError, IntegrityError
from sqlalchemy.orm import Session

from estimator.identification import Options
from estimator.machine import parse_machine
from service import requesting, watching, worker
from service.engines import EngineAway, engine
from service.own_faults import unexpected
from service.settings import Settings
from service.sharing import GATHERING, Share, Whole
from storage import derived, identifications, jobs, machines, quarantine, replicas, runs, slow_roll
from storage.blocks import DamagedBlock, encode
from storage.damage import is_damage
from storage.database import Database
from storage.errors import concerns_all, words
from storage.identifications import Origin
from storage.tables import IdentificationRow, JobRow

logger = logging.getLogger(__name__)

POLL_S = 0.1
RETRY_S = 1.0
GATHERED_KIND = "gathered"
"""`run_kind` of an identification from several runs, which may be of both kinds."""


@dataclass(frozen=True)
class _Taken:
    """A job that is being computed. reopened: how often each of its runs had been made anew when its samples were read."""

    job_id: int
    reopened: tuple[int, ...]


class _Unreadable(Exception):
    """What a job is about cannot be read."""

    def __init__(self, job_id: int, why: str) -> None:
        super().__init__(why)
        self.job_id = job_id


class _Unjudged(Exception):
    """What an identification is compared with is damaged."""


class Identifying:
    """The thread that keeps the workers busy and files their results."""

    def __init__(self, database: Database, settings: Settings, share: Share | None = None) -> None:
        self._database = database
        self._settings = settings
        self._share = share or Whole()
        self._options = Options()
        self._engine = engine(settings)
        self._running: dict[Future[worker.Outcome], _Taken] = {}
        self._stop = threading.Event()
        self._news = threading.Event()  # a result is there, or the service stops
        self._thread = threading.Thread(target=self._run, name="identifying", daemon=True)
        self.trouble: str | None = None
        """Why jobs cannot be taken or filed at the moment."""

    def start(self) -> None:
        """Put back what an earlier process left unfinished, then begin."""
        with self._database.transaction() as session:
            living = [row.id for row in replicas.every(session)] if self._share.holder is not None else []
            left = jobs.put_back_running(session, living=living)
        if left:
            logger.info("%d identifications were interrupted and are computed again", left)
        self._thread.start()

    def stop(self) -> None:
        """Take no more jobs and end the workers; what they were computing is computed again after the next start."""
        self._stop.set()
        self._news.set()
        self._thread.join()
        self._engine.close()

    @property
    def alive(self) -> bool:
        """Whether the thread runs."""
        return self._thread.is_alive()

    def _run(self) -> None:
        gathered_at, doubtful = time.monotonic(), False
        while not self._stop.is_set():
            self._news.wait(POLL_S)
            self._news.clear()
            try:
                if doubtful:
                    self._put_back_lost()
                    doubtful = False
                try:
                    self._submit()  # first: no worker need wait for results to be filed
                finally:
                    self._file_done()
                if time.monotonic() - gathered_at >= self._settings.gathered_interval_s and self._share.leads(GATHERING):
                    gathered_at = time.monotonic()
                    self._ask_gathered()
                self.trouble = None
            except EngineAway as error:
                self.trouble = str(error)
                logger.error("%s; trying again", error)
                self._stop.wait(RETRY_S)
            except DBAPIError as error:
                self.trouble = str(error.orig)
                logger.error("identification jobs cannot be read or filed, trying again: %s", error.orig)
                self._stop.wait(RETRY_S)
                doubtful = True
            except Exception:
                self.trouble = "unexpected error; the log has it"
                logger.exception("unexpected error in the identification thread")
                self._stop.wait(RETRY_S)

    def _put_back_lost(self) -> None:
        """Own jobs of which nothing is known here: they were taken when the database's answer got lost."""
        if self._share.holder is None:
            return
        with self._database.transaction() as session:
            for row in jobs.held_by(session, self._share.holder):
                if all(row.id != taken.job_id for taken in self._running.values()):
                    logger.warning("job %d was taken and not begun; it is taken again", row.id)
                    jobs.put_back_unhurt(row)

    def _submit(self) -> None:
        with self._database.reading() as session:
            if not jobs.waiting(session):
                return
        capacity = self._engine.capacity()
        computing = sum(not future.done() for future in self._running)
        free = min(capacity - computing, 2 * capacity - len(self._running))
        if free <= 0:
            return
        try:
            tasks = self._take(free)
        except _Unreadable as error:
            self._fail_unread(error.job_id, str(error))
            return
        away: EngineAway | None = None
        for taken, task in tasks:
            try:
                future = self._engine.submit(task)
                self._running[future] = taken
                future.add_done_callback(lambda _: self._news.set())
            except EngineAway as error:
                away = error
                self._put_back_unhurt(taken.job_id)
        if away is not None:
            raise away

    def _take(self, count: int) -> list[tuple[_Taken, worker.Task]]:
        """The next jobs, with what they are about. Raises _Unreadable, and has taken none then: behind damage, SQLite writes
        nothing more in a transaction.
        """
        tasks: list[tuple[_Taken, worker.Task]] = []
        with self._database.transaction() as session:
            for row in jobs.take(session, count, holder=self._share.holder):
                try:
                    with session.begin_nested():
                        taken = _Taken(row.id, _reopened(session, row))
                        tasks.append((taken, _task(session, row, self._options, self._settings)))
                except Exception as error:  # whatever is the matter with one job must not stop the others
                    if concerns_all(error):
                        raise
                    if is_damage(error):
                        raise _Unreadable(row.id, words(error)) from error
                    jobs.finish(row, state=jobs.FAILED, error=f"its data cannot be read: {error}")
        return tasks

    def _fail_unread(self, job_id: int, why: str) -> None:
        logger.error("the data of job %d cannot be read: %s", job_id, why)
        with self._database.transaction() as session:
            row = jobs.get(session, job_id)
            self._database.damage.concerns(row.machine_id)
            jobs.finish(row, state=jobs.FAILED, error=f"its data cannot be read: {why}")

    def _file_done(self) -> None:
        """File what is computed. What cannot be filed now is filed later, and behind the others: it holds up none of them."""
        for future in [future for future in self._running if future.done()]:
            taken = self._running.pop(future)
            try:
                self._file(future, taken)
            except Exception:
                self._running[future] = taken
                raise

    def _file(self, future: Future[worker.Outcome], taken: _Taken) -> None:
        job_id = taken.job_id
        try:
            result = future.result()
        except BrokenProcessPool as error:
            logger.error("the process that computed job %d died; it is tried again", job_id)
            self._put_back(job_id, str(error))
            return
        except CancelledError:
            logger.warning("job %d was lost with what computed it; it is tried again", job_id)
            self._put_back_unhurt(job_id)
            return
        except (worker.OutOfTime, MemoryError) as error:
            # Beside less other work it may have enough of both: that is tried as often as after a death.
            logger.error("job %d took more than it may; it is tried three times: %s", job_id, type(error).__name__)
            self._put_back(job_id, f"{type(error).__name__}: {error}")
            return
        except Exception as error:  # noqa: BLE001 - whatever a fit raises becomes the job's recorded failure
            self._fail(job_id, f"{type(error).__name__}: {error}")
            return
        try:
            self._store(taken, result)
        except (DataError, IntegrityError) as error:
            self._fail(job_id, f"its result cannot be stored: {error.orig}")
        except MemoryError:
            raise  # of the moment, not of the result
        except Exception as error:
            if concerns_all(error):
                raise  # so is this
            logger.exception("the result of job %d cannot be stored", job_id)
            self._fail(job_id, f"its result cannot be stored: {type(error).__name__}: {error}")

    def _store(self, taken: _Taken, outcome: worker.Outcome) -> None:
        """Store a result with what follows from it; without that where it meets damage.

        Behind damage SQLite writes nothing more in the same transaction.
        """
        try:
            self._store_once(taken, outcome, judged=True)
        except _Unjudged as error:
            logger.error("the result of job %d is stored, but no alert follows from it: %s", taken.job_id, error)
            self._store_once(taken, outcome, judged=False)

    def _store_once(self, taken: _Taken, outcome: worker.Outcome, *, judged: bool) -> None:
        job_id, result = taken.job_id, outcome.identification
        with self._database.transaction() as session:
            row = self._own(session, job_id)
            if row is None:
                return
            machines.lock(session, row.machine_id)
            if _reopened(session, row) != taken.reopened:
                logger.info("job %d is computed again: late samples have made its run anew meanwhile", job_id)
                jobs.put_back_unhurt(row)
                return
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
            if judged:
                self._judge(session, stored)
        logger.info("%s: identification %d %s", row.machine_id, stored.id, result.verdict)

    def _judge(self, session: Session, stored: IdentificationRow) -> None:
        """Draw the conclusions, all or none of them. A result is kept, and the next job taken, also where that fails."""
        try:
            with session.begin_nested():
                watching.judge(session, stored, baseline_runs=self._settings.baseline_runs)
        except Exception as error:
            if concerns_all(error):
                raise  # it is tried again as a whole
            if is_damage(error):
                self._database.damage.concerns(stored.machine_id)
                raise _Unjudged(words(error)) from error
            logger.exception("identification %d of %s is stored, but no alert follows from it", stored.id, stored.machine_id)
            of, what = f"identification {stored.id}", "it is stored, but no alert follows from it"
            quarantine.add(session, [unexpected(error, of=of, machine_id=stored.machine_id, what=what)])

    def _own(self, session: Session, job_id: int) -> JobRow | None:
        """A job that this replica computes; None when another one has taken it over."""
        try:
            row = jobs.get(session, job_id)
        except jobs.JobUnknown:
            logger.warning("job %d is not in the database any more: its result is left out", job_id)
            return None
        if (row.state, row.holder) == (jobs.RUNNING, self._share.holder):
            return row
        logger.warning("job %d was taken over by another replica: its result is left to that one", job_id)
        return None

    def _put_back(self, job_id: int, error: str) -> None:
        with self._database.transaction() as session:
            if (row := self._own(session, job_id)) is not None:
                jobs.put_back(row, error)

    def _put_back_unhurt(self, job_id: int) -> None:
        with self._database.transaction() as session:
            if (row := self._own(session, job_id)) is not None:
                jobs.put_back_unhurt(row)

    def _fail(self, job_id: int, error: str) -> None:
        logger.warning("identification job %d failed: %s", job_id, error)
        with self._database.transaction() as session:
            if (row := self._own(session, job_id)) is not None:
                jobs.finish(row, state=jobs.FAILED, error=error)

    def _ask_gathered(self) -> None:
        """Queue an identification over the newest runs of each machine that has more than one."""
        with self._database.transaction() as session:
            for machine in machines.every(session):
                newest = runs.newest_closed(session, machine.id, revision=machine.revision, limit=self._settings.gathered_runs)
                if len(newest) > 1:
                    ordered = sorted(newest, key=lambda run: run.id)
                    again = [run.times_reopened or 0 for run in ordered]
                    # Runs that late samples have made anew are gathered anew.
                    options = {"reopened": again} if any(again) else None
                    jobs.ask(session, machine.id, scope=jobs.GATHERED, run_ids=[run.id for run in ordered], options=options)


def _reopened(session: Session, row: JobRow) -> tuple[int, ...]:
    return tuple(runs.get(session, run_id).times_reopened or 0 for run_id in row.run_ids)


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
    except (DamagedBlock, runs.SamplesReleased) as error:
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
