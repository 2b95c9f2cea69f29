"""Caches all machines by id until one is created or revised: their names stand in their documents, which are long."""

import threading
from bisect import bisect_right
from collections.abc import Sequence

from sqlalchemy.orm import Session

from storage.database.plant_scope import Plants, plants_of
from storage.machines import fleet
from storage.machines.fleet import ListedMachine
from storage.paging import Keys

MachineListStamp = tuple[int | None, ...]
MAXIMUM_LISTS = 32
"""Largest number of cached lists, one for each set of visible plants."""


class MachineList:
    """The machines of a store, as each session sees them."""

    def __init__(self) -> None:
        self._lists: dict[Plants | None, tuple[MachineListStamp, list[ListedMachine]]] = {}
        self._lock = threading.Lock()

    def page(self, session: Session, *, limit: int, after: Keys | None) -> Sequence[ListedMachine]:
        """Return machines by id, beginning behind the key `after`."""
        stamp, seen = fleet.stamp(session), plants_of(session)
        with self._lock:
            kept = self._lists.get(seen)
        machines = kept[1] if kept is not None and kept[0] == stamp else None
        if machines is None:
            machines = fleet.list_all(session)
            with self._lock:
                if len(self._lists) >= MAXIMUM_LISTS:
                    self._lists.clear()
                self._lists[seen] = stamp, machines
        begin = 0 if after is None else bisect_right(machines, str(after[0]), key=lambda one: one.id)
        return machines[begin : begin + limit]
