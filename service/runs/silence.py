"""Ending the runs of silent machines, in short transactions: samples of others wait meanwhile."""

import logging
import time
from collections.abc import Callable, Collection, Set

from sqlalchemy.orm import Session

from service.replication.work_share import Share
from service.resilience.backoff import Backoff
from service.resilience.internal_errors import unexpected_error
from service.runs.collector import Collector
from storage.database.damage import is_damage
from storage.database.engine import Database
from storage.database.errors import is_database_wide
from storage.machines import machines
from storage.measurements import quarantine

logger = logging.getLogger(__name__)

AT_ONCE = 500
"""Machines that are checked together."""
LONGEST_TRANSACTION_S = 0.03
"""Time after which no further machine is added to a transaction that ends runs."""
LONGEST_ENDING_S = 0.1
"""Time after which further machines are left for the next call: samples wait."""


class _Damaged(Exception):
    """The stored data of a machine cannot be read."""

    def __init__(self, machine_id: str) -> None:
        super().__init__(machine_id)
        self.machine_id = machine_id


class SilentMachines:
    """Ending of the runs of silent machines. For the ingest thread only."""

    def __init__(self, database: Database, collector: Collector, share: Share) -> None:
        self._database = database
        self._collector = collector
        self._share = share
        self._backoff = Backoff[str]()

    def end_runs(self, *, silence_s: float, alive: Set[str]) -> None:
        """End the runs of as many silent machines as time allows; the others follow in the next call.

        A failure with one machine does not block the others; it is retried, after a longer pause each time. alive: machines
        with a connected source.
        """

        def is_due(machine_id: str) -> bool:
            silent = self._collector.has_fallen_silent(machine_id, silence_s=silence_s, alive=machine_id in alive)
            return silent and self._backoff.is_due(machine_id)

        due = self._without_idle(is_due)
        ends = time.monotonic() + LONGEST_ENDING_S
        while due and time.monotonic() < ends:
            due = self._end_first(due)

    def _without_idle(self, is_due: Callable[[str], bool]) -> list[str]:
        """Return the due machines, without those that need no action."""
        with self._database.reading() as session:
            due = [one for one in machines.list_ids(session) if self._share.is_owner(one) and is_due(one)]
        for first in range(0, len(due), AT_ONCE):
            self._note_idle(due[first : first + AT_ONCE])
        return list(filter(is_due, due))

    def _note_idle(self, machine_ids: Collection[str]) -> None:
        """Note which machines are idle; when the joint query fails, each is checked alone."""
        try:
            with self._database.reading() as session:
                self._collector.note_idle(session, machine_ids)
        except Exception as error:
            if is_database_wide(error):
                raise
            logger.warning(
                "%d machines cannot be checked together; they are checked one by one", len(machine_ids), exc_info=error
            )

    def _end_first(self, due: list[str]) -> list[str]:
        """End the runs of the first of these machines in one short transaction; return those that are left."""
        left = list(due)
        done: list[str] = []
        try:
            with self._collector.lock, self._database.transaction(beside_others=True) as session:
                self._share.require(session, due)
                ends = time.monotonic() + LONGEST_TRANSACTION_S
                while left and (not done or time.monotonic() < ends):
                    done.append(left.pop(0))
                    self._end(session, done[-1])
        except _Damaged as error:
            # After damage, SQLite accepts nothing more in a transaction: the others are ended in another one.
            pause = self._backoff.failed(error.machine_id, at_once=True)
            self._database.damage.record_machine(error.machine_id)
            logger.error("%s: its run cannot be ended; tried again in %.0f s", error.machine_id, pause)
            self._collector.recheck(done)
            return [one for one in due if one != error.machine_id]
        except BaseException:
            self._collector.recheck(done)
            raise
        return left

    def _end(self, session: Session, machine_id: str) -> None:
        """End the run of one machine in a savepoint, so that a failure does not affect the others."""
        try:
            with session.begin_nested():
                self._collector.end_silent(session, machine_id)
        except Exception as error:
            if is_database_wide(error):
                raise
            if is_damage(error):
                raise _Damaged(machine_id) from error
            pause = self._backoff.failed(machine_id)
            self._collector.recheck([machine_id])
            logger.exception("%s: its run cannot be ended; tried again in %.0f s", machine_id, pause)
            what = "its run cannot be ended"
            quarantine.add(session, [unexpected_error(error, of=f"runs of {machine_id}", machine_id=machine_id, what=what)])
        else:
            self._backoff.succeeded(machine_id)
