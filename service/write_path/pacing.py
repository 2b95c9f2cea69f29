"""Pacing of the ingest: a short pause after each small step, so that no request waits for a whole cycle.

Threads of one interpreter take turns. Without pauses, each turn of a thread that computes an answer waits for one of the
ingest's, and the slowest answers take several times as long.
"""

import time
from collections.abc import Iterator
from contextlib import contextmanager

PAUSE_S = 0.0005
LONGEST_S = 0.05
"""Longest total of a cycle's pauses: half of the time between two cycles."""
LONGEST_IN_TRANSACTION_S = 0.004
"""Longest total within one transaction: on a busy machine a short pause may last 20 ms, and other writers wait."""


class Pacing:
    """Pauses of the ingest, limited in total per cycle."""

    def __init__(self) -> None:
        self._left_s = 0.0
        self.paused_s = 0.0
        """Total of all pauses."""

    def begin(self, *, without_pauses: bool) -> None:
        """Begin a cycle. without_pauses: whether to store at full speed, as while there is a backlog."""
        self._left_s = 0.0 if without_pauses else LONGEST_S

    def pause(self) -> None:
        """Pause after a step, if the cycle still has time for it; a pause counts by its actual length."""
        if self._left_s > 0.0:
            began = time.monotonic()
            time.sleep(PAUSE_S)
            lasted = time.monotonic() - began
            self._left_s -= lasted
            self.paused_s += lasted

    @contextmanager
    def in_transaction(self) -> Iterator[None]:
        """Limit the pauses within one transaction further."""
        before = self._left_s
        self._left_s = allowed = min(before, LONGEST_IN_TRANSACTION_S)
        try:
            yield
        finally:
            self._left_s = before - (allowed - self._left_s)
