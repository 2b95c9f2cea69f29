"""Recalls that have to wait: until a source's samples are accepted again, or until its silent log is asked again."""

from service.resilience.backoff import Backoff
from service.resilience.bounded_dict import BoundedDict
from storage.encoding.source_key import SourceKey


class PostponedRecalls:
    """Sources whose gaps are still to be requested, and logs that are given time."""

    def __init__(self) -> None:
        self._sources: BoundedDict[SourceKey, None] = BoundedDict()
        self._silent = Backoff[SourceKey]()
        """Logs that did not reply to a request for gaps, though they reply otherwise."""

    def add(self, source: SourceKey) -> None:
        """Note that a source's gaps are to be requested."""
        self._sources[source] = None

    def remove(self, source: SourceKey) -> None:
        """Note that a source's gaps are requested."""
        self._sources.pop(source, None)

    def is_due(self, source: SourceKey) -> bool:
        """Return whether a source's gaps are to be requested now."""
        return source in self._sources and self._silent.is_due(source)

    def failed(self, source: SourceKey) -> None:
        """Give a log time that did not reply, though it replies otherwise: it may have been delayed."""
        self._silent.failed(source)
        self.add(source)

    def succeeded(self, source: SourceKey) -> None:
        """Note that a log replied."""
        self._silent.succeeded(source)
