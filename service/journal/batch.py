"""A batch on its way to the store, and the outcome of storing it."""

from concurrent.futures import Future
from dataclasses import dataclass
from functools import cached_property

from service.wire import Fault, Rejected, SampleBatch, source_key
from storage.encoding.source_key import SourceKey

LARGEST_GAP = 1_000_000_000
"""A sequence number further ahead than this is an error, not a gap."""


@dataclass(frozen=True)
class ArrivedBatch:
    """A batch as it arrived: its key, payload and time of arrival [ns]."""

    batch: SampleBatch
    key: str
    payload: bytes
    received_at: int

    @cached_property
    def source(self) -> SourceKey:
        """Return the source that sent it."""
        return source_key(self.batch)

    @property
    def end(self) -> int:
        """Return the number of the sample behind its last one."""
        return self.batch.sequence + len(self.batch.time_ns)


@dataclass(frozen=True)
class StoreOutcome:
    """Outcome of storing a batch: number of samples stored, of duplicates and of those missing before it; faults and
    rejection."""

    received: int = 0
    duplicates: int = 0
    lost: int = 0
    faults: tuple[Fault, ...] = ()
    rejected: Rejected | None = None


@dataclass(frozen=True)
class HeldBatch:
    """A batch that is held for storing, and the promise to whoever waits for its outcome."""

    arrived: ArrivedBatch
    promise: Future[StoreOutcome] | None = None

    @property
    def source(self) -> SourceKey:
        """Return the source that sent it."""
        return self.arrived.source
