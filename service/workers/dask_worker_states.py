"""States of a Dask cluster's workers: which get no tasks at present, and why.

A worker gets none while the scheduler hears nothing of it, when it is of another release, and for a while after a refusal.
"""

import threading
import time
from collections.abc import Mapping
from typing import Any

from service.workers import dask_task
from service.workers.executor import TaskRefused

SILENT_S = 30.0
"""Time after which a worker unheard by the scheduler counts as frozen."""
REFUSED_S = 60.0
"""Time for which a worker that refused a task gets none."""


class DaskWorkerStates:
    """States of the workers, each by its address. `refuse` is called from threads of Dask's."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._seen: dict[str, tuple[float, float]] = {}
        """Per worker, the time of its last sign of life by the scheduler's clock, and since when that has not changed."""
        self._refused: dict[str, tuple[str, float]] = {}
        """Per worker that refused a task, why, and until when it gets none."""

    def observe(self, workers: Mapping[str, Any]) -> None:
        """Note the signs of life of the workers that the scheduler has, as it reports them."""
        now, before, self._seen = time.monotonic(), self._seen, {}
        for address, one in workers.items():
            heard, since = before.get(address, (None, now))
            self._seen[address] = one["last_seen"], since if one["last_seen"] == heard else now

    def silent(self) -> dict[str, str]:
        """Return the silent workers, with a text that says so."""
        since = time.monotonic() - SILENT_S
        silent = [address for address, (_, at) in self._seen.items() if at < since]
        return {address: f"the Dask worker at {address} has said nothing for {SILENT_S:.0f} s or longer" for address in silent}

    def unusable(self, workers: Mapping[str, Any]) -> dict[str, str]:
        """Return those of the scheduler's workers that get no tasks now, and why."""
        now = time.monotonic()
        found = {
            address: _release_mismatch(address, dask_task.release_of(str(one["name"]))) for address, one in workers.items()
        }
        with self._lock:
            self._refused = {address: one for address, one in self._refused.items() if address in workers and one[1] > now}
            found |= {address: words for address, (words, _) in self._refused.items()}
        return {address: words for address, words in found.items() if words} | self.silent()

    def refuse(self, address: str, release: str) -> TaskRefused:
        """Note that a worker refused a task, and return the error of the task. release: the worker's."""
        words = _release_mismatch(address, release) or f"the Dask worker at {address} refuses its tasks"
        with self._lock:
            self._refused[address] = words, time.monotonic() + REFUSED_S
        return TaskRefused(words)


def _release_mismatch(address: str, release: str | None) -> str:
    """Return the objection to a worker's release; an empty text when there is none."""
    ours = dask_task.RELEASE
    if release is None:
        return f"the Dask worker at {address} does not say its release: start it as `rundown worker` of release {ours}"
    if release != ours:
        return f"the Dask worker at {address} runs release {release}, this service {ours}: upgrade the older one"
    return ""
