"""All machines by id, kept in memory until one is created or revised: their names stand in their documents, which are long."""

import threading
from bisect import bisect_right
from collections.abc import Sequence
from typing import Any

from sqlalchemy.orm import Session

from storage import fleet
from storage.clock import to_datetime
from storage.paging import Keys

Fields = dict[str, Any]


class MachineList:
    """The machines as `MachineSummary` has them, encoded without a model."""

    def __init__(self) -> None:
        self._stamp: tuple[int | None, ...] | None = None
        self._machines: list[Fields] = []
        self._lock = threading.Lock()

    def page(self, session: Session, *, limit: int, after: Keys | None) -> Sequence[Fields]:
        """Machines by id; after: the one before the first."""
        stamp = fleet.stamp(session)
        with self._lock:
            machines = self._machines if self._stamp == stamp else None
        if machines is None:
            machines = [_fields(one) for one in fleet.every(session)]
            with self._lock:
                self._stamp, self._machines = stamp, machines
        begin = 0 if after is None else bisect_right(machines, str(after[0]), key=lambda one: one["id"])
        return machines[begin : begin + limit]


def _fields(one: fleet.ListedMachine) -> Fields:
    return {
        "id": one.id,
        "plant": one.plant,
        "name": one.name,
        "revision": one.revision,
        "created_at": to_datetime(one.created_at),
    }
