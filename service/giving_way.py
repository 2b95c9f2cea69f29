"""Pacing of the ingest: a short pause after each small step, so that no request waits for a whole cycle of it.

Threads of one interpreter take turns. Without pauses every turn of an answer that is being made meanwhile waits for one of
the ingest's, and the slowest answers take several times as long.
"""

import time

PAUSE_S = 0.0005
LONGEST_S = 0.05
"""All pauses of a cycle together: half of the time between two."""


class Pacing:
    """Count the pauses of a cycle."""

    def __init__(self) -> None:
        self._left = 0

    def begin(self, *, hurried: bool) -> None:
        """Begin a cycle. hurried: without pauses, while there is a backlog."""
        self._left = 0 if hurried else round(LONGEST_S / PAUSE_S)

    def pause(self) -> None:
        """Pause after a step, if the cycle still has time for it."""
        if self._left > 0:
            self._left -= 1
            time.sleep(PAUSE_S)
