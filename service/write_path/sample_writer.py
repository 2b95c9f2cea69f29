"""Sample writer: batches become stored samples, each exactly once, together with all consequences.

One call of `store` is one transaction: sample blocks, reception state of each source, run collection, quarantine. A restart
therefore finds all of it or none of it.
"""

import contextlib
import logging
import math
import time
from collections import defaultdict
from collections.abc import Set
from typing import Any

import numpy as np
from sqlalchemy.orm import Session

from estimator.machine.document import Machine
from formats.wire import Rejected, SourceReceived
from service.replication.work_share import Share, WholeShare
from service.runs.collector import Collector
from service.runs.silence import SilentMachines
from service.write_path.batch import ArrivedBatch, StoreOutcome
from service.write_path.numbering import Numbering, Pending
from service.write_path.pacing import Pacing
from service.write_path.sequence_gaps import SequenceGap, stored_gaps
from storage.database.engine import Database
from storage.encoding.sample_blocks import Samples, join
from storage.encoding.source_key import SourceKey
from storage.machines import machines
from storage.measurements import quarantine, runs, samples
from storage.measurements.quarantine import Rejection

logger = logging.getLogger(__name__)

Documents = dict[str, tuple[int, Machine]]
"""Revision in force and document of each machine."""


class SampleWriter:
    """Writer of the batches that arrive. Not for concurrent use by several threads."""

    def __init__(self, database: Database, collector: Collector, share: Share | None = None) -> None:
        self._database = database
        self._collector = collector
        self._share = share or WholeShare()
        self._numbering = Numbering()
        self._silent_machines = SilentMachines(database, collector, self._share)
        self._plants: dict[str, str] = {}
        self._documents: Documents = {}
        self.pacing = Pacing()

    def next_sequence(self, source: SourceKey) -> int:
        """Return the number of the next sample expected from a source; 0 for an unknown source."""
        with self._database.reading() as session:
            return samples.source(session, source).next_sequence

    def newest_receipt(self) -> int:
        """Return when the newest samples came, by this machine's clock at that time [ns]; 0 before any."""
        with self._database.reading() as session:
            return samples.newest_receipt(session) or 0

    def note_activity(self, machine_id: str) -> None:
        """Note that a machine's source sends, though nothing is accepted now: the machine is not silent."""
        self._collector.note_activity(machine_id)

    def sequence_gaps(self, source: SourceKey) -> list[SequenceGap]:
        """Return the gaps in a source's numbers, ascending, as far as they are recorded."""
        with self._database.reading() as session:
            return stored_gaps(samples.source(session, source).missing)

    def received(self, machine_id: str) -> list[SourceReceived]:
        """Return how far each source of a machine is durable."""
        with self._database.reading() as session:
            return [
                SourceReceived(
                    source=row.source,
                    epoch=row.epoch,
                    next_sequence=row.next_sequence,
                    received=row.received,
                    duplicates=row.duplicates,
                    lost=row.lost,
                )
                for row in samples.sources(session, machine_id)
            ]

    def plant_of(self, machine_id: str) -> str | None:
        """Return the plant of a machine, which never changes; None when the machine is unknown."""
        if machine_id not in self._plants:
            with self._database.reading() as session:
                try:
                    self._plants[machine_id] = machines.get(session, machine_id).plant
                except machines.MachineUnknown:
                    return None
        return self._plants[machine_id]

    def require_convertible(self, arrived: ArrivedBatch) -> None:
        """Raise Rejected for a batch of which no sample can be accepted, or whose source's clock is wrong."""
        with self._database.reading() as session:
            known = self._document(session, arrived.batch.machine)
        wrong = [fault for fault in arrived.converted(*known).faults if fault.reason == "time_out_of_range"]
        if len(wrong) == len(arrived.batch.time_ns):
            raise Rejected(wrong[0].reason, f"{wrong[0].detail}, and so with all others: set the source's clock")

    def store(
        self, arrived: list[ArrivedBatch], rejections: list[Rejection], *, within_s: float = math.inf
    ) -> list[StoreOutcome]:
        """Store batches, in order, and rejections; return the outcome of each batch.

        Raises the database's errors, and LeaseLost for machines that belong to another replica by now; then nothing was
        stored. within_s: after this time [s], pauses aside, no further batch is added, and the outcomes of fewer are returned;
        at least one batch is stored.
        """
        _convert(arrived, self._documents, self.pacing)
        try:
            with self._collector.lock, self._database.transaction(beside_others=True) as session:
                self._share.require(session, {one.batch.machine for one in arrived})
                with self.pacing.in_transaction():
                    return self._store(session, arrived, rejections, within_s=within_s)
        except BaseException:
            self._numbering.forget()  # it may know of samples that were not stored
            raise

    def end_silent(self, *, silence_s: float, alive: Set[str] = frozenset()) -> None:
        """End runs of machines that have fallen silent. alive: machines with a connected source."""
        self._silent_machines.end_runs(silence_s=silence_s, alive=alive)

    def forget(self) -> None:
        """Forget all state that other processes may have changed; all of it is in the store."""
        self._numbering.forget()
        self._collector.forget()

    def _document(self, session: Session, machine_id: str) -> tuple[int, Machine]:
        """Return the revision in force and its document, which is parsed once."""
        revision = machines.get(session, machine_id).revision
        known = self._documents.get(machine_id)
        if known is None or known[0] != revision:
            known = self._documents[machine_id] = revision, machines.document(session, machine_id, revision)
        return known

    def _store(
        self, session: Session, arrived: list[ArrivedBatch], rejections: list[Rejection], *, within_s: float
    ) -> list[StoreOutcome]:
        pending = Pending(rejections=list(rejections))
        documents: Documents = {}
        ends = time.monotonic() - self.pacing.paused_s + within_s
        loaded = _load(session, arrived)
        self.pacing.pause()
        for one in arrived:
            if pending.outcomes and time.monotonic() - self.pacing.paused_s > ends:
                break
            machine_id = one.batch.machine
            if machine_id not in documents:
                documents[machine_id] = self._document(session, machine_id)
            pending.outcomes.append(self._numbering.add(session, pending, one, *documents[machine_id]))
        added = self._add_blocks(session, pending, documents)
        _collect(session, added, documents, collector=self._collector, pacing=self.pacing)
        if pending.rejections:
            quarantine.add(session, pending.rejections)
        del loaded
        return pending.outcomes

    def _add_blocks(self, session: Session, pending: Pending, documents: Documents) -> dict[str, list[Samples]]:
        """Add a block for each source and count its late samples; return the samples of each machine."""
        added: dict[str, list[Samples]] = defaultdict(list)
        blocks: list[dict[str, Any]] = []
        for source, parts in pending.parts.items():
            revision, machine = documents[source.machine_id]
            joined = join(parts, channels=len(machine.probes))
            blocks.append(
                samples.block_row(
                    source,
                    revision=revision,
                    first_sequence=pending.first[source],
                    samples=joined,
                    received_at=pending.received_at[source],
                )
            )
            self.pacing.pause()
            added[source.machine_id].append(joined)
            late = int(np.count_nonzero(joined.time <= self._collector.seen(session, source.machine_id)))
            if late:
                samples.source(session, source).late += late
                logger.warning("%s: %d samples are older than what is known; they are sorted in", source.machine_id, late)
        session.flush()
        samples.add_blocks(session, blocks)
        return added


def _convert(arrived: list[ArrivedBatch], documents: Documents, pacing: Pacing) -> None:
    """Convert batches of known machines before the transaction that stores them: others need not wait for that."""
    for one in arrived:
        if (known := documents.get(one.batch.machine)) is not None and not one.is_converted(known[0]):
            with contextlib.suppress(Rejected):  # raised again where it is stored
                one.converted(*known)
            pacing.pause()


def _collect(
    session: Session, added: dict[str, list[Samples]], documents: Documents, *, collector: Collector, pacing: Pacing
) -> None:
    """Pass the added samples to run collection, ordered by time."""
    for machine_id, parts in added.items():
        revision, machine = documents[machine_id]
        joined = join(parts, channels=len(machine.probes))
        ascends = bool(np.all(joined.time[1:] >= joined.time[:-1]))
        in_time = joined if ascends else joined.pick(np.argsort(joined.time, kind="stable"))
        collector.feed(session, machine, revision, in_time)
        pacing.pause()


def _load(session: Session, arrived: list[ArrivedBatch]) -> list[object]:
    """Load all rows that these batches need, in three queries instead of several per batch.

    The session finds the rows as long as the returned list is referenced.
    """
    machine_ids = {one.batch.machine for one in arrived}
    return [
        *machines.by_ids(session, machine_ids),
        *samples.known_sources(session, {one.source for one in arrived}),
        *runs.collectors(session, machine_ids),
    ]
