"""Protocols of those on whom gap recovery relies, besides `Share` and `SourceBackoff`.

Recovery asks sources' logs and decides what is taken in which order; it neither decodes, nor looks into the database, nor
stores anything itself.
"""

from collections.abc import Sequence
from typing import Protocol

import zenoh

from service.journal.batch import ArrivedBatch
from service.journal.sequence_gaps import SequenceGap
from service.wire import Key
from storage.measurements.samples import SourceKey


class BatchSink(Protocol):
    """Takes batches in the order in which they are to be stored: the write batch."""

    def next_sequence(self, source: SourceKey) -> int:
        """Return the number of the next sample of a source, what is taken included. Raises what the database raises."""

    def take(self, arrived: ArrivedBatch) -> None:
        """Hold a batch for storing."""


class GapRecords(Protocol):
    """Remembers which numbers of a source were counted as lost: the journal."""

    def sequence_gaps(self, source: SourceKey) -> Sequence[SequenceGap]:
        """Return the numbers of a source that never came, ascending. Raises what the database raises."""


class ReplyReader(Protocol):
    """Decodes what a source's log answers: admission."""

    def replied(self, key: Key, reply: zenoh.Sample) -> ArrivedBatch | None:
        """Return a reply as a batch; None when it is rejected or has to wait."""
