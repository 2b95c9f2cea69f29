"""Ingest gives way: it pauses for a moment after each small step, so that nobody who asks waits for a whole cycle of it.

Threads of one interpreter take turns. Without pauses every turn of an answer that is being made meanwhile waits for one of
the ingest's, and the slowest answers take several times as long.
"""

import time

PAUSE_S = 0.0005
LONGEST_S = 0.05
"""All pauses of a cycle together: half of the time between two."""


class GivingWay:
    """Called after each step. hurried: without any pause, while there is a backlog."""

    def __init__(self) -> None:
        self._left = 0

    def begin(self, *, hurried: bool) -> None:
        """A cycle begins."""
        self._left = 0 if hurried else round(LONGEST_S / PAUSE_S)

    def __call__(self) -> None:
        """Pause, if there is still time for it."""
        if self._left > 0:
            self._left -= 1
            time.sleep(PAUSE_S)
