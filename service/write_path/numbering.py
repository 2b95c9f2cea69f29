"""Numbering: which samples of a batch are new, duplicates, or fill sequence gaps, and the resulting state of the source's
row."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from sqlalchemy.orm import Session

from estimator.machine.document import Machine
from formats.wire import Fault, Rejected, SampleBatch
from service.resilience.bounded_dict import BoundedDict
from service.write_path import rejections, sequence_gaps
from service.write_path.batch import LARGEST_GAP, ArrivedBatch, StoreOutcome
from service.write_path.plausibility import Plausibility
from service.write_path.sequence_gaps import FilledPart, SequenceGap
from storage.encoding.sample_blocks import Samples
from storage.encoding.source_key import SourceKey
from storage.measurements import samples
from storage.measurements.quarantine import Rejection
from storage.tables.measurements import SourceRow


@dataclass
class Pending:
    """Samples, rejections and outcomes of one transaction, before it writes blocks."""

    parts: dict[SourceKey, list[Samples]] = field(default_factory=lambda: defaultdict(list))
    first: dict[SourceKey, int] = field(default_factory=dict)
    received_at: dict[SourceKey, int] = field(default_factory=dict)
    rejections: list[Rejection] = field(default_factory=list)
    outcomes: list[StoreOutcome] = field(default_factory=list)

    def add(self, arrived: ArrivedBatch, kept: Samples, *, first: int) -> None:
        """Add the accepted samples of a batch. first: number of the first of them."""
        self.parts[arrived.source].append(kept)
        self.first.setdefault(arrived.source, first)
        self.received_at[arrived.source] = arrived.received_at


class Numbering:
    """Numbering, conversion and checks of batches, in order of arrival."""

    def __init__(self) -> None:
        self._plausibility: BoundedDict[SourceKey, Plausibility] = BoundedDict()

    def forget(self) -> None:
        """Forget the state of the sources; all of it is in the store."""
        self._plausibility.clear()

    def add(self, session: Session, pending: Pending, arrived: ArrivedBatch, revision: int, machine: Machine) -> StoreOutcome:
        """Add the new samples of a batch to `pending`, and update the reception state in its source's row.

        Each sample is a duplicate, fills a gap that was counted as lost, or follows the samples so far.
        """
        batch, row = arrived.batch, samples.source(session, arrived.source)
        count = len(batch.time_ns)
        ahead = max(batch.sequence - row.next_sequence, 0)
        if ahead > LARGEST_GAP:
            detail = f"sequence {batch.sequence} does not follow {row.next_sequence}"
            pending.rejections.append(rejections.of_batch(arrived, "sequence_out_of_range", detail))
            return StoreOutcome(rejected=Rejected("sequence_out_of_range", detail))
        gaps = sequence_gaps.stored_gaps(row.missing)
        filling = sequence_gaps.filled_parts(gaps, first=batch.sequence, count=count)
        following = min(max(row.next_sequence - batch.sequence, 0), count)
        fresh = _not_stored(count, following, filling)
        known = int(np.count_nonzero(~fresh))
        row.duplicates += known
        if known == count:
            return StoreOutcome(duplicates=known)
        row.lost += ahead - sum(part.count for part in filling)
        try:
            in_si = arrived.converted(revision, machine)
        except Rejected as rejected:
            pending.rejections.append(rejections.of_batch(arrived, rejected.reason, rejected.detail))
            _advance(row, batch, gaps, filling, np.zeros(count, np.int64), np.zeros(count, dtype=bool), following)
            return StoreOutcome(duplicates=known, lost=ahead, rejected=rejected)
        converted, taken, faults = in_si.samples, in_si.taken & fresh, list(in_si.faults)
        faults += self._implausible(row, arrived.source, machine, converted, taken, filling, following)
        _advance(row, batch, gaps, filling, converted.time, taken, following)
        new = tuple(fault for fault in faults if fresh[fault.index])
        pending.rejections += rejections.of_samples(arrived, new)
        if taken.any():
            kept = converted.pick(taken)
            pending.add(arrived, kept, first=batch.sequence + int(np.flatnonzero(taken)[0]))
            row.received += len(kept)
            row.last_received_at = arrived.received_at
        return StoreOutcome(int(np.count_nonzero(taken)), known, ahead, new)

    def _implausible(
        self,
        row: SourceRow,
        source: SourceKey,
        machine: Machine,
        converted: Samples,
        taken: NDArray[np.bool_],
        filling: Sequence[FilledPart],
        following: int,
    ) -> list[Fault]:
        """Clear `taken` for samples that do not plausibly follow those around them; return the faults."""
        faults: list[Fault] = []
        for part in filling:
            around = Plausibility(time=part.gap.after, before=part.gap.before)
            faults += _check(around, machine, converted, taken, part.start, part.stop)
        latest = self._plausibility.setdefault(source, Plausibility(time=row.last_time))
        return faults + _check(latest, machine, converted, taken, following, taken.size)


def _not_stored(count: int, following: int, filling: Sequence[FilledPart]) -> NDArray[np.bool_]:
    """Return which samples of a batch are not stored yet: those from `following` on, and those that fill gaps."""
    fresh = np.arange(count) >= following
    for part in filling:
        fresh[part.start : part.stop] = True
    return fresh


def _check(
    known: Plausibility, machine: Machine, converted: Samples, taken: NDArray[np.bool_], start: int, stop: int
) -> list[Fault]:
    """Clear `taken` for implausible samples from `start` to before `stop` of a batch; return the faults."""
    here = np.zeros_like(taken)
    here[start:stop] = taken[start:stop]
    faults = known.check(machine, converted, here)
    taken[start:stop] = here[start:stop]
    return faults


def _advance(
    row: SourceRow,
    batch: SampleBatch,
    gaps: list[SequenceGap],
    filling: Sequence[FilledPart],
    time: NDArray[np.int64],
    taken: NDArray[np.bool_],
    following: int,
) -> None:
    """Update a source's row after a batch: filled gaps, a new gap before it, its newest number and time."""
    for part in filling:
        inside = slice(part.start, part.stop)
        gaps = sequence_gaps.fill(gaps, part, first=batch.sequence, times=time[inside][taken[inside]])
    new = time[following:][taken[following:]]
    if batch.sequence > row.next_sequence:
        before = int(new[0]) if new.size else sequence_gaps.NEVER
        gaps = sequence_gaps.add_gap(gaps, SequenceGap(row.next_sequence, batch.sequence - 1, row.last_time, before))
    if filling or batch.sequence > row.next_sequence:
        row.missing = sequence_gaps.as_stored(gaps)
    row.next_sequence = max(row.next_sequence, batch.sequence + taken.size)
    if new.size:
        row.last_time = int(new[-1])
