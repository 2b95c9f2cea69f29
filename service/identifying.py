"""Identification jobs: taken from the queue, computed in worker processes, stored with the alerts that follow from them."""

import logging
import threading
import time
from collections import deque
from concurrent.futures import CancelledError, Future
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass, replace

from sqlalchemy.exc import DataError, DBAPIError, IntegrityError
from sqlalchemy.orm import Session

from estimator.identification import Options
from service import requesting, worker
from service.engines import EngineAway, Refused, engine
from service.job_task import origin, reopened, task
from service.judgement import Judgement, Question
from service.judgements import Due, Judgements
from service.processes import Interrupted, Stuck
from service.settings import Settings
from service.sharing import GATHERING, Share, Whole
from storage import derived, identifications, jobs, machines, replicas, runs
from storage.damage import is_damage
from storage.database import Database
from storage.errors import concerns_all, words
from storage.job_order import AUTOMATIC, OVERDUE_SHARE
from storage.tables import JobRow, MachineRow

logger = logging.getLogger(__name__)

POLL_S = 0.1
RETRY_S = 1.0
TOLD_S = 3600.0
AT_ONCE = 10
"""Machines that are looked at in one transaction."""


@dataclass(frozen=True)
class _Taken:
    """A job that is being computed. reopened: how often each of its runs had been made anew when its samples were read.

    automatic: as of `storage.job_order`.
    """

    job_id: int
    automatic: bool
    reopened: tuple[int, ...]


class Identifying:
    """The thread that keeps the workers busy and files their results."""

    def __init__(self, database: Database, settings: Settings, share: Share | None = None) -> None:
        self._database = database
        self._settings = settings
        self._share = share or Whole()
        self._options = Options()
        self._engine = engine(settings)
        self._running: dict[Future[worker.Outcome], _Taken] = {}
        self._automatic_in_a_row = 0
        self._stuck: deque[tuple[float, str]] = deque(maxlen=1000)
        self._stuck_count = 0
        self._judgements = Judgements(database, ask=self._ask, own=self._own, baseline_runs=settings.baseline_runs)
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
    def warnings(self) -> list[str]:
        """What is wrong with what computes, though jobs are taken; what stopped answering is told of for an hour."""
        stuck = [words for at, words in self._stuck if time.monotonic() < at + TOLD_S]
        told = [f"identifications given up in the last hour: {len(stuck)}; of the last one, {stuck[-1]}"] if stuck else []
        return [*self._engine.warnings(), *told]

    @property
    def gauges(self) -> dict[str, float]:
        """Figures for a monitoring system."""
        return {"rundown_stuck_identifications": self._stuck_count}

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
                    self._engine.look()
                    self._judgements.submit()
                    self._submit()  # first: no worker need wait for results to be filed
                finally:
                    self._file_done()
                    self._judgements.file_done()
                if time.monotonic() - gathered_at >= self._settings.gathered_interval_s and self._share.leads(GATHERING):
                    gathered_at = time.monotonic()
                    self._ask_gathered()
                self.trouble = None
            except EngineAway as error:
                if str(error) != self.trouble:
                    logger.error("%s; trying again", error)
                self.trouble = str(error)
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
                doubtful = True

    def _put_back_lost(self) -> None:
        """Own jobs of which nothing is known here: they were taken when the database's answer got lost."""
        with self._database.transaction() as session:
            for row in jobs.held_by(session, self._share.holder):
                computed = any(row.id == taken.job_id for taken in self._running.values())
                if not computed and row.id not in self._judgements:
                    logger.warning("job %d was taken and not begun; it is taken again", row.id)
                    jobs.put_back_unhurt(row)

    def _submit(self) -> None:
        with self._database.reading() as session:
            if not jobs.waiting(session):
                return
        capacity = self._engine.capacity()
        computing = sum(not future.done() for future in self._running) + self._judgements.computing
        free = min(capacity - computing, 2 * capacity - len(self._running))
        behind = max(1, capacity - 1) - sum(not (future.done() or taken.automatic) for future, taken in self._running.items())
        if free <= 0 or (behind <= 0 and not self._automatic_waits()):
            return
        away: EngineAway | None = None
        for taken in self._take(free, behind):
            task = self._task(taken)
            if task is None:
                continue
            try:
                future = self._engine.submit(task.timeout_s, worker.compute, task)
                self._running[future] = taken
                future.add_done_callback(lambda _: self._news.set())
            except EngineAway as error:
                away = error
                self._put_back_unhurt(taken.job_id)
        if away is not None:
            raise away

    def _automatic_waits(self) -> bool:
        with self._database.reading() as session:
            return jobs.waiting(session, automatic=True)

    def _take(self, count: int, behind: int) -> list[_Taken]:
        """The next jobs. One whose result was stored by a process that ended before it was judged is judged and no more."""
        taken = []
        with self._database.transaction() as session:
            overdue = self._automatic_in_a_row >= OVERDUE_SHARE - 1
            for row in jobs.take(session, count, holder=self._share.holder, behind=behind, overdue=overdue):
                automatic = row.priority == AUTOMATIC
                self._automatic_in_a_row = self._automatic_in_a_row + 1 if automatic else 0
                stored = identifications.of_job(session, row.id)
                if stored is None:
                    requesting.slow_roll_version(session, row)
                    taken.append(_Taken(row.id, automatic, reopened(session, row)))
                else:
                    self._judgements.add(Due(row.id, stored, row.machine_id))
        return taken

    def _task(self, taken: _Taken) -> worker.Task | None:
        """What a job is about; None where its data cannot be read: whatever is the matter with it must not stop the others."""
        try:
            with self._database.reading() as session:
                row = jobs.get(session, taken.job_id)
                return task(session, row, self._options, timeout_s=self._settings.identification_timeout_s)
        except MemoryError as error:
            self._put_back(taken.job_id, f"its data need more memory than there is: {error}")
            return None
        except Exception as error:
            if concerns_all(error):
                raise
            self._fail_unread(taken.job_id, words(error), damaged=is_damage(error))
            return None

    def _fail_unread(self, job_id: int, why: str, *, damaged: bool) -> None:
        logger.error("the data of job %d cannot be read: %s", job_id, why)
        with self._database.transaction() as session:
            row = self._own(session, job_id)
            if row is not None:
                if damaged:
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
        except Stuck as error:
            logger.error("job %d was given up with what computed it; it is tried three times: %s", job_id, error)
            self._stuck.append((time.monotonic(), str(error)))
            self._stuck_count += 1
            self._put_back(job_id, f"Stuck: {error}")
            return
        except (Refused, Interrupted) as error:
            logger.warning("job %d is taken again: %s", job_id, error)
            self._put_back_unhurt(job_id)
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
        job_id, result = taken.job_id, outcome.identification
        with self._database.transaction() as session:
            row = self._own(session, job_id)
            if row is None:
                return
            machines.lock(session, row.machine_id)
            if reopened(session, row) != taken.reopened:
                logger.info("job %d is computed again: late samples have made its run anew meanwhile", job_id)
                jobs.put_back_unhurt(row)
                return
            if row.scope == jobs.RUN:
                runs.keep_quality(session, row.run_ids[0], outcome.qualities[0])
                runs.keep_crossed(session, row.run_ids[0], outcome.crossed[0])
            if result is None:
                jobs.finish(row, state=jobs.FAILED, error=outcome.error)
                logger.warning("identification job %d failed: %s", job_id, outcome.error)
                return
            came_from = replace(origin(session, row, self._options, outcome.beginning), conditions=outcome.conditions or None)
            stored = identifications.add(session, came_from, result)
            derived.add(session, stored, outcome.derived)
            if outcome.underived is not None:
                logger.warning("nothing is derived from identification %d: %s", stored.id, outcome.underived)
            session.flush()
            due = Due(job_id, stored.id, stored.machine_id)
        self._judgements.add(due)
        logger.info("%s: identification %d %s", row.machine_id, stored.id, result.verdict)

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
                jobs.put_back(session, row, error)

    def _put_back_unhurt(self, job_id: int) -> None:
        with self._database.transaction() as session:
            if (row := self._own(session, job_id)) is not None:
                jobs.put_back_unhurt(row)

    def _fail(self, job_id: int, error: str) -> None:
        logger.warning("identification job %d failed: %s", job_id, error)
        with self._database.transaction() as session:
            if (row := self._own(session, job_id)) is not None:
                jobs.finish(row, state=jobs.FAILED, error=error)

    def _ask(self, question: Question) -> Future[Judgement]:
        limit = self._settings.identification_timeout_s
        future = self._engine.submit(limit, worker.judge, (question, limit))
        future.add_done_callback(lambda _: self._news.set())
        return future

    def _ask_gathered(self) -> None:
        """Queue an identification over the newest runs of each machine that has more than one."""
        with self._database.reading() as session:
            every = machines.ids(session)
        for first in range(0, len(every), AT_ONCE):
            with self._database.transaction() as session:
                for machine in machines.some(session, every[first : first + AT_ONCE]):
                    self._ask_gathered_of(session, machine)

    def _ask_gathered_of(self, session: Session, machine: MachineRow) -> None:
        newest = runs.newest_closed(session, machine.id, revision=machine.revision, limit=self._settings.gathered_runs)
        if len(newest) > 1:
            ordered = sorted(newest, key=lambda run: run.id)
            again = [run.times_reopened or 0 for run in ordered]
            # Runs that late samples have made anew are gathered anew.
            options = {"reopened": again} if any(again) else None
            jobs.ask(session, machine.id, scope=jobs.GATHERED, run_ids=[run.id for run in ordered], options=options)
