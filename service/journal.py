"""The journal: messages become stored samples, once each, together with everything that follows from them.

One call of `store` is one transaction: sample blocks, how far each source was received, run collection, quarantine. A
restart therefore finds all of it or none of it.
"""

import logging
import math
import time
from collections import defaultdict
from collections.abc import Sequence, Set
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from sqlalchemy.orm import Session

from estimator.machine import Machine
from service import holes
from service.bounded import Bounded
from service.collection import Collector
from service.giving_way import GivingWay
from service.order import Order
from service.own_faults import unexpected
from service.putting_off import PutOff
from service.sharing import Share, Whole
from service.wire import Fault, Rejected, SampleBatch, SourceReceived, source_key, to_samples
from storage import machines, quarantine, runs, samples
from storage.blocks import Samples, join
from storage.damage import is_damage
from storage.database import Database
from storage.errors import concerns_all
from storage.quarantine import Rejection
from storage.samples import SourceKey
from storage.tables import SourceRow

logger = logging.getLogger(__name__)

LARGEST_GAP = 1_000_000_000
"""A sequence number this far ahead is a wrong number, not a gap."""
AT_ONCE = 500
"""Machines that are looked at together."""
LONGEST_TRANSACTION_S = 0.03
"""After so long no further machine is taken into a transaction that ends runs."""
LONGEST_ENDING_S = 0.1
"""After so long the runs of further machines are left for the next time: samples wait."""
LARGEST_FAULT_COUNT = 5
"""Faults of one reason in one batch that the quarantine shows; a source in a wrong unit has one in every value."""


@dataclass(frozen=True)
class Arrived:
    """A batch as it came: its key, payload and time of arrival [ns]."""

    batch: SampleBatch
    key: str
    payload: bytes
    received_at: int


@dataclass(frozen=True)
class StoreOutcome:
    """What became of a batch: samples stored, stored before, missing just before it; what of it was not taken and why."""

    received: int = 0
    duplicates: int = 0
    lost: int = 0
    faults: tuple[Fault, ...] = ()
    rejected: Rejected | None = None


@dataclass
class _Pending:
    """What one transaction has gathered before it writes blocks."""

    parts: dict[SourceKey, list[Samples]] = field(default_factory=lambda: defaultdict(list))
    first: dict[SourceKey, int] = field(default_factory=dict)
    received_at: dict[SourceKey, int] = field(default_factory=dict)
    rejections: list[Rejection] = field(default_factory=list)
    outcomes: list[StoreOutcome] = field(default_factory=list)


class _Damaged(Exception):
    """What is stored of a machine cannot be read."""

    def __init__(self, machine_id: str) -> None:
        super().__init__(machine_id)
        self.machine_id = machine_id


class Journal:
    """Writes what arrives. Not for use from several threads at once."""

    def __init__(self, database: Database, collector: Collector, share: Share | None = None) -> None:
        self._database = database
        self._collector = collector
        self._share = share or Whole()
        self._orders: Bounded[SourceKey, Order] = Bounded()
        self._plants: dict[str, str] = {}
        self._documents: dict[str, tuple[int, Machine]] = {}
        self._put_off = PutOff[str]()
        self.give_way = GivingWay()

    def next_sequence(self, key: SourceKey) -> int:
        """Number of the next sample expected from a source; 0 when it was never heard of."""
        with self._database.reading() as session:
            return samples.source(session, key).next_sequence

    def newest_receipt(self) -> int:
        """When samples came last, by the clock that this machine had then [ns]; 0 before any."""
        with self._database.reading() as session:
            return samples.newest_receipt(session) or 0

    def still_there(self, machine_id: str) -> None:
        """A machine's source sends, though nothing of it is taken now: it has not fallen silent."""
        self._collector.still_there(machine_id)

    def missing(self, key: SourceKey) -> list[holes.Hole]:
        """Numbers of a source that never came, ascending, as far as they are remembered."""
        with self._database.reading() as session:
            return list(samples.source(session, key).missing or ())

    def received(self, machine_id: str) -> list[SourceReceived]:
        """How far each source of a machine is durable."""
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
        """The plant of a machine, which never changes; None when the machine is unknown."""
        if machine_id not in self._plants:
            with self._database.reading() as session:
                try:
                    self._plants[machine_id] = machines.get(session, machine_id).plant
                except machines.MachineUnknown:
                    return None
        return self._plants[machine_id]

    def store(self, arrived: list[Arrived], rejections: list[Rejection], *, within_s: float = math.inf) -> list[StoreOutcome]:
        """Store batches, in order, and rejections; returns what became of each batch. Raises what the database raises, and
        NotHeld for machines that are another replica's by now; then nothing was stored.

        within_s: after so long [s] no further batch is taken, and what became of fewer is returned; of one at least.
        """
        try:
            with self._collector.lock, self._database.transaction(beside_others=True) as session:
                self._share.require(session, {one.batch.machine for one in arrived})
                return self._store(session, arrived, rejections, ends=time.monotonic() + within_s)
        except BaseException:
            self._orders.clear()  # they may know of samples that were not stored
            raise

    def end_silent(self, *, silence_s: float, alive: Set[str] = frozenset()) -> None:
        """End the runs of machines that have fallen silent: of as many as this may take time for, of the others the next time.

        A machine of which this fails holds up no other: it is tried again, after a longer pause each time.
        alive: machines of which a source is connected.
        """

        def is_due(machine_id: str) -> bool:
            silent = self._collector.has_fallen_silent(machine_id, silence_s=silence_s, alive=machine_id in alive)
            return silent and self._put_off.is_due(machine_id)

        with self._database.reading() as session:
            due = [one for one in machines.ids(session) if self._share.owns(one) and is_due(one)]
        for first in range(0, len(due), AT_ONCE):
            self._let_rest(due[first : first + AT_ONCE])
        due = list(filter(is_due, due))
        ends = time.monotonic() + LONGEST_ENDING_S
        while due and time.monotonic() < ends:
            due = self._end_some(due)

    def _let_rest(self, machine_ids: list[str]) -> None:
        """See by one look at all of them of which nothing is to be done; where one spoils that, each is looked at alone."""
        try:
            with self._database.reading() as session:
                self._collector.let_rest(session, machine_ids)
        except Exception as error:
            if concerns_all(error):
                raise
            logger.warning("%d machines cannot be looked at together: one by one", len(machine_ids), exc_info=error)

    def _end_some(self, due: list[str]) -> list[str]:
        """End the runs of the first of these machines in one short transaction; returns those that are left."""
        left = list(due)
        done: list[str] = []
        try:
            with self._collector.lock, self._database.transaction(beside_others=True) as session:
                self._share.require(session, due)
                ends = time.monotonic() + LONGEST_TRANSACTION_S
                while left and (not done or time.monotonic() < ends):
                    done.append(left.pop(0))
                    self._end(session, done[-1])
        except _Damaged as error:
            # Behind damage, SQLite takes nothing more in a transaction: the others are ended in another one.
            pause = self._put_off.failed(error.machine_id, at_once=True)
            self._database.damage.concerns(error.machine_id)
            logger.error("%s: its run cannot be ended; tried again in %.0f s", error.machine_id, pause)
            self._collector.look_again(done)
            return [one for one in due if one != error.machine_id]
        except BaseException:
            self._collector.look_again(done)
            raise
        return left

    def _end(self, session: Session, machine_id: str) -> None:
        try:
            with session.begin_nested():
                self._collector.end_silent(session, machine_id)
        except Exception as error:
            if concerns_all(error):
                raise
            if is_damage(error):
                raise _Damaged(machine_id) from error
            pause = self._put_off.failed(machine_id)
            self._collector.look_again([machine_id])
            logger.exception("%s: its run cannot be ended; tried again in %.0f s", machine_id, pause)
            what = "its run cannot be ended"
            quarantine.add(session, [unexpected(error, of=f"runs of {machine_id}", machine_id=machine_id, what=what)])
        else:
            self._put_off.succeeded(machine_id)

    def forget(self) -> None:
        """Forget what may have gone on without this process; all of it is in the store."""
        self._orders.clear()
        self._collector.forget()

    def require_convertible(self, batch: SampleBatch, *, received_at: int) -> None:
        """Raises Rejected for a batch of which nothing can be taken, also where its source's clock is wrong."""
        with self._database.reading() as session:
            _, machine = self._document(session, batch.machine)
        _, _, faults = to_samples(batch, machine, received_at=received_at)
        wrong = [fault for fault in faults if fault.reason == "time_out_of_range"]
        if len(wrong) == len(batch.time_ns):
            raise Rejected(wrong[0].reason, f"{wrong[0].detail}, and so with all others: set the source's clock")

    def _document(self, session: Session, machine_id: str) -> tuple[int, Machine]:
        """The revision in force and its document, which is parsed once."""
        revision = machines.get(session, machine_id).revision
        known = self._documents.get(machine_id)
        if known is None or known[0] != revision:
            known = self._documents[machine_id] = revision, machines.document(session, machine_id, revision)
        return known

    def _store(
        self, session: Session, arrived: list[Arrived], rejections: list[Rejection], *, ends: float
    ) -> list[StoreOutcome]:
        pending = _Pending(rejections=list(rejections))
        documents: dict[str, tuple[int, Machine]] = {}
        held = _rows(session, arrived)
        for one in arrived:
            if pending.outcomes and time.monotonic() > ends:
                break
            machine_id = one.batch.machine
            if machine_id not in documents:
                documents[machine_id] = self._document(session, machine_id)
            pending.outcomes.append(self._take(session, pending, one, documents[machine_id][1]))
            self.give_way()
        fresh: dict[str, list[Samples]] = defaultdict(list)
        for key, parts in pending.parts.items():
            revision, machine = documents[key.machine_id]
            joined = join(parts, channels=len(machine.probes))
            samples.add_block(
                session,
                key,
                revision=revision,
                first_sequence=pending.first[key],
                samples=joined,
                received_at=pending.received_at[key],
            )
            self.give_way()
            fresh[key.machine_id].append(joined)
            late = int(np.count_nonzero(joined.time <= self._collector.seen(session, key.machine_id)))
            if late:
                samples.source(session, key).late += late
                logger.warning("%s: %d samples are older than what is known; they are sorted in", key.machine_id, late)
        session.flush()
        for machine_id, parts in fresh.items():
            revision, machine = documents[machine_id]
            joined = join(parts, channels=len(machine.probes))
            in_time = joined.pick(np.argsort(joined.time, kind="stable"))
            self._collector.feed(session, machine, revision, in_time)
            self.give_way()
        if pending.rejections:
            quarantine.add(session, pending.rejections)
        del held
        return pending.outcomes

    def _take(self, session: Session, pending: _Pending, one: Arrived, machine: Machine) -> StoreOutcome:
        """Number, convert and check one batch; what is left of it joins `pending`.

        Its samples are known already, fill holes that were counted as lost, or follow what came so far.
        """
        batch, key = one.batch, source_key(one.batch)
        row = samples.source(session, key)
        count = len(batch.time_ns)
        gap = max(batch.sequence - row.next_sequence, 0)
        if gap > LARGEST_GAP:
            detail = f"sequence {batch.sequence} does not follow {row.next_sequence}"
            pending.rejections.append(_rejection(one, "sequence_out_of_range", detail))
            return StoreOutcome(rejected=Rejected("sequence_out_of_range", detail))
        filling = holes.pieces(row.missing or (), first=batch.sequence, count=count)
        following = min(max(row.next_sequence - batch.sequence, 0), count)
        fresh = np.arange(count) >= following
        for piece in filling:
            fresh[piece.start : piece.stop] = True
        known = int(np.count_nonzero(~fresh))
        row.duplicates += known
        if known == count:
            return StoreOutcome(duplicates=known)
        row.lost += gap - sum(piece.stop - piece.start for piece in filling)
        try:
            converted, taken, faults = to_samples(batch, machine, received_at=one.received_at)
        except Rejected as rejected:
            pending.rejections.append(_rejection(one, rejected.reason, rejected.detail))
            _advance(row, batch, filling, np.zeros(count, np.int64), np.zeros(count, dtype=bool), following)
            return StoreOutcome(duplicates=known, lost=gap, rejected=rejected)
        taken &= fresh
        for piece in filling:
            order = Order(time=piece.hole[2], before=piece.hole[3])
            faults += _check(order, machine, converted, taken, piece.start, piece.stop)
        latest = self._orders.setdefault(key, Order(time=row.last_time))
        faults += _check(latest, machine, converted, taken, following, count)
        _advance(row, batch, filling, converted.time, taken, following)
        new = tuple(fault for fault in faults if fresh[fault.index])
        pending.rejections += _sample_rejections(one, new)
        if taken.any():
            kept = converted.pick(taken)
            pending.parts[key].append(kept)
            pending.first.setdefault(key, batch.sequence + int(np.flatnonzero(taken)[0]))
            row.received += len(kept)
            row.last_received_at = pending.received_at[key] = one.received_at
        return StoreOutcome(int(np.count_nonzero(taken)), known, gap, new)


def _rows(session: Session, arrived: list[Arrived]) -> list[object]:
    """All rows that these batches need, in three queries instead of several each; the session finds them while held."""
    machine_ids = {one.batch.machine for one in arrived}
    keys = {source_key(one.batch) for one in arrived}
    return [
        *machines.some(session, machine_ids),
        *samples.some_sources(session, keys),
        *runs.some_collectors(session, machine_ids),
    ]


def _check(order: Order, machine: Machine, converted: Samples, taken: NDArray[np.bool_], start: int, stop: int) -> list[Fault]:
    """Clear `taken` where samples start to before stop of a batch are not in order; returns why."""
    here = np.zeros_like(taken)
    here[start:stop] = taken[start:stop]
    faults = order.check(machine, converted, here)
    taken[start:stop] = here[start:stop]
    return faults


def _advance(
    row: SourceRow,
    batch: SampleBatch,
    filling: list[holes.Piece],
    time: NDArray[np.int64],
    taken: NDArray[np.bool_],
    following: int,
) -> None:
    """Note how far a source has come with a batch: holes filled, a new one before it, its newest number and time."""
    missing = list(row.missing or ())
    for piece in filling:
        inside = slice(piece.start, piece.stop)
        missing = holes.filled(missing, piece, first=batch.sequence, times=time[inside][taken[inside]])
    new = time[following:][taken[following:]]
    if batch.sequence > row.next_sequence:
        before = int(new[0]) if new.size else holes.NEVER
        missing = holes.noted(missing, [row.next_sequence, batch.sequence - 1, row.last_time, before])
    row.missing = missing or None
    row.next_sequence = max(row.next_sequence, batch.sequence + taken.size)
    if new.size:
        row.last_time = int(new[-1])


def _rejection(one: Arrived, reason: str, detail: str) -> Rejection:
    return Rejection(one.received_at, one.key, one.batch.machine, reason, detail, one.payload)


def _sample_rejections(one: Arrived, faults: Sequence[Fault]) -> list[Rejection]:
    """The first few faults of each reason, of which the last stands for all others of the batch, too."""
    found = []
    for reason in dict.fromkeys(fault.reason for fault in faults):
        same = [fault for fault in faults if fault.reason == reason]
        kept = [_sample_rejection(one, fault) for fault in same[:LARGEST_FAULT_COUNT]]
        if others := len(same) - len(kept):
            kept[-1] = replace(kept[-1], detail=f"{kept[-1].detail}; and {others} more in this batch", count=1 + others)
        found += kept
    return found


def _sample_rejection(one: Arrived, fault: Fault) -> Rejection:
    batch, i = one.batch, fault.index
    sample = {
        "source": batch.source,
        "epoch": batch.epoch,
        "sequence": batch.sequence + i,
        "time_ns": batch.time_ns[i],
        "speed": batch.speed[i],
        "channels": batch.channels,
        "amplitude": batch.amplitude[i],
        "phase": batch.phase[i],
    }
    payload = repr(sample).encode()
    return Rejection(one.received_at, one.key, batch.machine, fault.reason, fault.detail, payload)
