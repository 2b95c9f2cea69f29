"""Judgements that are due: stored identifications of which it is still to be said what they mean for their machine.

A machine's identifications are judged one after the other, in the order in which they were stored. What is asked is read in
one transaction and what follows is written in another; in between a worker computes, and nobody's storing waits for it.
"""

import logging
from collections import Counter, deque
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass

from sqlalchemy.orm import Session

from service import watching
from service.engines import Refused
from service.judgement import Judgement, Question
from service.own_faults import unexpected_error
from service.processes import Interrupted, Stuck
from service.worker import OutOfTime
from storage import identifications, jobs, machines, quarantine
from storage.damage import is_damage
from storage.database import Database
from storage.errors import concerns_all
from storage.tables import JobRow

logger = logging.getLogger(__name__)

LARGEST_ATTEMPTS = 3
"""So often a judgement may cost its worker its life, or more than it may take."""


@dataclass(frozen=True)
class Due:
    """An identification that is to be judged, and the job that ends with that."""

    job_id: int
    identification_id: int
    machine_id: str


class Judgements:
    """What is due, and what workers are asked. For one thread.

    ask: gives a question to a worker; raises EngineAway. own: the job, if it is still this process's to finish.
    """

    def __init__(
        self,
        database: Database,
        *,
        ask: Callable[[Question], Future[Judgement]],
        own: Callable[[Session, int], JobRow | None],
        baseline_runs: int,
    ) -> None:
        self._database = database
        self._ask = ask
        self._own = own
        self._baseline_runs = baseline_runs
        self._due: dict[str, deque[Due]] = {}
        self._asked: dict[Future[Judgement], tuple[Due, Question]] = {}
        self._attempts: Counter[int] = Counter()

    def __contains__(self, job_id: int) -> bool:
        """Whether a job waits here."""
        return any(one.job_id == job_id for machine in self._due.values() for one in machine)

    @property
    def computing(self) -> int:
        """How many workers this keeps busy."""
        return sum(not future.done() for future in self._asked)

    def add(self, due: Due) -> None:
        """Take an identification that was stored just now, or before this process began."""
        self._due.setdefault(due.machine_id, deque()).append(due)

    def submit(self) -> None:
        """Ask for the first of each machine. Raises what the database raises, and EngineAway; then it is asked again later."""
        busy = {due.machine_id for due, _ in self._asked.values()}
        for due in [machine[0] for machine_id, machine in self._due.items() if machine_id not in busy]:
            try:
                question = self._question(due)
            except Exception as error:
                if concerns_all(error):
                    raise
                self._give_up(due, error)
                continue
            if question is None:
                self._finish(due)
            else:
                self._asked[self._ask(question)] = due, question

    def file_done(self) -> None:
        """Draw the conclusions of what is answered. What cannot be stored now is stored later."""
        for future in [future for future in self._asked if future.done()]:
            due, question = self._asked.pop(future)
            try:
                self._file(future, due, question)
            except Exception:
                self._asked[future] = due, question
                raise

    def _question(self, due: Due) -> Question | None:
        with self._database.reading() as session:
            stored = identifications.get(session, due.identification_id)
            return watching.question(session, stored, baseline_runs=self._baseline_runs)

    def _file(self, future: Future[Judgement], due: Due, question: Question) -> None:
        try:
            answer = future.result()
        except (CancelledError, Refused, Interrupted):
            logger.warning("a judgement of %s was lost with what computed it; it is asked for again", due.machine_id)
        except (BrokenProcessPool, Stuck, OutOfTime, MemoryError) as error:
            self._attempts[due.job_id] += 1
            logger.error("identification %d cannot be judged: %s", due.identification_id, error or type(error).__name__)
            if self._attempts[due.job_id] >= LARGEST_ATTEMPTS:
                self._give_up(due, error)
        except Exception as error:  # noqa: BLE001 - whatever a judgement raises is told
            self._give_up(due, error)
        else:
            self._conclude(due, question, answer)

    def _conclude(self, due: Due, question: Question, answer: Judgement) -> None:
        """All conclusions, or none of them: a result is kept, and the next job taken, also where that fails."""
        try:
            with self._database.transaction() as session:
                row = self._own(session, due.job_id)
                if row is not None:
                    machines.lock(session, due.machine_id)
                    stored = identifications.get(session, due.identification_id)
                    if not watching.still_holds(session, stored, question):
                        logger.info("identification %d is judged again: baseline or limits were changed", stored.id)
                        return
                    watching.carry_out(session, stored, question, answer)
                    jobs.finish(row, state=jobs.DONE)
        except Exception as error:
            if concerns_all(error):
                raise  # it is tried again
            self._give_up(due, error)
        else:
            self._leave(due)

    def _give_up(self, due: Due, error: Exception) -> None:
        if is_damage(error):
            self._database.damage.concerns(due.machine_id)
        with self._database.transaction() as session:
            row = self._own(session, due.job_id)
            if row is not None:
                _tell(session, due, error)
                jobs.finish(row, state=jobs.DONE)
        self._leave(due)

    def _finish(self, due: Due) -> None:
        with self._database.transaction() as session:
            row = self._own(session, due.job_id)
            if row is not None:
                jobs.finish(row, state=jobs.DONE)
        self._leave(due)

    def _leave(self, due: Due) -> None:
        self._attempts.pop(due.job_id, None)
        machine = self._due[due.machine_id]
        machine.remove(due)
        if not machine:
            del self._due[due.machine_id]


def _tell(session: Session, due: Due, error: Exception) -> None:
    logger.error(
        "identification %d of %s is stored, but no alert follows from it",
        due.identification_id,
        due.machine_id,
        exc_info=error,
    )
    of, what = f"identification {due.identification_id}", "it is stored, but no alert follows from it"
    quarantine.add(session, [unexpected_error(error, of=of, machine_id=due.machine_id, what=what)])
