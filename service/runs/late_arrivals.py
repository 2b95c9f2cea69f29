"""Record of late samples, and of how long more of them are awaited before they are sorted in."""

import time
from collections.abc import Collection

from numpy import int64
from numpy.typing import NDArray
from sqlalchemy.orm import Session

from service.runs.collection_state import CollectionState, standing, standings
from service.runs.late_samples import Window, add_late, remove_window
from storage.measurements import runs

LATE_PATIENCE_S = 10.0
"""Late samples are sorted in when no more of them have come for this long."""
LONGEST_LATE_PATIENCE = 10.0
"""Factor of the patience after which late samples are sorted in though more of them come."""


class LateArrivals:
    """Record of late samples, returned window by window. patience_s: how long more of them are awaited."""

    def __init__(self, *, patience_s: float) -> None:
        self._patience_s = patience_s
        self._heard: dict[str, tuple[float, float]] = {}
        """When the first and the last late sample came that are not sorted in."""
        self._settled: set[str] = set()
        """Machines without late samples."""

    def forget(self) -> None:
        """Forget when samples came, as after a start."""
        self._heard.clear()
        self._settled.clear()

    def look_again(self, machine_ids: Collection[str]) -> None:
        """Check again whether these machines have late samples."""
        self._settled.difference_update(machine_ids)

    def note(self, session: Session, machine_id: str, now: CollectionState, times: NDArray[int64]) -> None:
        """Note late samples in `now`; those within the open run are read when it is closed."""
        row = runs.current(session, machine_id)
        if row is not None:
            times = times[times < row.time_first]
        if times.size:
            moment = time.monotonic()
            first, _ = self._heard.get(machine_id, (moment, moment))
            self._heard[machine_id] = first, moment
            self._settled.discard(machine_id)
            now.late = add_late(now.late, now.revision, times.tolist())

    def may_wait(self, machine_id: str) -> bool:
        """Return whether late samples of a machine may wait to be sorted in."""
        return machine_id not in self._settled

    def note_settled(self, session: Session, machine_ids: Collection[str]) -> None:
        """Note which of these machines have no late samples."""
        known = standings(session, machine_ids)
        self._settled |= {one for one in machine_ids if one not in known or not known[one].late}

    def patience(self, session: Session, machine_id: str) -> float | None:
        """Return the time [s] for which late samples were awaited, once it is over; None while they still come, or without
        any."""
        now = standing(session, machine_id)
        if now is None or not now.late:
            self._settled.add(machine_id)
            return None
        moment = time.monotonic()
        first, last = self._heard.setdefault(machine_id, (moment, moment))
        if moment - last < self._patience_s and moment - first < LONGEST_LATE_PATIENCE * self._patience_s:
            return None
        del self._heard[machine_id]
        return self._patience_s

    def windows(self, session: Session, machine_id: str) -> list[Window]:
        """Return the windows of late samples of a machine that are not sorted in, ascending."""
        now = standing(session, machine_id)
        return [] if now is None else now.late

    def take(self, session: Session, machine_id: str, window: Window) -> bool:
        """Note that a window, one of `late_samples.by_run`, is sorted in; return False when more samples have come into it."""
        now = standing(session, machine_id)
        left = None if now is None else remove_window(now.late, window)
        if now is None or left is None:
            return False
        now.late = left
        runs.save_collector_state(session, machine_id, now.stored())
        return True
