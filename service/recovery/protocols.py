"""Protocols of the parts that gap recovery relies on, besides `Share` and `SourceBackoff`.

Recovery queries sources' logs and decides in which order batches are accepted; it neither decodes, nor reads the database, nor
stores anything itself.
"""

from collections.abc import Sequence
from typing import Protocol

import zenoh

from formats.wire import Key
from service.write_path.batch import ArrivedBatch
from service.write_path.sequence_gaps import SequenceGap
from storage.encoding.source_key import SourceKey


class BatchSink(Protocol):
    """Acceptance of batches in the order in which they are to be stored: the write batch."""

    def next_sequence(self, source: SourceKey) -> int:
        """Return the number of the next sample of a source, accepted ones included. Raises the database's errors."""

    def take(self, arrived: ArrivedBatch) -> None:
        """Hold a batch for storing."""


class GapRecords(Protocol):
    """Record of the numbers of a source that were counted as lost: the sample writer."""

    def sequence_gaps(self, source: SourceKey) -> Sequence[SequenceGap]:
        """Return the gaps in a source's numbers, ascending. Raises the database's errors."""


class ReplyReader(Protocol):
    """Decoder of the replies of a source's log: admission."""

    def replied(self, key: Key, reply: zenoh.Sample) -> ArrivedBatch | None:
        """Return a reply as a batch; None when it is rejected or has to wait."""
