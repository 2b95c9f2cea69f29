"""A batch on its way to the store, and the outcome of storing it."""

from concurrent.futures import Future
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from estimator.machine.document import Machine
from formats.wire import Fault, Rejected, SampleBatch, source_key, to_samples
from storage.encoding.sample_blocks import Samples
from storage.encoding.source_key import SourceKey

LARGEST_GAP = 1_000_000_000
"""A sequence number further ahead than this is an error, not a gap."""


@dataclass(frozen=True)
class ConvertedBatch:
    """A batch in SI, by one revision of its machine's document: samples, which of them are accepted (S,), and every fault."""

    revision: int
    samples: Samples
    taken: NDArray[np.bool_]
    faults: list[Fault]


@dataclass(frozen=True)
class ArrivedBatch:
    """A batch as it arrived: its key, payload and time of arrival [ns]."""

    batch: SampleBatch
    key: str
    payload: bytes
    received_at: int
    _conversion: list[ConvertedBatch] = field(default_factory=list, compare=False, repr=False)
    """The last conversion, if any: it is made before the transaction that stores the batch."""

    @cached_property
    def source(self) -> SourceKey:
        """Return the source that sent it."""
        return source_key(self.batch)

    def converted(self, revision: int, machine: Machine) -> ConvertedBatch:
        """Return the batch in SI by a revision of the document; the last conversion is kept. Raises Rejected."""
        for kept in self._conversion:
            if kept.revision == revision:
                return kept
        found = ConvertedBatch(revision, *to_samples(self.batch, machine, received_at=self.received_at))
        self._conversion[:] = [found]
        return found

    def is_converted(self, revision: int) -> bool:
        """Return whether `converted` has nothing to do by a revision of the document."""
        return any(kept.revision == revision for kept in self._conversion)

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
