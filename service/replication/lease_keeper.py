"""The thread that keeps this process registered among the replicas on one database, with a fair share of the work."""

import logging
import math
import os
import socket
from collections.abc import Collection

from sqlalchemy.exc import DBAPIError
from sqlalchemy.orm import Session

from service.configuration.settings import ProcessRole
from service.replication.work_share import DELIVERY, GATHERING, INGEST, RETENTION, lease_of
from service.resilience.supervised_thread import SupervisedThread
from storage.database.engine import Database
from storage.findings import jobs
from storage.operation import leases, replicas

logger = logging.getLogger(__name__)

ROUND_S = 2.0
"""Interval of heartbeats and of checks of the other replicas."""


class LeaseKeeper(SupervisedThread):
    """A replica, as a `Share`. Its share is that of the last round; `require` checks it for certain."""

    def __init__(self, database: Database, role: ProcessRole) -> None:
        super().__init__(
            "leasing", failure="this replica's heartbeat cannot be stored", retry_s=ROUND_S, first_pause_s=ROUND_S
        )
        self._database = database
        self._role = role
        self._number: int | None = None
        self._held: frozenset[str] = frozenset()
        self._changes = 0

    def start(self) -> None:
        """Register among the replicas, with a first share."""
        self._round()
        super().start()

    def stop(self) -> None:
        """Deregister; what was held is free at once."""
        super().stop()
        if self._number is not None:
            try:
                with self._database.transaction() as session:
                    _release_dead(session, self._number)
            except DBAPIError as error:
                logger.warning(
                    "the other replicas could not be notified of this shutdown; they will detect it: %s", error.orig
                )

    @property
    def holder(self) -> int | None:
        """Return the number of this replica, see `Share`."""
        return self._number

    @property
    def changes(self) -> int:
        """Return how often the share has changed, see `Share`."""
        return self._changes

    def is_owner(self, machine_id: str) -> bool:
        """Return whether this replica stores a machine's samples, see `Share`."""
        return lease_of(machine_id) in self._held

    def is_leader(self, work: str) -> bool:
        """Return whether this replica does this work for all, see `Share`."""
        return work in self._held

    def require(self, session: Session, machine_ids: Collection[str]) -> None:
        """Raise LeaseLost unless these machines are this replica's, see `Share`."""
        leases.require(session, {lease_of(one) for one in machine_ids}, holder=self._number or 0)

    def run_once(self) -> float:
        """Do a round."""
        self._round()
        return ROUND_S

    def _round(self) -> None:
        """Send a heartbeat, remove dead replicas, and take or release leases so that the shares are fair."""
        alive = self._number is not None and self._beat(self._number)
        with self._database.transaction() as session:
            joined = not alive
            number = self._join(session) if joined or self._number is None else self._number
            left = jobs.requeue_running(session, living=[row.id for row in replicas.list_all(session)])
            if left:
                logger.warning("%d identifications were left by replicas that are gone; they are computed again", left)
            for row in replicas.expired(session, me=number):
                logger.warning("replica %d (%s on %s) is gone; its work is taken over", row.id, row.role, row.host)
                _release_dead(session, row.id)
            held = self._balance_leases(session, number)
        if joined:
            logger.info("this process is replica %d, role %s", number, self._role)
        if joined or held != self._held:
            self._number, self._held = number, held
            self._changes += 1

    def _beat(self, number: int) -> bool:
        """Send a heartbeat, independently of the rest of the round; return False when the replica must register again."""
        # Again, should the connection have broken.
        if not self._database.hold_lock(replicas.LOCK_CLASS, number):
            return False
        with self._database.transaction(beside_others=True) as session:
            return replicas.heartbeat(session, number)

    def _join(self, session: Session) -> int:
        number = replicas.join(session, role=self._role, host=socket.gethostname(), process=os.getpid())
        self._database.hold_lock(replicas.LOCK_CLASS, number)
        leases.ensure(session, [*INGEST, DELIVERY, GATHERING, RETENTION])
        session.flush()
        return number

    def _balance_leases(self, session: Session, number: int) -> frozenset[str]:
        held = leases.held(session, holder=number)
        roles = [row.role for row in replicas.list_all(session)]
        for role, names in (("ingest", INGEST), ("identify", (DELIVERY, GATHERING, RETENTION))):
            mine = sorted(held & set(names))
            sharing = sum(other in (role, "all") for other in roles)
            fair = math.ceil(len(names) / sharing) if self._role in (role, "all") else 0
            if surplus := mine[fair:]:
                leases.release(session, surplus, holder=number)
                held -= set(surplus)
            elif len(mine) < fair:
                held |= leases.acquire(session, names, holder=number, most=fair - len(mine))
        return frozenset(held)


def _release_dead(session: Session, number: int) -> None:
    """Remove a replica, freeing its leases and its jobs."""
    leases.release_all(session, holder=number)
    for row in jobs.held_by(session, number):
        jobs.requeue_uncounted(row)
    replicas.forget(session, number)
