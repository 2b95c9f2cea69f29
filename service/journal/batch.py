"""A batch on its way to the store, and what became of it."""

from concurrent.futures import Future
from dataclasses import dataclass
from functools import cached_property

from service.wire import Fault, Rejected, SampleBatch, source_key
from storage.measurements.samples import SourceKey

LARGEST_GAP = 1_000_000_000
"""A sequence number this far ahead is a wrong number, not a gap."""


@dataclass(frozen=True)
class ArrivedBatch:
    """A batch as it came: its key, payload and time of arrival [ns]."""

    batch: SampleBatch
    key: str
    payload: bytes
    received_at: int

    @cached_property
    def source(self) -> SourceKey:
        """The source that sent it."""
        return source_key(self.batch)

    @property
    def end(self) -> int:
        """Number of the sample behind its last one."""
        return self.batch.sequence + len(self.batch.time_ns)


@dataclass(frozen=True)
class StoreOutcome:
    """Samples stored, stored before, and missing just before a batch; what of it was not taken and why."""

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
        """The source that sent it."""
        return self.arrived.source
