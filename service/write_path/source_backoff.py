"""Backoff of sources of which nothing can be stored repeatedly: their batches are left in their logs for a while.

The write batch and gap recovery both report failures here, and both keep state of a source that must be dropped when it is
paused: they register for that, and need not know each other.
"""

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from service.resilience.backoff import Backoff
from storage.database.errors import is_database_wide
from storage.encoding.source_key import SourceKey

logger = logging.getLogger(__name__)

FREE_FAILURES = 2
"""Unexpected errors in a row that a source may cause before it is paused."""


class SourceBackoff:
    """Decision which sources' batches are accepted now. For the ingest thread only."""

    def __init__(self) -> None:
        self._backoff = Backoff[SourceKey](free=FREE_FAILURES)
        self._on_pause: list[Callable[[SourceKey], None]] = []

    def call_on_pause(self, drop: Callable[[SourceKey], None]) -> None:
        """Register a callback that drops the state of a source when it is paused."""
        self._on_pause.append(drop)

    def accepts(self, source: SourceKey) -> bool:
        """Return whether a source's batches are accepted now."""
        return self._backoff.is_due(source)

    def failures(self, source: SourceKey) -> int:
        """Return the number of a source's failures in a row."""
        return self._backoff.failures(source)

    def failed(self, source: SourceKey, *, at_once: bool = True) -> None:
        """Count a failure, and pause the source so that it does not delay all others; its log keeps its batches.

        at_once: pause it even if the failure would be free.
        """
        pause = self._backoff.failed(source, at_once=at_once)
        if pause:
            words = "%s, source %s: nothing could be stored again; it is left to its log for %.0f s"
            logger.error(words, source.machine_id, source.source, pause)
            for drop in self._on_pause:
                drop(source)

    def succeeded(self, source: SourceKey) -> None:
        """Reset a source's failures, unless it is paused: then the stored batch was held since before the pause."""
        if self._backoff and self._backoff.is_due(source):
            self._backoff.succeeded(source)

    @contextmanager
    def pausing_on_error(self, source: SourceKey) -> Iterator[None]:
        """Pause a source when an unexpected error occurs in the block: the error concerns this source alone."""
        try:
            yield
        except Exception as error:
            if is_database_wide(error):
                raise
            logger.exception("%s, source %s: its log cannot be asked", source.machine_id, source.source)
            self.failed(source)
