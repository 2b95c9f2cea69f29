"""Record of the sources whose logs reply, and of the logs that are silent at present."""

import math
import time

from service.resilience.bounded_dict import BoundedDict
from storage.encoding.source_key import SourceKey

SILENCE_S = 10.0
"""Time for which gaps of a source without a replying log are counted as lost at once.

For a live source they are requested then.
"""


class KnownLogs:
    """Record of the replies of sources' logs."""

    def __init__(self) -> None:
        self._answering: BoundedDict[SourceKey, bool] = BoundedDict()
        self._silent_until: BoundedDict[SourceKey, float] = BoundedDict()

    def note_answer(self, source: SourceKey) -> None:
        """Note that a source's log has replied."""
        self._answering[source] = True

    def has_answered(self, source: SourceKey) -> bool:
        """Return whether a source's log has ever replied."""
        return source in self._answering

    def note_silence(self, source: SourceKey) -> None:
        """Note that a source's log does not reply."""
        self._silent_until[source] = time.monotonic() + SILENCE_S

    def is_silent(self, source: SourceKey) -> bool:
        """Return whether a source's log did not reply a short time ago."""
        return self._silent_until.get(source, 0.0) > time.monotonic()

    def end_silence(self, source: SourceKey) -> bool:
        """Forget a source's silence when it has lasted long enough; return whether there was one."""
        if self._silent_until.get(source, math.inf) > time.monotonic():
            return False
        del self._silent_until[source]
        return True

    def forget_silences(self) -> None:
        """Forget which logs did not reply."""
        self._silent_until.clear()
