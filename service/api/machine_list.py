"""All machines by id, kept in memory until one is created or revised: their names stand in their documents, which are long."""

import threading
from bisect import bisect_right
from collections.abc import Sequence

from sqlalchemy.orm import Session

from storage import fleet
from storage.fleet import ListedMachine
from storage.paging import Keys


class MachineList:
    """The machines of a store."""

    def __init__(self) -> None:
        self._stamp: tuple[int | None, ...] | None = None
        self._machines: list[ListedMachine] = []
        self._lock = threading.Lock()

    def page(self, session: Session, *, limit: int, after: Keys | None) -> Sequence[ListedMachine]:
        """Machines by id; after: the one before the first."""
        stamp = fleet.stamp(session)
        with self._lock:
            machines = self._machines if self._stamp == stamp else None
        if machines is None:
            machines = fleet.every(session)
            with self._lock:
                self._stamp, self._machines = stamp, machines
        begin = 0 if after is None else bisect_right(machines, str(after[0]), key=lambda one: one.id)
        return machines[begin : begin + limit]
